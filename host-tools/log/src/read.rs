//! Reads whole logs.

use std::path::Path;

use super::axis_columns::AxisColumn;
use super::channel_columns::ChannelColumns;
use super::chunk::Chunk;
use super::frame::{Frame, path_of};
use super::interval::Intervals;
use super::mapping::Mapping;
use super::signals::{Finding, Signals};
use super::stream::LogStream;
use super::{Axis, Channel, Log, LogError};

/// How to read a log.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Columns that do not follow the naming rule.
    pub mapping: Mapping,
    /// Mappings that were kept with a set: the first whose columns a log has gives what is not named.
    pub kept: Vec<Mapping>,
    /// Turns pulse counts into deg/h \[arcsec per pulse\]; without it they become pulses/s.
    pub scale_factor_arcsec: Option<f64>,
    /// Leave out rows with a bad cell and count them, instead of refusing the log.
    pub skip_bad_rows: bool,
}

/// Reads the log at `path`: CSV, as it is or packed by gzip or zstd, or Parquet.
///
/// Pulse counts are divided by the median interval between rows, since a count belongs to one
/// sample however long the gap before it; 1 arcsec/s is 1 deg/h.
///
/// # Errors
/// The first thing that is wrong, with file, line and column: a header that does not name time,
/// temperature and axes with their units, a cell that is not a finite number, time that does not
/// increase, temperatures that cannot be degC, fewer than two rows; packed data that is cut off.
pub fn read_log(path: &Path, options: &ReadOptions) -> Result<Log, LogError> {
    read_log_observed(path, options, |_| ())
}

/// Reads a log as [`read_log`] does, telling `observer` from time to time how many more bytes of
/// the file were read.
///
/// # Errors
/// Those of [`read_log`].
pub fn read_log_observed(
    path: &Path,
    options: &ReadOptions,
    observer: impl FnMut(u64),
) -> Result<Log, LogError> {
    whole(LogStream::open(path, options)?, path, options, observer)
}

/// Reads columns in memory as [`read_log`] reads the columns of a file.
///
/// # Errors
/// Those of [`read_log`], with row and column.
pub fn read_frame(frame: Frame, options: &ReadOptions) -> Result<Log, LogError> {
    let path = path_of(&frame).to_owned();
    whole(LogStream::of_frame(frame, options)?, &path, options, |_| ())
}

/// Reads a log to its end and keeps all rows.
fn whole(
    stream: LogStream,
    path: &Path,
    options: &ReadOptions,
    observer: impl FnMut(u64),
) -> Result<Log, LogError> {
    let mut rows: Option<Chunk> = None;
    let (mut log, factors) =
        read_through(
            stream,
            path,
            options,
            observer,
            |_, chunk| match &mut rows {
                Some(rows) => rows.append(&chunk),
                None => rows = Some(chunk),
            },
        )?;
    let rows = rows.unwrap_or_default();
    // The columns, with the axes in their units.
    log.time_s = rows.time_s;
    let mut axes = rows.axes.into_iter().zip(factors);
    for (channel, temp_c) in log.channels.iter_mut().zip(rows.temps_c) {
        channel.temp_c = temp_c;
        for (axis, (raw, factor)) in channel.axes.iter_mut().zip(&mut axes) {
            axis.raw = raw;
            axis.raw.iter_mut().for_each(|value| *value *= factor);
        }
    }
    Ok(log)
}

/// A log that was read to its end, of which no row was kept.
#[derive(Clone, Debug)]
pub struct Survey {
    /// The log without its rows.
    pub head: Log,
    /// How many it has.
    pub rows: usize,
    /// Time from the first to the last one \[s\].
    pub duration_s: f64,
    /// What is wrong with its signals.
    pub findings: Vec<Finding>,
}

/// Reads a log as [`read_log_observed`] does, in memory that does not depend on its length.
///
/// # Errors
/// Those of [`read_log`].
pub fn survey_log_observed(
    path: &Path,
    options: &ReadOptions,
    observer: impl FnMut(u64),
) -> Result<Survey, LogError> {
    let (mut rows, mut first_s, mut last_s) = (0, None, 0.0);
    let mut signals: Vec<Signals> = Vec::new();
    let stream = LogStream::open(path, options)?;
    let (head, _) = read_through(stream, path, options, observer, |channels, chunk| {
        rows += chunk.rows();
        last_s = *chunk.time_s.last().unwrap_or(&last_s);
        first_s = first_s.or(chunk.time_s.first().copied());
        if signals.is_empty() {
            signals.extend(channels.iter().map(|of| Signals::new(of.axes.len())));
        }
        let mut axes = chunk.axes.iter().map(Vec::as_slice);
        for ((signals, columns), temp_c) in signals.iter_mut().zip(channels).zip(&chunk.temps_c) {
            let axes: Vec<&[f64]> = axes.by_ref().take(columns.axes.len()).collect();
            signals.take(&chunk.time_s, temp_c, &axes);
        }
    })?;
    let findings = signals.into_iter().zip(&head.channels);
    let findings = findings.flat_map(|(signals, channel)| {
        let names: Vec<&str> = channel.axes.iter().map(|axis| &axis.name[..]).collect();
        signals.finish(&channel.column, &names)
    });
    Ok(Survey {
        rows,
        duration_s: last_s - first_s.unwrap_or(last_s),
        findings: findings.collect(),
        head,
    })
}

