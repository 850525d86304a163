//! History terms of a table as data.

use serde::{Deserialize, Serialize};
use tempco::{Play, SlowPart};

/// The most plays and second lags of a table.
pub(super) const MOST: (usize, usize) = (2, 1);

/// A term of the history, all but its gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// A hysteresis term.
    Play {
        /// Half width of the slot \[degC\].
        half_width_c: f64,
    },
    /// A second lag.
    SlowPart {
        /// Time constant \[s\].
        tau_s: f64,
    },
}

/// A hysteresis term of the core ([`tempco::Play`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlayData {
    /// Half width of the slot \[degC\].
    pub half_width_c: f32,
    /// By axis \[unit of the axis per degC\].
    pub gain: Vec<f32>,
}

/// A second lag of the core ([`tempco::SlowPart`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlowPartData {
    /// Time constant \[s\].
    pub tau_s: f32,
    /// The largest lag that was calibrated \[degC\].
    pub limit_c: f32,
    /// By axis \[unit of the axis per degC\].
    pub gain: Vec<f32>,
}

impl PlayData {
    pub(super) fn numbers(&self) -> impl Iterator<Item = f32> {
        std::iter::once(self.half_width_c).chain(self.gain.iter().copied())
    }

    pub(super) fn play<const AXES: usize>(&self, first_axis: usize) -> Play<AXES> {
        Play {
            half_width_c: self.half_width_c,
            gain: std::array::from_fn(|axis| self.gain[first_axis + axis]),
        }
    }
}

impl SlowPartData {
    pub(super) fn numbers(&self) -> impl Iterator<Item = f32> {
        [self.tau_s, self.limit_c]
            .into_iter()
            .chain(self.gain.iter().copied())
    }

    pub(super) fn slow_part<const AXES: usize>(&self, first_axis: usize) -> SlowPart<AXES> {
        SlowPart {
            tau_s: self.tau_s,
            limit_c: self.limit_c,
            gain: std::array::from_fn(|axis| self.gain[first_axis + axis]),
        }
    }
}
