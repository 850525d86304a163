//! A set run over a log in memory.

use tempco_log::Log;

use super::columns::{ApplyError, ChannelInputs, Columns, LogAxis};
use super::compensators::{Applied, Rows, with_compensators};
use super::updates::Updates;
use crate::CoefficientSet;

/// Runs the core over `log` as a unit switched on at its first row.
///
/// # Errors
/// A log without an axis or temperature of the set, or with another unit.
pub fn apply(set: &CoefficientSet, log: &Log) -> Result<Applied, ApplyError> {
    let mut updates = Updates::of_log(log, set.thermal_period_s(log.interval_s));
    let rows = Rows {
        updates_s: &updates.of_rows(&log.time_s),
        channels: inputs(set, log)?,
    };
    Ok(with_compensators(set, |step| step(&rows))?)
}

/// Finds the columns of each channel of the set in the log, by the names of the axes.
///
/// # Errors
/// An axis that is not in the log, or in another unit.
pub fn inputs<'a>(
    set: &'a CoefficientSet,
    log: &'a Log,
) -> Result<Vec<ChannelInputs<'a>>, ApplyError> {
    let channels = || log.channels.iter().enumerate();
    let axes =
        || channels().flat_map(|(channel, of)| of.axes.iter().map(move |axis| (channel, axis)));
    let named: Vec<LogAxis> = axes()
        .map(|(channel, axis)| LogAxis {
            channel,
            name: &axis.name,
            unit: axis.unit,
        })
        .collect();
    let temps_c: Vec<&[f32]> = channels().map(|(_, channel)| &channel.temp_c[..]).collect();
    let raw: Vec<&[f64]> = axes().map(|(_, axis)| &axis.raw[..]).collect();
    let columns = Columns::find(set, &log.file, &named)?;
    Ok(columns.iter().map(|of| of.of(&temps_c, &raw)).collect())
}
