//! Summarises whole logs: from a file as it is read, or from memory.

use std::ops::Range;
use std::path::Path;

use tempco_log::signals::Signals;
use tempco_log::{Chunk, Intervals, Log, LogError, LogStream, ReadOptions};

use crate::options::Plan;
use crate::summary::channel::ChannelSummariser;
use crate::summary::{AxisName, ChannelSummary, LogSummary, signals};

/// Rows from which the interval is taken that the core's first step and the grid start with.
const FIRST_ROWS: usize = 4096;

/// Summarises the log at `path` in one pass, in memory that does not depend on its length, telling
/// `observer` from time to time how many more bytes of the file were read.
///
/// # Errors
/// Those of [`read_log`](tempco_log::read_log).
pub fn summarise_file(
    path: &Path,
    options: &ReadOptions,
    plan: &Plan,
    mut observer: impl FnMut(u64),
) -> Result<LogSummary, LogError> {
    let mut stream = LogStream::open(path, options)?;
    let (mut told, mut rows) = (0, 0);
    let mut intervals = Intervals::new();
    let mut first = stream.empty_chunk();
    let mut summariser: Option<LogSummariser> = None;
    let (mut first_s, mut last_s) = (0.0, 0.0);
    while let Some(chunk) = stream.next_chunk()? {
        intervals.take(&chunk.time_s);
        if let (0, Some(&time_s)) = (rows, chunk.time_s.first()) {
            first_s = time_s;
        }
        last_s = chunk.time_s.last().copied().unwrap_or(last_s);
        rows += chunk.rows();
        match &mut summariser {
            Some(summariser) => summariser.take_chunk(&chunk),
            None => {
                first.append(&chunk);
                if first.rows() >= FIRST_ROWS {
                    summariser = Some(LogSummariser::start(plan, &stream, &first));
                }
            }
        }
        let bytes = stream.bytes_read();
        observer(bytes - told);
        told = bytes;
    }
    if rows < 2 {
        return Err(LogError::too_few_rows(path, rows));
    }
    let summariser = summariser.unwrap_or_else(|| LogSummariser::start(plan, &stream, &first));
    let interval_s = intervals.median_s();
    let (mut channels, mut findings) = (Vec::new(), Vec::new());
    for (columns, of_channel) in stream.channels().iter().zip(summariser.channels) {
        let mut channel = of_channel.summariser.finish();
        channel.column.clone_from(&columns.column);
        let names = columns.axes.iter().map(|column| &column.name[..]);
        let names: Vec<&str> = names.collect();
        findings.extend(of_channel.signals.finish(&channel.column, &names));
        for (axis, column) in columns.axes.iter().enumerate() {
            let (factor, unit) = column
                .unit
                .in_axis_unit(interval_s, options.scale_factor_arcsec);
            channel.scale(axis, factor);
            channel.axes.push(AxisName {
                name: column.name.clone(),
                unit,
            });
        }
        channels.push(channel);
    }
    Ok(LogSummary {
        plan: plan.clone(),
        file: path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into(),
        sha256: stream.sha256().unwrap_or_default().to_owned(),
        rows,
        skipped_rows: stream.skipped_rows(),
        interval_s,
        duration_s: last_s - first_s,
        reading: stream.reading(),
        ignored_columns: stream.ignored().to_vec(),
        findings,
        channels,
    })
}

/// Summarises a log that was read.
///
/// # Panics
/// If the log has no row.
pub fn summarise_log(log: &Log, plan: &Plan) -> LogSummary {
    let (first_s, last_s) = (log.time_s[0], log.time_s[log.rows() - 1]);
    let (mut channels, mut findings) = (Vec::new(), Vec::new());
    for channel in &log.channels {
        let start = (first_s, log.interval_s);
        let axes: Vec<&[f64]> = channel.axes.iter().map(|axis| &axis.raw[..]).collect();
        let mut summariser = ChannelSummariser::new(plan, axes.len(), start, channel.temp_c[0]);
        summariser.take(&log.time_s, &channel.temp_c, &axes);
        let mut signals = Signals::new(axes.len());
        signals::take(
            &mut signals,
            &plan.options.exclude,
            &log.time_s,
            &channel.temp_c,
            &axes,
        );
        let names: Vec<&str> = channel.axes.iter().map(|axis| &axis.name[..]).collect();
        findings.extend(signals.finish(&channel.column, &names));
        let names = channel.axes.iter().map(|axis| AxisName {
            name: axis.name.clone(),
            unit: axis.unit,
        });
        channels.push(ChannelSummary {
            column: channel.column.clone(),
            axes: names.collect(),
            ..summariser.finish()
        });
    }
    LogSummary {
        plan: plan.clone(),
        file: log.file.clone(),
        sha256: log.sha256.clone(),
        rows: log.rows(),
        skipped_rows: log.skipped_rows,
        interval_s: log.interval_s,
        duration_s: last_s - first_s,
        reading: log.reading.clone(),
        ignored_columns: log.ignored_columns.clone(),
        findings,
        channels,
    }
}

/// All channels of a stream.
struct LogSummariser<'a> {
    plan: &'a Plan,
    channels: Vec<OfChannel<'a>>,
}

struct OfChannel<'a> {
    summariser: ChannelSummariser<'a>,
    signals: Signals,
    /// Its axes among all.
    axes: Range<usize>,
}

impl<'a> LogSummariser<'a> {
    /// Starts with the first rows, of which there is one at least.
    fn start(plan: &'a Plan, stream: &LogStream, first: &Chunk) -> Self {
        let mut intervals = Intervals::new();
        intervals.take(&first.time_s);
        let start = (first.time_s[0], intervals.median_s());
        let mut axis = 0;
        let channels = stream.channels().iter().zip(&first.temps_c);
        let channels = channels.map(|(columns, temp_c)| {
            let axes = axis..axis + columns.axes.len();
            axis = axes.end;
            OfChannel {
                summariser: ChannelSummariser::new(plan, axes.len(), start, temp_c[0]),
                signals: Signals::new(axes.len()),
                axes,
            }
        });
        let mut summariser = Self {
            plan,
            channels: channels.collect(),
        };
        summariser.take_chunk(first);
        summariser
    }

    fn take_chunk(&mut self, chunk: &Chunk) {
        for (channel, temp_c) in self.channels.iter_mut().zip(&chunk.temps_c) {
            let axes = chunk.axes[channel.axes.clone()].iter();
            let axes: Vec<&[f64]> = axes.map(|a| &a[..]).collect();
            channel.summariser.take(&chunk.time_s, temp_c, &axes);
            let (signals, exclude) = (&mut channel.signals, &self.plan.options.exclude);
            signals::take(signals, exclude, &chunk.time_s, temp_c, &axes);
        }
    }
}

impl ChannelSummary {
    /// Multiplies the values of an axis.
    fn scale(&mut self, axis: usize, factor: f64) {
        for block in &mut self.blocks {
            let spread = &mut block.moments.axes[axis];
            spread.mean *= factor;
            spread.squares *= factor * factor;
        }
        self.white_sigmas[axis] *= factor;
    }
}
