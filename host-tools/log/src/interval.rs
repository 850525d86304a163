//! The usual time between rows.

use crate::decimate::Decimated;
use crate::median::median;

/// Intervals that are kept: of a longer log, an evenly spaced part.
const MOST: usize = 1 << 16;

/// The median time between the rows of a log, in memory that does not grow with it.
#[derive(Debug)]
pub struct Intervals {
    kept: Decimated,
    last_s: Option<f64>,
}

impl Default for Intervals {
    fn default() -> Self {
        Self::new()
    }
}

impl Intervals {
    /// Of no rows.
    pub fn new() -> Self {
        Self {
            kept: Decimated::new(MOST),
            last_s: None,
        }
    }

    /// Takes in the times of the next rows \[s\].
    pub fn take(&mut self, time_s: &[f64]) {
        let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else {
            return;
        };
        if let Some(before) = self.last_s {
            self.kept.extend(1, |_| first - before);
        }
        let steps = time_s.len() - 1;
        self.kept.extend(steps, |row| time_s[row + 1] - time_s[row]);
        self.last_s = Some(*last);
    }

    /// The median \[s\]; 0 of fewer than two rows.
    pub fn median_s(&self) -> f64 {
        median(&mut self.kept.values().to_vec())
    }
}
