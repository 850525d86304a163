//! Which columns of a log the channels of a set take.

use tempco::TableError;
use tempco_log::AxisUnit;
use thiserror::Error;

use crate::{ChannelSet, CoefficientSet};

/// The columns of a log that a channel of a set takes.
pub struct ChannelInputs<'a> {
    /// The channel.
    pub channel: &'a ChannelSet,
    /// Its temperature \[degC\].
    pub temp_c: &'a [f32],
    /// The values of its axes, in their units.
    pub raw: Vec<&'a [f64]>,
}

impl ChannelInputs<'_> {
    /// The values of one row as the firmware sees them.
    ///
    /// # Panics
    /// If the channel has fewer than `AXES` axes.
    pub fn row<const AXES: usize>(&self, row: usize) -> [f32; AXES] {
        std::array::from_fn(|axis| self.raw[axis][row] as f32)
    }
}

/// An axis of a log.
pub(super) struct LogAxis<'a> {
    /// Number of its temperature channel.
    pub(super) channel: usize,
    pub(super) name: &'a str,
    pub(super) unit: AxisUnit,
}

/// Numbers of the columns of a log that a channel of a set takes.
pub(super) struct Columns<'a> {
    channel: &'a ChannelSet,
    /// Among the temperature channels.
    temp: usize,
    /// Among all axes.
    axes: Vec<usize>,
}

impl<'a> Columns<'a> {
    /// Finds the columns of each channel of the set by the names of the axes.
    pub(super) fn find(
        set: &'a CoefficientSet,
        file: &str,
        log: &[LogAxis],
    ) -> Result<Vec<Self>, ApplyError> {
        let number = |name: &str| log.iter().position(|column| column.name == name);
        let of_channel = |channel: &'a ChannelSet| {
            let mut axes = Vec::new();
            for axis in &channel.axes {
                let number = number(&axis.name).ok_or_else(|| ApplyError::NoAxis {
                    file: file.to_owned(),
                    axis: axis.name.clone(),
                    serial: set.serial.clone(),
                })?;
                let found = log[number].unit;
                if found != axis.unit {
                    return Err(ApplyError::Unit {
                        file: file.to_owned(),
                        axis: axis.name.clone(),
                        found: found.name(),
                        expected: axis.unit.name(),
                    });
                }
                axes.push(number);
            }
            Ok(Self {
                channel,
                temp: axes.first().map_or(0, |&first| log[first].channel),
                axes,
            })
        };
        set.channels.iter().map(of_channel).collect()
    }

    /// The columns themselves, of the temperatures and axes of a log.
    pub(super) fn of<'b>(&self, temps_c: &[&'b [f32]], axes: &[&'b [f64]]) -> ChannelInputs<'b>
    where
        'a: 'b,
    {
        ChannelInputs {
            channel: self.channel,
            temp_c: temps_c[self.temp],
            raw: self.axes.iter().map(|&axis| axes[axis]).collect(),
        }
    }
}

/// A set cannot be applied to a log.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ApplyError {
    /// An axis is missing.
    #[error("{file}: no axis `{axis}`, which the set of {serial} compensates")]
    NoAxis {
        /// The log.
        file: String,
        /// Name of the axis.
        axis: String,
        /// Serial number of the set.
        serial: String,
    },
    /// An axis is in another unit.
    #[error("{file}: axis `{axis}` is in {found}, but the set expects {expected}")]
    Unit {
        /// The log.
        file: String,
        /// Name of the axis.
        axis: String,
        /// Unit in the log.
        found: &'static str,
        /// Unit in the set.
        expected: &'static str,
    },
    /// The core refuses the table.
    #[error(transparent)]
    Table(#[from] TableError),
}
