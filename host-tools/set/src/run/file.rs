//! A set run over a file that is read once more, in memory of a fixed size.
//!
//! The interval of the log must be known, from the first reading: the first row takes it, and pulse
//! counts are divided by it.

use std::path::{Path, PathBuf};

use tempco_log::{ChannelColumns, Log, LogError, LogStream, ReadOptions};
use thiserror::Error;

use super::columns::{ApplyError, LogAxis};
use super::parts::{LogHead, LogRows, Part, run_parts};
use crate::CoefficientSet;

/// A log and what is known of it from the first reading.
#[derive(Clone, Debug)]
pub struct KnownLog {
    /// The file.
    pub path: PathBuf,
    /// Median time between rows \[s\].
    pub interval_s: f64,
    /// SHA-256 of the file's bytes, in hexadecimal.
    pub sha256: String,
}

impl KnownLog {
    /// The file at `path` that was read as `log`, with or without its rows.
    pub fn new(path: &Path, log: &Log) -> Self {
        Self {
            path: path.to_owned(),
            interval_s: log.interval_s,
            sha256: log.sha256.clone(),
        }
    }
}

/// Runs the core over a log as a unit switched on at its first row, and `compared` along with `set`.
/// `sink` gets part after part; `observer` how many more bytes of the file were read.
///
/// # Errors
/// A log that cannot be read, lacks an axis of a set, or is not the one of the first reading.
pub fn apply_to_file(
    set: &CoefficientSet,
    compared: Option<&CoefficientSet>,
    log: &KnownLog,
    options: &ReadOptions,
    mut observer: impl FnMut(u64),
    sink: impl FnMut(Part),
) -> Result<(), RunError> {
    let mut stream = LogStream::open(&log.path, options)?;
    let columns = stream.channels().to_vec();
    let (axes, factors): (Vec<LogAxis>, Vec<f64>) = axes(&columns, log, options).unzip();
    let head = LogHead {
        file: &log.path.display().to_string(),
        axes: &axes,
        interval_s: log.interval_s,
    };
    let mut told = 0;
    let feed = |take: &mut dyn FnMut(&LogRows)| -> Result<(), LogError> {
        while let Some(mut chunk) = stream.next_chunk()? {
            for (axis, factor) in chunk.axes.iter_mut().zip(&factors) {
                axis.iter_mut().for_each(|value| *value *= factor);
            }
            take(&LogRows {
                time_s: &chunk.time_s,
                temps_c: chunk.temps_c.iter().map(Vec::as_slice).collect(),
                axes: chunk.axes.iter().map(Vec::as_slice).collect(),
            });
            observer(stream.bytes_read() - told);
            told = stream.bytes_read();
        }
        Ok(())
    };
    run_parts(set, compared, &head, feed, sink)??;
    match stream.sha256() {
        Some(found) if found == log.sha256 => Ok(()),
        _ => Err(RunError::Changed(log.path.clone())),
    }
}

/// The axes of a log in their units, each with the factor that takes its column there.
fn axes<'a>(
    channels: &'a [ChannelColumns],
    log: &'a KnownLog,
    options: &'a ReadOptions,
) -> impl Iterator<Item = (LogAxis<'a>, f64)> {
    channels
        .iter()
        .enumerate()
        .flat_map(move |(channel, columns)| {
            columns.axes.iter().map(move |axis| {
                let (factor, unit) = axis
                    .unit
                    .in_axis_unit(log.interval_s, options.scale_factor_arcsec);
                let name = &axis.name;
                (
                    LogAxis {
                        channel,
                        name,
                        unit,
                    },
                    factor,
                )
            })
        })
}

/// A set cannot be run over a file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunError {
    /// The log cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// It does not have what the set compensates.
    #[error(transparent)]
    Apply(#[from] ApplyError),
    /// The file is not the one that was read before.
    #[error("{}: changed while it was in use: expected the bytes of the first reading", .0.display())]
    Changed(PathBuf),
}

/// Whether a file can be read a second time: not a pipe or a terminal.
pub fn is_rereadable(path: &Path) -> bool {
    path.metadata().is_ok_and(|metadata| metadata.is_file())
}
