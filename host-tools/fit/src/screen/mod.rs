//! What does not belong into a fit: spikes, handling disturbances, stretches that were asked to be
//! left out; and what does but must be told apart: the constant of each log, steps of the bias.

mod disturbances;
mod spikes;
mod steps;

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

/// Takes excluded stretches out, and, if `robust`, spikes and disturbances; levels the logs.
///
/// # Errors
/// Settings that the core refuses.
pub(crate) fn screen(
    data: &mut ChannelData,
    settings: &ThermalSettings,
    exclude: &[Stretch],
    robust: bool,
) -> Result<Screening, TableError> {
    let mut screening = Screening {
        excluded_rows: leave_out(data, exclude),
        ..Screening::default()
    };
    if robust {
        screening.spike_rows = spikes::leave_out(data);
    }
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

fn leave_out(data: &mut ChannelData, exclude: &[Stretch]) -> usize {
    let mut count = 0;
    for (log, keep) in data.logs.iter().zip(&mut data.keep) {
        for (time_s, keep) in log.time_s.iter().zip(keep) {
            let excluded = exclude
                .iter()
                .any(|stretch| (stretch.from_s..=stretch.to_s).contains(time_s));
            count += usize::from(excluded && *keep);
            *keep &= !excluded;
        }
    }
    count
}

/// The median; 0 of nothing. The order of `values` is lost.
fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Standard deviation of normal values over their median distance from the median.
pub(crate) const SIGMA_PER_MAD: f64 = 1.4826;

/// Standard deviation of white noise over the median distance of neighbours.
const SIGMA_PER_STEP: f64 = 1.0 / 0.9539;
