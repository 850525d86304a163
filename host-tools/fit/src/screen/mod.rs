//! What does not belong into a fit: spikes, handling disturbances, stretches that were asked to be
//! left out; and what does but must be told apart: the constant of each log, steps of the bias.

mod disturbances;
mod spikes;
mod steps;

pub(crate) use spikes::{SpikeScreen, window_rows};

use serde::{Deserialize, Serialize};
use tempco::{TableError, ThermalSettings};

use crate::regress::ChannelData;

/// A stretch of log time \[s\], both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stretch {
    /// Begin \[s\].
    pub from_s: f64,
    /// End \[s\].
    pub to_s: f64,
}

/// A sudden and lasting change of an axis's bias.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BiasStep {
    /// Name of the log's file.
    pub file: String,
    /// Name of the axis.
    pub axis: String,
    /// Time in the log, to about a minute \[s\].
    pub time_s: f64,
    /// Bias after it less bias before it \[unit of the axis\].
    pub size: f64,
}

/// What screening found in the logs of a channel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Screening {
    /// Rows left out because they lie in a stretch that was excluded.
    pub excluded_rows: usize,
    /// Rows left out because an axis is far from its neighbours in time.
    pub spike_rows: usize,
    /// Rows left out because an axis is, for ten seconds or more, far from what temperature
    /// explains.
    pub disturbed_rows: usize,
    /// Steps of the bias; they stay in the fit.
    pub steps: Vec<BiasStep>,
    /// For each log, how far the constant bias of each axis is from the mean of the logs
    /// \[unit of the axis\]; empty with one log.
    pub constants: Vec<Vec<f64>>,
}

/// Counts what was left out of the blocks, takes disturbed blocks out if `robust`, and levels the
/// logs.
///
/// # Errors
/// Settings that the core refuses.
pub(crate) fn screen(
    data: &mut ChannelData,
    settings: &ThermalSettings,
    robust: bool,
) -> Result<Screening, TableError> {
    let logs = || (0..data.logs.len()).map(|log| data.of(log));
    let mut screening = Screening {
        excluded_rows: logs().map(|log| log.excluded_rows).sum(),
        spike_rows: logs().map(|log| log.spike_rows).sum(),
        ..Screening::default()
    };
    if robust || data.logs.len() > 1 {
        let found = disturbances::find(data, settings, robust)?;
        screening.disturbed_rows = found.leave_out(data);
        screening.steps = found.steps(data);
        if data.logs.len() > 1 {
            screening.constants = found.constants();
            data.constants.clone_from(&screening.constants);
        }
    }
    Ok(screening)
}

/// Standard deviation of normal values over their median distance from the median.
pub(crate) const SIGMA_PER_MAD: f64 = 1.4826;

/// Standard deviation of white noise over the median distance of neighbours.
const SIGMA_PER_STEP: f64 = 1.0 / 0.9539;
