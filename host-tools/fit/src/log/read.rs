//! Reads a CSV log, checking every cell.

use std::fs;
use std::path::Path;

use csv::{ByteRecord, ReaderBuilder};
use sha2::{Digest, Sha256};

use super::columns::{Columns, Mapping};
use super::{Axis, Channel, Log, LogError};
use crate::unit::{AxisUnit, ColumnUnit};

/// Temperatures outside this range \[degC\] are taken for a wrong unit, not for a reading.
const PLAUSIBLE_TEMP_C: std::ops::RangeInclusive<f64> = -100.0..=200.0;

/// Values beyond this magnitude are no measurement of anything, and the core could not hold them.
const LARGEST_VALUE: f64 = 1e20;

/// How to read a log.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Columns that do not follow the naming rule.
    pub mapping: Mapping,
    /// Turns pulse counts into deg/h \[arcsec per pulse\]; without it they become pulses/s.
    pub scale_factor_arcsec: Option<f64>,
    /// Leave out rows with a bad cell and count them, instead of refusing the log.
    pub skip_bad_rows: bool,
}

/// Reads the log at `path`.
///
/// Pulse counts are divided by the median interval between rows, since a count belongs to one
/// sample however long the gap before it; 1 arcsec/s is 1 deg/h.
///
/// # Errors
/// The first thing that is wrong, with file, line and column: a header that does not name time,
/// temperature and axes with their units, a cell that is not a finite number, time that does not
/// increase, temperatures that cannot be degC, fewer than two rows.
pub fn read_log(path: &Path, options: &ReadOptions) -> Result<Log, LogError> {
    let bytes = fs::read(path).map_err(LogError::io(path))?;
    let sha256 = hex(&Sha256::digest(&bytes));
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    if text.iter().all(u8::is_ascii_whitespace) {
        return Err(LogError::file(
            path,
            "the file is empty: expected a header such as `time_s,temp_c,x_dph` and rows",
        ));
    }

    let mut reader = ReaderBuilder::new().flexible(true).from_reader(text);
    let header: Vec<String> = reader
        .headers()
        .map_err(|error| LogError::line(path, 1, error.to_string()))?
        .iter()
        .map(|name| name.trim().to_owned())
        .collect();
    let columns = Columns::find(&header, &options.mapping)
        .map_err(|message| LogError::line(path, 1, message))?;

    let mut rows = Rows::new(path, &header, &columns);
    let mut record = ByteRecord::new();
    let mut skipped_rows = 0;
    loop {
        match reader.read_byte_record(&mut record) {
            Ok(true) => {}
            Ok(false) => break,
            Err(error) => return Err(LogError::file(path, error.to_string())),
        }
        match rows.push(&record) {
            Ok(()) => {}
            Err(_) if options.skip_bad_rows => skipped_rows += 1,
            Err(error) => return Err(error),
        }
    }
    if rows.time_s.len() < 2 {
        let found = rows.time_s.len();
        return Err(LogError::file(
            path,
            format!("{found} usable rows after the header: expected at least 2"),
        ));
    }
    let interval_s = median_interval_s(&rows.time_s);
    Ok(Log {
        file: path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into(),
        sha256,
        channels: rows.take_channels(interval_s, options.scale_factor_arcsec),
        time_s: rows.time_s,
        ignored_columns: columns.ignored,
        skipped_rows,
        interval_s,
    })
}

/// The rows read so far, column by column.
struct Rows<'a> {
    path: &'a Path,
    header: &'a [String],
    columns: &'a Columns,
    time_s: Vec<f64>,
    temps_c: Vec<Vec<f32>>,
    axes: Vec<Vec<Vec<f64>>>,
    /// The row being read: nothing is kept of a row with a bad cell.
    row: Vec<f64>,
}

impl<'a> Rows<'a> {
    fn new(path: &'a Path, header: &'a [String], columns: &'a Columns) -> Self {
        Self {
            path,
            header,
            columns,
            time_s: Vec::new(),
            temps_c: vec![Vec::new(); columns.channels.len()],
            axes: columns
                .channels
                .iter()
                .map(|channel| vec![Vec::new(); channel.axes.len()])
                .collect(),
            row: Vec::new(),
        }
    }

