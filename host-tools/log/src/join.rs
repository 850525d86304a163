//! Temperatures of another log, joined by time.

use std::path::Path;
use std::sync::Arc;

use super::chunk::Chunk;
use super::columns::{ChannelColumns, FoundTemp, TempSource, joined_temps};
use super::hold::HOLD_S;
use super::mapping::Mapping;
use super::stream::LogStream;
use super::time::TimeUnit;
use super::{LogError, ReadOptions};

/// The temperatures of another log.
#[derive(Clone, Debug)]
pub(super) struct Joined {
    /// The temperatures, for the axes of the log.
    pub(super) temps: Vec<FoundTemp>,
    /// The file.
    pub(super) file: String,
    unit: TimeUnit,
    origin_ns: Option<i128>,
    /// Seconds to add to its times to get times of the log.
    offset_s: f64,
    rows: Arc<Chunk>,
}

impl Joined {
    /// Reads a log of which only time and temperatures are needed.
    ///
    /// # Errors
    /// Those of any log.
    pub(super) fn read(
        path: &Path,
        options: &ReadOptions,
        mapping: &Mapping,
    ) -> Result<Self, LogError> {
        let own = ReadOptions {
            mapping: Mapping {
                time: mapping.time.clone(),
                temp: mapping.temp.clone(),
                ..Mapping::default()
            },
            kept: Vec::new(),
            ..options.clone()
        };
        let mut stream = LogStream::open_joined(path, &own)?;
        let mut rows = stream.empty_chunk();
        while let Some(chunk) = stream.next_chunk()? {
            rows.append(&chunk);
        }
        if rows.rows() == 0 {
            return Err(LogError::too_few_rows(path, 0));
        }
        let layout = stream.layout();
        let temps = joined_temps(&layout.header, &own.mapping);
        Ok(Self {
            temps: temps.map_err(|message| LogError::file(path, message))?,
            file: path.display().to_string(),
            unit: layout.columns.time_unit,
            origin_ns: layout.origin_ns,
            offset_s: 0.0,
            rows: Arc::new(rows),
        })
    }

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