/// Reads a log to its end and passes its rows on, in the units of their columns. Returns the log
/// without rows, and for each axis the factor that takes its column to the unit of the axis.
fn read_through(
    mut stream: LogStream,
    path: &Path,
    options: &ReadOptions,
    mut observer: impl FnMut(u64),
    mut sink: impl FnMut(&[ChannelColumns], Chunk),
) -> Result<(Log, Vec<f64>), LogError> {
    let (mut told, mut rows, mut intervals) = (0, 0, Intervals::new());
    while let Some(chunk) = stream.next_chunk()? {
        rows += chunk.rows();
        intervals.take(&chunk.time_s);
        sink(stream.channels(), chunk);
        observer(stream.bytes_read() - told);
        told = stream.bytes_read();
    }
    if rows < 2 {
        return Err(LogError::too_few_rows(path, rows));
    }
    let interval_s = intervals.median_s();
    let mut factors = Vec::new();
    let mut axis = |column: &AxisColumn| {
        let of_pulses = options.scale_factor_arcsec;
        let (factor, unit) = column.unit.in_axis_unit(interval_s, of_pulses);
        factors.push(factor);
        Axis {
            name: column.name.clone(),
            unit,
            raw: Vec::new(),
        }
    };
    let channel = |columns: &ChannelColumns| Channel {
        column: columns.column.clone(),
        temp_c: Vec::new(),
        axes: columns.axes.iter().map(&mut axis).collect(),
    };
    let file = path.file_name().unwrap_or_default();
    let log = Log {
        file: file.to_string_lossy().into(),
        sha256: stream.sha256().unwrap_or_default().to_owned(),
        time_s: Vec::new(),
        channels: stream.channels().iter().map(channel).collect(),
        reading: stream.reading(),
        ignored_columns: stream.ignored().to_vec(),
        skipped_rows: stream.skipped_rows(),
        interval_s,
    };
    Ok((log, factors))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::skipped::SkippedRows;
    use crate::unit::AxisUnit;

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
    fn a_refused_row_has_its_line_whatever_was_left_out_before_it() {
        // A row that is written twice, a blank line, and temperatures that end.
        let blanks: String = (2..20).map(|t| format!("{t},,1\n")).collect();
        let blanks = blanks.replace("5,,1\n", "5,,1\n\n");
        let text = format!("time_s,temp_c,x_dph\n0,20,1\n1,20,1\n1,20,1\n{blanks}");
        let expected = ":16:2: column `temp_c`: an empty cell, and no temperature in the 10 s";
        assert!(refused(&text).starts_with(expected), "{}", refused(&text));
    }

    #[test]
    fn bad_rows_are_skipped_and_counted_only_on_request() {
        let options = ReadOptions {
            skip_bad_rows: true,
            ..ReadOptions::default()
        };
        let text = "time_s,temp_c,x_dph\n0,20,1\n1,x,2\n1.5,21,nan\n1,22,3\n2,23\n2.5,22,\n2.6,300,1\n\
            3,24,4\n3,24,5\n2,24,4\n";
        let log = read(text, &options).unwrap();
        let skipped = SkippedRows {
            cell_count: 1,
            empty_cell: 1,
            not_a_number: 2,
            out_of_range: 1,
            time_order: 2,
            damaged: 0,
        };
        assert_eq!((log.rows(), log.skipped_rows), (3, skipped));
        assert_eq!((skipped.total(), skipped.share(3)), (7, 0.7));
        assert_eq!(
            skipped.to_string(),
            "wrong number of cells 1, empty cell 1, not a number 2, out of range 1, time does not \
             increase 2"
        );
        assert_eq!(log.time_s, [0.0, 1.0, 3.0]);
        assert_eq!(log.channels[0].temp_c, [20.0, 22.0, 24.0]);
        assert_eq!(log.channels[0].axes[0].raw, [1.0, 3.0, 4.0]);
    }
}
