//! Puts parsed rows together, with a time that increases.
//!
//! Rows wait until those after them are known: what a stamp means depends on the next one.

use super::LogError;
use super::bursts::{self, Bursts};
use super::chunk::Chunk;
use super::clock::{Clock, Stamp, TimeNotes};
use super::hold::Hold;
use super::layout::Layout;
use super::row_numbers::RowNumbers;
use super::skipped::{Reason, SkippedRows};

/// Consecutive rows whose cells were checked, apart from the order of their times.
#[derive(Debug)]
pub(super) struct Parsed {
    pub(super) chunk: Chunk,
    /// Line or row number of each row.
    pub(super) numbers: RowNumbers,
    /// Whether temperatures are missing: NaN.
    pub(super) has_blanks: bool,
    /// Rows left out because of their cells.
    pub(super) skipped: SkippedRows,
    /// The row at which reading stopped.
    pub(super) bad: Option<Bad>,
}

impl Parsed {
    /// Rows of a table, of which `row` reads the values, in the order of the slots, and says whether a
    /// row is wanted. Numbers begin with `first`.
    pub(super) fn of_table(
        layout: &Layout,
        (first, rows): (u64, usize),
        skip_bad_rows: bool,
        mut row: impl FnMut(usize, &mut [f64]) -> Result<bool, Box<Bad>>,
    ) -> Self {
        let mut parsed = Self::with_capacity(layout, rows);
        let mut values = vec![0.0; layout.slots.len()];
        for number in 0..rows {
            match row(number, &mut values) {
                Ok(false) => {}
                Ok(true) => {
                    parsed.has_blanks |= values.iter().any(|value| value.is_nan());
                    layout.push(&mut parsed.chunk, &values);
                    parsed.numbers.push(first + number as u64);
                }
                Err(bad) if skip_bad_rows && !bad.is_fatal => parsed.skipped.count(bad.reason),
                Err(bad) => {
                    parsed.bad = Some(*bad);
                    break;
                }
            }
        }
        parsed
    }

    /// No rows yet, with room for some.
    pub(super) fn with_capacity(layout: &Layout, rows: usize) -> Self {
        Self {
            chunk: layout.chunk(rows),
            numbers: RowNumbers::default(),
            has_blanks: false,
            skipped: SkippedRows::default(),
            bad: None,
        }
    }
}

/// A row that is refused.
#[derive(Debug)]
pub(super) struct Bad {
    /// Its number.
    pub(super) number: u64,
    /// Its time, if that is a number.
    pub(super) time_s: Option<f64>,
    /// What is wrong with its other cells, to be counted.
    pub(super) reason: Reason,
    /// The same, to be read.
    pub(super) error: LogError,
    /// Whether it is refused although bad rows are skipped.
    pub(super) is_fatal: bool,
}

impl Bad {
    /// Of a row of a table, for what one of its cells holds.
    pub(super) fn of_cell(
        layout: &Layout,
        (number, time_s): (u64, Option<f64>),
        position: usize,
        (reason, message): (Reason, String),
    ) -> Box<Self> {
        Box::new(Self {
            number,
            time_s,
            reason,
            error: layout.cell_error(number, position, message),
            is_fatal: false,
        })
    }
}

/// How a logger stamps its rows.
#[derive(Debug)]
enum Stamping {
    /// Too few rows are there to know.
    Unknown,
    /// Each row at its own time.
    EachRow,
    /// Several rows at once.
    InBursts(Bursts),
}

/// The order of time over a whole log.
#[derive(Debug)]
pub(super) struct TimeOrder {
    skip_bad_rows: bool,
    clock: Clock,
    stamping: Stamping,
    /// Rows that are not judged yet, with their numbers.
    waiting: Chunk,
    numbers: RowNumbers,
    /// Rows whose burst may go on.
    open: Chunk,
    hold: Hold,
    /// Whether a temperature was missing so far.
    has_blanks: bool,
    /// Bits of the row judged last.
    last_row: Vec<u64>,
    /// Rows left out so far.
    pub(super) skipped: SkippedRows,
}

impl TimeOrder {
    pub(super) fn new(layout: &Layout, skip_bad_rows: bool) -> Self {
        Self {
            skip_bad_rows,
            clock: Clock::default(),
            stamping: Stamping::Unknown,
            waiting: layout.chunk(0),
            numbers: RowNumbers::default(),
            open: layout.chunk(0),
            hold: Hold::new(skip_bad_rows),
            has_blanks: false,
            last_row: Vec::new(),
            skipped: SkippedRows::default(),
        }
    }

    /// Takes the next rows of the log and returns good ones, as far as they are known to be.
    ///
    /// # Errors
    /// The first bad row, unless bad rows are skipped.
    pub(super) fn take(&mut self, layout: &Layout, parsed: Parsed) -> Result<Chunk, LogError> {
        self.skipped.add(parsed.skipped);
        self.has_blanks |= parsed.has_blanks;
        self.numbers.append(&parsed.numbers);
        let Some(bad) = parsed.bad else {
            if parsed.chunk.rows() == 0 || self.waiting.rows() < bursts::AHEAD {
                self.waiting.append(&parsed.chunk);
                return Ok(layout.chunk(0));
            }
            let rows = std::mem::replace(&mut self.waiting, parsed.chunk);
            return self.release(layout, rows, false);
        };
        self.waiting.append(&parsed.chunk);
        self.finish(layout)?;
        // In its row, time comes before the other cells.
        if let Some(time_s) = bad.time_s
            && let Err(message) = self.time(time_s, None)
        {
            return Err(layout.cell_error(bad.number, layout.columns.time, message));
        }
        Err(bad.error)
    }

