//! Temperatures of rows that have none: the last one, or that of another log.

use super::LogError;
use super::chunk::Chunk;
use super::join::HOLD_S;
use super::layout::Layout;

/// Follows the temperatures of a log.
#[derive(Debug, Default)]
pub(super) struct Hold {
    skip_bad_rows: bool,
    /// Time of the first row \[s\].
    first_s: Option<f64>,
    /// The last temperature of each channel and its time \[s\].
    held: Vec<Option<(f64, f32)>>,
}

impl Hold {
    pub(super) fn new(skip_bad_rows: bool) -> Self {
        Self {
            skip_bad_rows,
            ..Self::default()
        }
    }

    /// Fills the temperatures of rows and returns how many rows it left out; `number` gives the
    /// number of a row.
    ///
    /// # Errors
    /// A row whose last temperature is too old, unless bad rows are skipped.
    pub(super) fn fill(
        &mut self,
        layout: &Layout,
        chunk: &mut Chunk,
        number: impl Fn(usize) -> u64,
        has_blanks: bool,
    ) -> Result<usize, LogError> {
        if let Some(joined) = &layout.joined {
            joined.fill(chunk, &layout.columns.channels);
        }
        self.first_s = self.first_s.or(chunk.time_s.first().copied());
        if !has_blanks && layout.joined.is_none() {
            self.note_last(chunk);
            return Ok(0);
        }
        self.hold(layout, chunk, number)
    }

    /// Keeps the last temperatures, for blank ones that may follow.
    fn note_last(&mut self, chunk: &Chunk) {
        let Some(&time_s) = chunk.time_s.last() else {
            return;
        };
        let last = chunk.temps_c.iter().map(|temps_c| temps_c.last());
        self.held = last.map(|temp_c| Some((time_s, *temp_c?))).collect();
    }

    /// Gives rows without a temperature the last one. Rows before the first one are left out, as many
    /// as it could have been held for.
    fn hold(
        &mut self,
        layout: &Layout,
        chunk: &mut Chunk,
        number: impl Fn(usize) -> u64,
    ) -> Result<usize, LogError> {
        let mut keep = vec![true; chunk.rows()];
        self.held.resize(chunk.temps_c.len(), None);
        for row in 0..chunk.rows() {
            let time_s = chunk.time_s[row];
            for (channel, temps_c) in chunk.temps_c.iter_mut().enumerate() {
                if !temps_c[row].is_nan() {
                    // A joined temperature comes already held.
                    self.held[channel] = Some((time_s, temps_c[row]));
                    continue;
                }
                let since_s = self.held[channel].map_or(self.first_s, |(held_s, _)| Some(held_s));
                let is_near = since_s.is_none_or(|since_s| time_s - since_s <= HOLD_S);
                match self.held[channel] {
                    Some((_, temp_c)) if is_near && layout.joined.is_none() => {
                        temps_c[row] = temp_c;
                    }
                    None if is_near => keep[row] = false,
                    _ if self.skip_bad_rows => keep[row] = false,
                    _ => return Err(layout.blank_temp(number(row), channel, time_s)),
                }
            }
        }
        if keep.contains(&false) {
            chunk.retain(&keep);
        }
        Ok(keep.iter().filter(|&&keep| !keep).count())
    }
}
