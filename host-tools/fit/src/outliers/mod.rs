//! What does not belong into a fit: spikes, handling disturbances, stretches that the user
//! excludes. Also what belongs but needs care: the constant of each log, steps of the bias.

mod disturbances;
mod gaps;
mod leaps;
mod limits;
mod parts;
mod spikes;
mod steps;

pub(crate) use spikes::{SpikeFilter, window_rows};

use tempco::{TableError, ThermalSettings};
use tempco_set::{Disturbance, Outliers};

use crate::summary::ChannelData;

/// Counts what was left out of the blocks, takes disturbed blocks out if `robust`, and levels the
/// logs.
///
/// # Errors
/// Settings that the core refuses.
pub(crate) fn leave_out(
    data: &mut ChannelData,
    settings: &ThermalSettings,
    robust: bool,
) -> Result<Outliers, TableError> {
    let logs = || (0..data.logs.len()).map(|log| data.of(log));
    let mut outliers = Outliers {
        excluded_rows: logs().map(|log| log.excluded_rows).sum(),
        spike_rows: logs().map(|log| log.spike_rows).sum(),
        spikes: spikes(data),
        ..Outliers::default()
    };
    if robust || data.logs.len() > 1 {
        let found = disturbances::find(data, settings, robust)?;
        outliers.disturbed_rows = found.leave_out(data);
        outliers.disturbances = found.disturbances(data);
        outliers.steps = found.steps(data);
        data.offsets = found.offsets(data);
        data.moved = found.moved();
        if data.logs.len() > 1 {
            outliers.constants = found.constants();
            data.constants.clone_from(&outliers.constants);
        }
    }
    Ok(outliers)
}

/// Where the spikes are, by log and axis.
fn spikes(data: &ChannelData) -> Vec<Disturbance> {
    let mut found = Vec::new();
    for (number, log) in data.logs.iter().enumerate() {
        let channel = data.of(number);
        let axes = channel.axes.iter().zip(&channel.spiked);
        found.extend(
            axes.filter(|(_, at)| at.rows > 0)
                .map(|(axis, at)| Disturbance {
                    file: log.file.clone(),
                    axis: axis.name.clone(),
                    rows: at.rows,
                    share: at.rows as f64 / log.rows as f64,
                    from_s: at.from_s,
                    to_s: at.to_s,
                    left_out: true,
                }),
        );
    }
    found
}

/// Standard deviation of normal values over their median distance from the median.
pub(crate) const SIGMA_PER_MAD: f64 = 1.4826;

/// Standard deviation of white noise over the median distance of neighbours.
const SIGMA_PER_STEP: f64 = 1.0 / 0.9539;