    /// The rows that are left at the end of the log.
    ///
    /// # Errors
    /// The first bad row, unless bad rows are skipped.
    pub(super) fn finish(&mut self, layout: &Layout) -> Result<Chunk, LogError> {
        let rows = std::mem::replace(&mut self.waiting, layout.chunk(0));
        self.release(layout, rows, true)
    }

    /// What was found in the stamps so far.
    pub(super) fn notes(&self) -> TimeNotes {
        let (rows_per_burst, burst_s) = match &self.stamping {
            Stamping::InBursts(bursts) => (bursts.rows, bursts.period_s),
            Stamping::Unknown | Stamping::EachRow => (0, 0.0),
        };
        TimeNotes {
            rows_per_burst,
            burst_s,
            ..self.clock.notes.clone()
        }
    }

    /// Judges rows, by those that wait too, and returns them as far as their times are known.
    fn release(
        &mut self,
        layout: &Layout,
        mut rows: Chunk,
        is_end: bool,
    ) -> Result<Chunk, LogError> {
        if matches!(self.stamping, Stamping::Unknown) {
            let stamps_s = &rows.time_s;
            let found = Bursts::find(&stamps_s[..stamps_s.len().min(bursts::AHEAD)]);
            self.stamping = found.map_or(Stamping::EachRow, Stamping::InBursts);
        }
        self.judge(layout, &mut rows)?;
        let Stamping::InBursts(bursts) = &mut self.stamping else {
            return Ok(rows);
        };
        self.open.append(&rows);
        let rows = self.open.rows();
        let open = if is_end {
            0
        } else {
            bursts.open_rows(&self.open.time_s)
        };
        let later = self.open.split_off(rows - open);
        let mut whole = std::mem::replace(&mut self.open, later);
        bursts.spread(&mut whole.time_s);
        Ok(whole)
    }

    /// Makes times of the stamps of rows and leaves out the bad ones.
    fn judge(&mut self, layout: &Layout, rows: &mut Chunk) -> Result<(), LogError> {
        let count = rows.rows();
        let after_s = self.waiting.time_s.first().copied();
        let last_row = count.checked_sub(1).map(|last| rows.bits(last));
        // Whether each row is kept; nothing where all are.
        let mut keep = Vec::new();
        if !self.clock.pass(&rows.time_s, after_s) {
            keep = vec![true; count];
            let mut times_s = vec![0.0; count];
            for row in 0..count {
                let stamp_s = rows.time_s[row];
                let next_s = rows.time_s.get(row + 1).copied().or(after_s);
                let message = match self.time(stamp_s, next_s) {
                    Ok(Some(time_s)) => {
                        times_s[row] = time_s;
                        continue;
                    }
                    Ok(None) if self.repeats(rows, row) => {
                        keep[row] = false;
                        self.clock.notes.repeated_rows += 1;
                        continue;
                    }
                    Ok(None) => increase(stamp_s, stamp_s),
                    Err(message) => message,
                };
                if !self.skip_bad_rows {
                    let number = self.numbers.of(row);
                    return Err(layout.cell_error(number, layout.columns.time, message));
                }
                keep[row] = false;
                self.skipped.time_order += 1;
            }
            rows.time_s = times_s;
            rows.retain(&keep);
        }
        let number = |row: usize| {
            let mut kept = (0..count).filter(|&row| keep.get(row).is_none_or(|&keep| keep));
            self.numbers.of(kept.nth(row).unwrap_or(row))
        };
        let held = self.hold.fill(layout, rows, number, self.has_blanks)?;
        self.skipped.empty_cell += held;
        self.numbers.skip(count);
        self.last_row = last_row.unwrap_or_else(|| std::mem::take(&mut self.last_row));
        Ok(())
    }

    /// Whether a row with the stamp of the row before has its values too: it was written twice.
    fn repeats(&self, rows: &Chunk, row: usize) -> bool {
        match row {
            0 => rows.bits(row) == self.last_row,
            _ => rows.bits(row) == rows.bits(row - 1),
        }
    }

    /// The time of a stamp \[s\]; `None` if it is the stamp of the row before; or what is wrong.
    fn time(&mut self, stamp_s: f64, next_s: Option<f64>) -> Result<Option<f64>, String> {
        match self.clock.judge(stamp_s, next_s) {
            Stamp::At(time_s) => Ok(Some(time_s)),
            // Bursts have one stamp for several rows.
            Stamp::Again if matches!(self.stamping, Stamping::InBursts(_)) => {
                Ok(self.clock.last_s())
            }
            Stamp::Again => Ok(None),
            Stamp::Ahead { before_s, after_s } => Err(format!(
                "{stamp_s} s between rows of {before_s} s and {after_s} s: expected time to increase"
            )),
            Stamp::Back(before_s) => Err(increase(stamp_s, before_s)),
        }
    }
}

fn increase(time_s: f64, before_s: f64) -> String {
    format!("{time_s} s after {before_s} s: expected time to increase")
}
