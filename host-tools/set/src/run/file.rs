//! A set run over a file that is read once more, in memory of a fixed size.
//!
//! The interval of the log must be known, from the first reading: the first row takes it, and pulse
//! counts are divided by it.

use std::path::{Path, PathBuf};

use tempco::TableError;
use tempco_log::{LogError, LogStream, ReadOptions};
use thiserror::Error;

use super::columns::{ApplyError, ChannelInputs, Columns, LogAxis};
use super::compensators::{Applied, Rows, with_compensators};
use super::updates::Updates;
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

/// Runs the core over a log as a unit switched on at its first row; `sink` gets the times of some
/// rows \[s\], the columns that the channels take, what came of them, and the number of bytes of the
/// file that were read so far.
///
/// # Errors
/// A log that cannot be read, lacks an axis of the set, or is not the one of the first reading.
pub fn apply_to_file(
    set: &CoefficientSet,
    log: &KnownLog,
    options: &ReadOptions,
    mut sink: impl FnMut(&[f64], &[ChannelInputs], &Applied, u64),
) -> Result<(), RunError> {
    let mut stream = LogStream::open(&log.path, options)?;
    let (named, factors): (Vec<LogAxis>, Vec<f64>) = axes(&stream, log, options).unzip();
    let columns = Columns::find(set, &log.path.display().to_string(), &named)?;
    drop(named);
    with_compensators(set, |step| -> Result<(), RunError> {
        let mut updates = None;
        while let Some(mut chunk) = stream.next_chunk()? {
            let Some(&first_s) = chunk.time_s.first() else {
                continue;
            };
            let period_s = set.thermal_period_s(log.interval_s);
            let updates = updates.get_or_insert(Updates::new(first_s, log.interval_s, period_s));
            let updates_s = updates.of_rows(&chunk.time_s);
            for (axis, factor) in chunk.axes.iter_mut().zip(&factors) {
                axis.iter_mut().for_each(|value| *value *= factor);
            }
            let temps_c: Vec<&[f32]> = chunk.temps_c.iter().map(Vec::as_slice).collect();
            let raw: Vec<&[f64]> = chunk.axes.iter().map(Vec::as_slice).collect();
            let rows = Rows {
                updates_s: &updates_s,
                channels: columns.iter().map(|of| of.of(&temps_c, &raw)).collect(),
            };
            let applied = step(&rows);
            let bytes = stream.bytes_read();
            sink(&chunk.time_s, &rows.channels, &applied, bytes);
        }
        Ok(())
    })??;
    match stream.sha256() {
        Some(found) if found == log.sha256 => Ok(()),
        _ => Err(RunError::Changed(log.path.clone())),
    }
}

/// The axes of a log in their units, each with the factor that takes its column there.
fn axes<'a>(
    stream: &'a LogStream,
    log: &'a KnownLog,
    options: &'a ReadOptions,
) -> impl Iterator<Item = (LogAxis<'a>, f64)> {
    let channels = stream.channels().iter().enumerate();
    channels.flat_map(move |(channel, columns)| {
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
    /// The core refuses the table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The file is not the one that was read before.
    #[error("{}: changed while it was in use: expected the bytes of the first reading", .0.display())]
    Changed(PathBuf),
}

/// Whether a file can be read a second time: not a pipe or a terminal.
pub fn is_rereadable(path: &Path) -> bool {
    path.metadata().is_ok_and(|metadata| metadata.is_file())
}