    fn push(&mut self, record: &ByteRecord) -> Result<(), LogError> {
        let line = record.position().map_or(0, csv::Position::line);
        if record.len() != self.header.len() {
            return Err(LogError::line(
                self.path,
                line,
                format!(
                    "{} cells, but the header has {} (a decimal comma, or a cut line?)",
                    record.len(),
                    self.header.len()
                ),
            ));
        }
        let columns = self.columns;
        let time_s = self.number(record, line, columns.time)?;
        if let Some(&before) = self.time_s.last()
            && time_s <= before
        {
            return Err(self.cell(
                line,
                columns.time,
                format!("{time_s} s after {before} s: expected time to increase"),
            ));
        }
        self.row.clear();
        for channel in &columns.channels {
            let temp_c = self.number(record, line, channel.temp)?;
            if !PLAUSIBLE_TEMP_C.contains(&temp_c) {
                let hint = if (173.15..=473.15).contains(&temp_c) {
                    " (is it in kelvin?)"
                } else {
                    ""
                };
                return Err(self.cell(
                    line,
                    channel.temp,
                    format!("{temp_c}: expected -100 to 200 degC{hint}"),
                ));
            }
            self.row.push(temp_c);
            for (position, _) in &channel.axes {
                let value = self.number(record, line, *position)?;
                self.row.push(value);
            }
        }
        self.time_s.push(time_s);
        let mut row = self.row.iter();
        for (temps_c, axes) in self.temps_c.iter_mut().zip(&mut self.axes) {
            temps_c.extend(row.next().map(|&temp_c| temp_c as f32));
            for axis in axes {
                axis.extend(row.next());
            }
        }
        Ok(())
    }

    fn number(&self, record: &ByteRecord, line: u64, position: usize) -> Result<f64, LogError> {
        let cell = record[position].trim_ascii();
        match fast_float2::parse::<f64, _>(cell) {
            Ok(value) if value.abs() <= LARGEST_VALUE => Ok(value),
            Ok(value) if value.is_finite() => {
                let message = format!("{value:e}: expected a magnitude of 1e20 at most");
                Err(self.cell(line, position, message))
            }
            _ => {
                let found = String::from_utf8_lossy(cell);
                let found = match found.is_empty() {
                    true => "an empty cell".to_owned(),
                    false => format!("`{found}`"),
                };
                Err(self.cell(line, position, format!("{found}: expected a finite number")))
            }
        }
    }

    fn cell(&self, line: u64, position: usize, message: String) -> LogError {
        LogError::Cell {
            path: self.path.to_owned(),
            line,
            column: position + 1,
            name: self.header[position].clone(),
            message,
        }
    }

    fn take_channels(&mut self, interval_s: f64, scale_factor: Option<f64>) -> Vec<Channel> {
        let temps_c = std::mem::take(&mut self.temps_c);
        let axes = std::mem::take(&mut self.axes);
        self.columns
            .channels
            .iter()
            .zip(temps_c.into_iter().zip(axes))
            .map(|(columns, (temp_c, values))| Channel {
                column: self.header[columns.temp].clone(),
                temp_c,
                axes: columns
                    .axes
                    .iter()
                    .zip(values)
                    .map(|((_, axis), mut raw)| {
                        let unit = to_axis_unit(&mut raw, axis.unit, interval_s, scale_factor);
                        Axis {
                            name: axis.name.clone(),
                            unit,
                            raw,
                        }
                    })
                    .collect(),
            })
            .collect()
    }
}

fn to_axis_unit(
    values: &mut [f64],
    unit: ColumnUnit,
    interval_s: f64,
    scale_factor_arcsec: Option<f64>,
) -> AxisUnit {
    let (factor, unit) = match (unit, scale_factor_arcsec) {
        (ColumnUnit::Direct(unit), _) => return unit,
        (ColumnUnit::Pulses, Some(scale_factor)) => (scale_factor / interval_s, AxisUnit::Dph),
        (ColumnUnit::Pulses, None) => (1.0 / interval_s, AxisUnit::PulsesPerS),
    };
    for value in values {
        *value *= factor;
    }
    unit
}

