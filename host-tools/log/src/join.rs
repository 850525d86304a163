//! Temperatures of another log, joined by time.

use std::sync::Arc;

use super::channel_columns::ChannelColumns;
use super::chunk::Chunk;
use super::doubt::Doubt;
use super::temp_columns::{FoundTemp, TempSource};
use super::time::TimeUnit;

/// A temperature is held for so long where there is none \[s\].
pub(super) const HOLD_S: f64 = 10.0;

/// The temperatures of another log.
#[derive(Clone, Debug)]
pub(super) struct Joined {
    /// The temperatures, for the axes of the log.
    pub(super) temps: Vec<FoundTemp>,
    /// The file.
    pub(super) file: String,
    /// What a person must judge of it.
    pub(super) doubts: Vec<Doubt>,
    pub(super) unit: TimeUnit,
    pub(super) origin_ns: Option<i128>,
    /// Seconds to add to its times to get times of the log.
    pub(super) offset_s: f64,
    pub(super) rows: Arc<Chunk>,
}

impl Joined {
    /// Brings its times to the times of the log.
    ///
    /// # Errors
    /// Clock times in one of them only.
    pub(super) fn align(&mut self, unit: TimeUnit, origin_ns: Option<i128>) -> Result<(), String> {
        if (unit == TimeUnit::Iso) != (self.unit == TimeUnit::Iso) {
            return Err(format!(
                "--join {}: its times are in {}, those here in {unit}: expected clock times in both \
                 or in neither",
                self.file, self.unit
            ));
        }
        let apart_ns = self.origin_ns.unwrap_or(0) - origin_ns.unwrap_or(0);
        self.offset_s = apart_ns as f64 / 1e9;
        Ok(())
    }

    /// Adds the temperatures of the rows of a chunk: the last ones, NaN where they are too old.
    pub(super) fn fill(&self, chunk: &mut Chunk, channels: &[ChannelColumns]) {
        let times_s = &self.rows.time_s;
        let first = chunk.time_s.first().copied().unwrap_or(0.0) - self.offset_s;
        // The rows of the other log up to the time of a row.
        let mut passed = times_s.partition_point(|&time_s| time_s <= first);
        for (row, &time_s) in chunk.time_s.iter().enumerate() {
            let time_s = time_s - self.offset_s;
            while times_s.get(passed).is_some_and(|&next| next <= time_s) {
                passed += 1;
            }
            let last = passed
                .checked_sub(1)
                .filter(|&last| time_s - times_s[last] <= HOLD_S);
            for (channel, temps_c) in channels.iter().zip(&mut chunk.temps_c) {
                if let TempSource::Joined(place) = channel.temp {
                    debug_assert_eq!(temps_c.len(), row);
                    temps_c.push(last.map_or(f32::NAN, |last| self.rows.temps_c[place][last]));
                }
            }
        }
    }

    /// The file and the range of its times, for messages.
    pub(super) fn describe(&self) -> String {
        let times_s = &self.rows.time_s;
        let (first, last) = (
            times_s[0] + self.offset_s,
            times_s[times_s.len() - 1] + self.offset_s,
        );
        format!("{} ({first} to {last} s)", self.file)
    }
}
