//! How far a run goes in temperature and time, and whether that is enough for a model.

use serde::{Deserialize, Serialize};

/// What the fitted rows of a channel cover.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Extent {
    /// Degrees that hold rows \[degC\]: not the span, which may have holes.
    pub covered_c: usize,
    /// Means of 10 s.
    pub means: usize,
    /// By how much the temperature rose in all, turns of less than 2 degC aside \[degC\].
    pub heated_c: f64,
    /// By how much it fell \[degC\].
    pub cooled_c: f64,
    /// Where it changed faster than the core follows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub too_fast: Option<TooFast>,
}

/// Temperature that changes faster than the core follows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TooFast {
    /// Name of the log's file.
    pub file: String,
    /// Fastest change over 10 s \[degC/min\].
    pub rate_c_per_min: f64,
    /// Fastest change that the core follows \[degC/min\].
    pub limit_c_per_min: f64,
    /// Share of the log's means, 0 to 1.
    pub share: f64,
    /// Time of the first of them \[s\].
    pub from_s: f64,
    /// Time of the last of them \[s\].
    pub to_s: f64,
}

impl Extent {
    /// A run that covers less carries no model \[degC\].
    pub const LEAST_COVERED_C: usize = 15;
    /// A run of fewer means carries no model.
    pub const LEAST_MEANS: usize = 20;
    /// A run of fewer means carries a model badly.
    pub const ENOUGH_MEANS: usize = 60;
    /// The share of the covered degrees that must be passed in the other direction.
    const RETURN_SHARE: f64 = 0.2;

    /// Whether the run is too short or too narrow for any model.
    pub const fn is_too_thin(&self) -> bool {
        self.covered_c < Self::LEAST_COVERED_C || self.means < Self::LEAST_MEANS
    }

    /// Whether there are few means.
    pub const fn is_short(&self) -> bool {
        self.means < Self::ENOUGH_MEANS
    }

    /// Whether the run only heats, or only cools.
    pub fn is_one_way(&self) -> bool {
        self.heated_c.min(self.cooled_c) < Self::RETURN_SHARE * self.covered_c as f64
    }

    /// Whether anything is to be said of it.
    pub fn is_thin(&self) -> bool {
        self.is_too_thin() || self.is_short() || self.is_one_way() || self.too_fast.is_some()
    }
}
