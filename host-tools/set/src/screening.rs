//! What was left out of a fit, and what was found in its logs.

use serde::{Deserialize, Serialize};

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
