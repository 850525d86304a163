//! Puts parsed rows together and checks that time increases.

use super::LogError;
use super::chunk::Chunk;
use super::layout::Layout;

/// Consecutive rows whose cells were checked, apart from the order of their times.
#[derive(Debug)]
pub(super) struct Parsed {
    pub(super) chunk: Chunk,
    /// Line or row number before the first row of the chunk.
    pub(super) base: u64,
    /// For each row, its number less `base`.
    pub(super) numbers: Vec<u32>,
    /// Rows left out because of their cells.
    pub(super) skipped: usize,
    /// The row at which reading stopped.
    pub(super) bad: Option<Bad>,
}

/// A row that is refused.
#[derive(Debug)]
pub(super) struct Bad {
    /// Its number.
    pub(super) number: u64,
    /// Its time, if that is a number.
    pub(super) time_s: Option<f64>,
    /// What is wrong with its other cells.
    pub(super) error: LogError,
}

/// The order of time over a whole log.
#[derive(Debug, Default)]
pub(super) struct TimeOrder {
    last_s: Option<f64>,
    skip_bad_rows: bool,
    /// Rows left out so far.
    pub(super) skipped: usize,
}

impl TimeOrder {
    pub(super) fn new(skip_bad_rows: bool) -> Self {
        Self {
            skip_bad_rows,
            ..Self::default()
        }
    }

    /// Takes the next rows of the log and returns those that are good.
    ///
    /// # Errors
    /// The first bad row, unless bad rows are skipped.
    pub(super) fn take(&mut self, layout: &Layout, parsed: Parsed) -> Result<Chunk, LogError> {
        let Parsed {
            mut chunk,
            base,
            numbers,
            skipped,
            bad,
        } = parsed;
        self.skipped += skipped;
        let follows = |time_s: f64| self.last_s.is_none_or(|before| time_s > before);
        let increases = chunk.time_s.first().is_none_or(|&first| follows(first))
            && chunk.time_s.windows(2).all(|t| t[1] > t[0]);
        if increases {
            self.last_s = chunk.time_s.last().copied().or(self.last_s);
        } else if self.skip_bad_rows {
            let keep: Vec<bool> = chunk.time_s.iter().map(|&t| self.advance(t)).collect();
            self.skipped += keep.iter().filter(|&&keep| !keep).count();
            chunk.retain(&keep);
        } else {
            for (&time_s, number) in chunk.time_s.iter().zip(numbers) {
                self.expect_advance(layout, base + u64::from(number), time_s)?;
            }
        }
        if let Some(bad) = bad {
            // In its row, time comes before the other cells.
            if let Some(time_s) = bad.time_s {
                self.expect_advance(layout, bad.number, time_s)?;
            }
            return Err(bad.error);
        }
        Ok(chunk)
    }

    fn advance(&mut self, time_s: f64) -> bool {
        let increases = self.last_s.is_none_or(|before| time_s > before);
        if increases {
            self.last_s = Some(time_s);
        }
        increases
    }

    fn expect_advance(
        &mut self,
        layout: &Layout,
        number: u64,
        time_s: f64,
    ) -> Result<(), LogError> {
        match self.last_s {
            Some(before) if time_s <= before => Err(layout.cell_error(
                number,
                layout.columns.time,
                format!("{time_s} s after {before} s: expected time to increase"),
            )),
            _ => {
                self.last_s = Some(time_s);
                Ok(())
            }
        }
    }
}
