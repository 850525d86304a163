//! What was left out of a fit, and what was found in its logs.

use serde::{Deserialize, Serialize};

use crate::Extent;

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
    /// Whether the fit takes it out: the parts of the log before and after it have constants of
    /// their own.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub levelled: bool,
    /// Whether it is larger than a unit at rest can step.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub large: bool,
}

/// Rows of an axis that are far from their neighbours, or from what temperature explains.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Disturbance {
    /// Name of the log's file.
    pub file: String,
    /// Name of the axis.
    pub axis: String,
    /// How many they are.
    pub rows: usize,
    /// Their share of the log's rows, 0 to 1.
    pub share: f64,
    /// Time of the first of them \[s\].
    pub from_s: f64,
    /// Time of the last of them \[s\].
    pub to_s: f64,
    /// Whether they are left out of the fit; otherwise they are too many for that.
    pub left_out: bool,
}

impl Disturbance {
    /// Where more of a log is disturbed than this share, what is left cannot be trusted.
    pub const MOST_SHARE: f64 = 0.05;

    /// Whether it is too much to go on with the rest.
    pub fn is_too_much(&self) -> bool {
        !self.left_out || self.share > Self::MOST_SHARE
    }
}

/// What outliers found in the logs of a channel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outliers {
    /// Rows left out because they lie in a stretch that was excluded.
    pub excluded_rows: usize,
    /// Rows left out because an axis is far from its neighbours in time.
    pub spike_rows: usize,
    /// Rows left out because an axis is, for ten seconds or more, far from what temperature
    /// explains.
    pub disturbed_rows: usize,
    /// Where the spikes are, by log and axis.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spikes: Vec<Disturbance>,
    /// What is disturbed, by log and axis.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub disturbances: Vec<Disturbance>,
    /// What the fitted rows cover, where there is something to say of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extent: Option<Extent>,
    /// Steps of the bias.
    pub steps: Vec<BiasStep>,
    /// For each log, how far the constant bias of each axis is from the mean of the logs
    /// \[unit of the axis\]; empty with one log.
    pub constants: Vec<Vec<f64>>,
}
