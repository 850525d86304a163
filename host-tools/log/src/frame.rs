//! Columns in memory, as data frames have them, read as a log.

use std::path::Path;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::LogError;
use super::layout::{Finder, Found, Layout, RowKind};
use super::order::{Bad, Parsed};
use super::source::hex;

/// Columns of the same length, by the names that columns of a log have.
///
/// A NaN is a blank cell: a temperature is then held, any other column refuses the row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// What the log is called in messages and in the set.
    pub name: String,
    /// Names and values.
    pub columns: Vec<(String, Vec<f64>)>,
}

impl Frame {
    /// SHA-256 of the columns, in hexadecimal: of each name, a byte 0, and its values as little-endian
    /// f64.
    fn sha256(&self) -> String {
        let mut digest = Sha256::new();
        for (name, values) in &self.columns {
            digest.update(name);
            digest.update([0]);
            for value in values {
                digest.update(value.to_le_bytes());
            }
        }
        hex(&digest.finalize())
    }
}

/// The rows of a frame, some at a time.
pub(super) struct FrameRows {
    layout: Arc<Layout>,
    frame: Frame,
    /// Rows read so far.
    row: usize,
    rows_at_a_time: usize,
    skip_bad_rows: bool,
}

impl FrameRows {
    /// Finds the columns.
    ///
    /// # Errors
    /// Columns of different lengths, or that do not name time, temperature and axes with their units.
    pub(super) fn open(
        frame: Frame,
        finder: &Finder,
        skip_bad_rows: bool,
        rows_at_a_time: usize,
    ) -> Result<(Self, Arc<Layout>), LogError> {
        let refused = |message: String| LogError::file(finder.path, message);
        let rows = frame.columns.first().map_or(0, |(_, values)| values.len());
        if let Some((name, values)) = frame.columns.iter().find(|(_, of)| of.len() != rows) {
            return Err(refused(format!(
                "column `{name}` has {} rows: expected {rows}, as `{}` has",
                values.len(),
                frame.columns[0].0
            )));
        }
        let header = frame.columns.iter().map(|(name, _)| name.clone());
        let found = Found {
            preamble: &[],
            sample: &[],
            row_kind: RowKind::Row,
            topic: None,
        };
        let mut layout = Layout::new(header.collect(), &found, finder).map_err(refused)?;
        if let Some((instances, message)) = layout.columns.several.take() {
            return Err(LogError::sources(finder.path, None, instances, message));
        }
        if let Some(joined) = &mut layout.joined {
            let unit = layout.columns.time_unit;
            joined.align(unit, None).map_err(refused)?;
        }
        let layout = Arc::new(layout);
        let rows = Self {
            layout: Arc::clone(&layout),
            frame,
            row: 0,
            rows_at_a_time,
            skip_bad_rows,
        };
        Ok((rows, layout))
    }

    /// The next rows, or the hash of the columns at their end.
    pub(super) fn next(&mut self) -> Result<Parsed, String> {
        let rows = self.frame.columns.first().map_or(0, |(_, of)| of.len());
        if self.row == rows {
            return Err(self.frame.sha256());
        }
        let (first, rows) = (self.row, self.rows_at_a_time.min(rows - self.row));
        self.row += rows;
        let place = (first as u64 + 1, rows);
        let parsed = Parsed::of_table(&self.layout, place, self.skip_bad_rows, |row, values| {
            self.values(first + row, values).map(|()| true)
        });
        Ok(parsed)
    }

    /// The values of a row, in the order of the slots.
    fn values(&self, row: usize, values: &mut [f64]) -> Result<(), Box<Bad>> {
        let mut time_s = None;
        for (slot, value) in self.layout.slots.iter().zip(values) {
            let found = self.frame.columns[slot.position].1[row];
            *value = Layout::checked(slot, found).map_err(|objection| {
                let row = (row as u64 + 1, time_s);
                Bad::of_cell(&self.layout, row, slot.position, objection)
            })?;
            time_s.get_or_insert(*value);
        }
        Ok(())
    }
}

/// What frames are called where messages name a file.
pub(super) fn path_of(frame: &Frame) -> &Path {
    Path::new(&frame.name)
}

#[cfg(test)]
mod tests {
    use crate::{Frame, ReadOptions, read_frame, read_log};

    fn frame() -> Frame {
        let column = |of: fn(f64) -> f64| (0..20_000).map(|row| of(f64::from(row))).collect();
        let columns: [(&str, Vec<f64>); 4] = [
            ("time_s", column(|row| 0.5 * row)),
            ("temp_c", column(|row| 20.0 + 1e-3 * row)),
            ("x_pulses", column(|row| (0.3 * row).sin().round())),
            ("note", column(|_| f64::NAN)),
        ];
        Frame {
            name: "frame".to_owned(),
            columns: columns.map(|(name, of)| (name.to_owned(), of)).into(),
        }
    }

    #[test]
    fn a_frame_is_the_log_that_a_file_of_its_numbers_is() {
        let (frame, options) = (frame(), ReadOptions::default());
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut text = "time_s,temp_c,x_pulses,note\n".to_owned();
        for row in 0..20_000 {
            let of = |column: usize| frame.columns[column].1[row];
            text += &format!("{},{},{},\n", of(0), of(1), of(2));
        }
        std::fs::write(&path, text).unwrap();
        let (found, expected) = (
            read_frame(frame, &options).unwrap(),
            read_log(&path, &options).unwrap(),
        );
        assert_eq!(found.time_s, expected.time_s);
        assert_eq!(found.interval_s, expected.interval_s);
        assert_eq!(found.ignored_columns, ["note"]);
        let [found, expected] = [found, expected].map(|mut log| log.channels.remove(0));
        assert_eq!(found.temp_c, expected.temp_c);
        assert_eq!(found.axes[0].unit, expected.axes[0].unit);
        assert_eq!(found.axes[0].raw, expected.axes[0].raw);
    }

    #[test]
    fn what_is_wrong_with_a_frame_is_named() {
        let options = ReadOptions::default();
        let message = |change: fn(&mut Frame)| {
            let mut frame = frame();
            change(&mut frame);
            read_frame(frame, &options).unwrap_err().to_string()
        };
        assert_eq!(
            message(|frame| frame.columns[2].1.truncate(7)),
            "frame: column `x_pulses` has 7 rows: expected 20000, as `time_s` has"
        );
        assert_eq!(
            message(|frame| frame.columns[2].1[9999] = f64::NAN),
            "frame: row 10000, column 3 `x_pulses`: `NaN`: expected a finite number"
        );
        assert_eq!(
            message(|frame| frame.columns[0].1[7] = 1.0),
            "frame: row 8, column 1 `time_s`: 1 s after 3 s: expected time to increase"
        );
        let none = message(|frame| frame.columns.clear());
        assert!(none.contains("time"), "{none}");
        let empty = message(|frame| frame.columns.iter_mut().for_each(|(_, of)| of.clear()));
        assert!(empty.contains("expected at least 2"), "{empty}");
    }

    #[test]
    fn the_hash_is_of_names_and_numbers() {
        let hash = |change: fn(&mut Frame)| {
            let mut frame = frame();
            change(&mut frame);
            read_frame(frame, &ReadOptions::default()).unwrap().sha256
        };
        let whole = hash(|_| ());
        assert_eq!(whole.len(), 64);
        assert_eq!(whole, hash(|_| ()));
        assert_ne!(whole, hash(|frame| frame.columns[2].1[5] += 1.0));
        assert_ne!(whole, hash(|frame| frame.columns[3].0 += "s"));
    }
}
