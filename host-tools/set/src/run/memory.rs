//! A set run over a log in memory.

use std::convert::Infallible;

use tempco_log::Log;

use super::columns::{ApplyError, ChannelInputs, Columns, LogAxis};
use super::compensators::Applied;
use super::parts::{LogHead, LogRows, Part, run_parts};
use crate::CoefficientSet;

/// Rows of a part.
const PART_ROWS: usize = 1 << 14;

/// Runs the core over `log` as a unit switched on at its first row.
///
/// # Errors
/// A log without an axis or temperature of the set, or with another unit.
pub fn apply(set: &CoefficientSet, log: &Log) -> Result<Applied, ApplyError> {
    let mut applied = Applied::default();
    in_parts(set, None, log, log.rows(), |part| applied = part.applied)?;
    Ok(applied)
}

/// Runs the core over `log` as [`apply()`] does, and `compared` along with `set`; `sink` gets part
/// after part.
///
/// # Errors
/// Those of [`apply()`], for both sets.
pub fn apply_to_log(
    set: &CoefficientSet,
    compared: Option<&CoefficientSet>,
    log: &Log,
    sink: impl FnMut(Part),
) -> Result<(), ApplyError> {
    in_parts(set, compared, log, PART_ROWS, sink)
}

fn in_parts(
    set: &CoefficientSet,
    compared: Option<&CoefficientSet>,
    log: &Log,
    part_rows: usize,
    sink: impl FnMut(Part),
) -> Result<(), ApplyError> {
    let (named, temps_c, axes) = columns(log);
    let head = LogHead {
        file: &log.file,
        axes: &named,
        interval_s: log.interval_s,
    };
    let feed = |take: &mut dyn FnMut(&LogRows)| -> Result<(), Infallible> {
        for start in (0..log.rows()).step_by(part_rows.max(1)) {
            let rows = start..log.rows().min(start + part_rows);
            take(&LogRows {
                time_s: &log.time_s[rows.clone()],
                temps_c: temps_c.iter().map(|temp_c| &temp_c[rows.clone()]).collect(),
                axes: axes.iter().map(|raw| &raw[rows.clone()]).collect(),
            });
        }
        Ok(())
    };
    let Ok(()) = run_parts(set, compared, &head, feed, sink)?;
    Ok(())
}

/// Finds the columns of each channel of the set in the log, by the names of the axes.
///
/// # Errors
/// An axis that is not in the log, or in another unit.
pub fn inputs<'a>(
    set: &'a CoefficientSet,
    log: &'a Log,
) -> Result<Vec<ChannelInputs<'a>>, ApplyError> {
    let (named, temps_c, axes) = columns(log);
    let columns = Columns::find(set, &log.file, &named)?;
    Ok(columns.iter().map(|of| of.of(&temps_c, &axes)).collect())
}

/// All axes of a log, its temperatures, and the values of its axes.
fn columns(log: &Log) -> (Vec<LogAxis<'_>>, Vec<&[f32]>, Vec<&[f64]>) {
    let channels = || log.channels.iter().enumerate();
    let axes = || channels().flat_map(|(channel, of)| of.axes.iter().map(move |of| (channel, of)));
    let named = axes().map(|(channel, axis)| LogAxis {
        channel,
        name: &axis.name,
        unit: axis.unit,
    });
    let temps_c = channels().map(|(_, channel)| &channel.temp_c[..]);
    let raw = axes().map(|(_, axis)| &axis.raw[..]);
    (named.collect(), temps_c.collect(), raw.collect())
}