fn median_interval_s(time_s: &[f64]) -> f64 {
    let mut intervals: Vec<f64> = time_s.windows(2).map(|t| t[1] - t[0]).collect();
    let middle = intervals.len() / 2;
    *intervals.select_nth_unstable_by(middle, f64::total_cmp).1
}

pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, options: &ReadOptions) -> Result<Log, LogError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        fs::write(&path, text).unwrap();
        read_log(&path, options)
    }

    fn refused(text: &str) -> String {
        let error = read(text, &ReadOptions::default()).unwrap_err().to_string();
        error.rsplit_once("log.csv").unwrap().1.to_owned()
    }

    #[test]
    fn values_come_out_in_their_units() {
        let text =
            "\u{feff}time_s, temp_c ,gx_dps,x_pulses,note\n0,20.5,1e-3,3,ok\n0.5,20.5,-2,5,\n";
        let log = read(text, &ReadOptions::default()).unwrap();
        assert_eq!((log.rows(), log.interval_s), (2, 0.5));
        let axes = &log.channels[0].axes;
        assert_eq!(
            (axes[0].unit, &axes[0].raw[..]),
            (AxisUnit::Dps, &[1e-3, -2.0][..])
        );
        assert_eq!(
            (axes[1].unit, &axes[1].raw[..]),
            (AxisUnit::PulsesPerS, &[6.0, 10.0][..])
        );
        assert_eq!(log.ignored_columns, ["note"]);
        let scaled = ReadOptions {
            scale_factor_arcsec: Some(1.5),
            ..ReadOptions::default()
        };
        let axes = &read(text, &scaled).unwrap().channels[0].axes;
        assert_eq!(
            (axes[1].unit, &axes[1].raw[..]),
            (AxisUnit::Dph, &[9.0, 15.0][..])
        );
    }

    #[test]
    fn bad_cells_are_named_by_line_and_column() {
        let h = "time_s,temp_c,x_dph\n";
        for (rows, expected) in [
            (
                "0,20,1\n1,cold,2\n",
                ":3:2: column `temp_c`: `cold`: expected a finite number",
            ),
            (
                "0,20,NaN\n1,20,2\n",
                ":2:3: column `x_dph`: `NaN`: expected a finite number",
            ),
            (
                "0,20,1\n1,20,\n",
                ":3:3: column `x_dph`: an empty cell: expected a finite number",
            ),
            (
                "0,20,1\n1,20,-1e300\n",
                ":3:3: column `x_dph`: -1e300: expected a magnitude of 1e20 at most",
            ),
            (
                "0,20,1\n1,20,inf\n",
                ":3:3: column `x_dph`: `inf`: expected a finite number",
            ),
            (
                "0,20,1\n0,20,2\n",
                ":3:1: column `time_s`: 0 s after 0 s: expected time to increase",
            ),
            (
                "0,298.15,1\n1,298.2,2\n",
                ":2:2: column `temp_c`: 298.15: expected -100 to 200 degC (is it in kelvin?)",
            ),
            (
                "0,20,1\n1,2,0,5\n",
                ":3: 4 cells, but the header has 3 (a decimal comma, or a cut line?)",
            ),
            (
                "0,20,1\n",
                ": 1 usable rows after the header: expected at least 2",
            ),
        ] {
            assert_eq!(refused(&format!("{h}{rows}")), expected);
        }
        assert!(refused("").contains("the file is empty"));
        assert!(refused(h).contains(": 0 usable rows"));
        assert!(refused("time_s,x_dps\n0,1\n").starts_with(":1: no temperature column"));
    }

    #[test]
    fn bad_rows_are_skipped_and_counted_only_on_request() {
        let options = ReadOptions {
            skip_bad_rows: true,
            ..ReadOptions::default()
        };
        let text = "time_s,temp_c,x_dph\n0,20,1\n1,x,2\n1.5,21,nan\n1,22,3\n2,23\n3,24,4\n";
        let log = read(text, &options).unwrap();
        assert_eq!((log.rows(), log.skipped_rows), (3, 3));
        assert_eq!(log.time_s, [0.0, 1.0, 3.0]);
        assert_eq!(log.channels[0].temp_c, [20.0, 22.0, 24.0]);
        assert_eq!(log.channels[0].axes[0].raw, [1.0, 3.0, 4.0]);
    }
}
