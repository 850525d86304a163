//! Earned states of a table as data.

use serde::{Deserialize, Serialize};
use tempco::{Play, SlowPart};

use super::{ChannelSet, GainSet};

/// The most plays and slow parts of a table.
pub(super) const MOST: (usize, usize) = (2, 1);

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

/// Gives all channels as many plays and slow parts as the one with the most, by terms without
/// gain: firmware has one type of table for all channels.
pub(crate) fn level_history(channels: &mut [ChannelSet]) {
    let most = |count: fn(&ChannelSet) -> usize| channels.iter().map(count).max().unwrap_or(0);
    let plays = most(|channel| channel.table.plays.len());
    let slow_parts = most(|channel| channel.table.slow_parts.len());
    for channel in channels {
        let axes = channel.axes.len();
        let table = &mut channel.table;
        let before = table.plays.len();
        let gain = vec![0.0; axes];
        table.plays.resize(
            plays,
            PlayData {
                half_width_c: 0.0,
                gain: gain.clone(),
            },
        );
        table.slow_parts.resize(
            slow_parts,
            SlowPartData {
                tau_s: table.thermal.tau_s,
                limit_c: 0.0,
                gain,
            },
        );
        for axis in &mut channel.axes {
            let of_slow = axis.gains.split_off(before.min(axis.gains.len()));
            axis.gains.resize(plays, GainSet::default());
            axis.gains.extend(of_slow);
            axis.gains.resize(plays + slow_parts, GainSet::default());
        }
    }
}
