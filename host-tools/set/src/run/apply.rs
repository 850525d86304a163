//! Applies a set to a log by running the core over it.

use tempco::{Compensator, Interval, Output, Status, Table, TableError};
use tempco_log::Log;
use thiserror::Error;

use crate::{ChannelSet, CoefficientSet, TableUse, use_tables};

/// The most axes a channel can have.
const MAX_AXES: usize = 6;

/// A log after compensation.
#[derive(Clone, Debug)]
pub struct Applied {
    /// The axes in the order of the set.
    pub axes: Vec<AxisOutput>,
    /// For each row, the flags of all channels together.
    pub status: Vec<Status>,
}

/// An axis after compensation, all in the unit of the axis.
#[derive(Clone, Debug, Default)]
pub struct AxisOutput {
    /// As measured, in f32 as the firmware sees it.
    pub raw: Vec<f32>,
    /// The bias taken out.
    pub bias: Vec<f32>,
    /// `raw - bias`.
    pub compensated: Vec<f32>,
}

/// Runs the core over `log` as a unit switched on at its first row.
///
/// # Errors
/// A log without an axis or temperature of the set, or with another unit.
pub fn apply(set: &CoefficientSet, log: &Log) -> Result<Applied, ApplyError> {
    let mut applied = Applied {
        axes: Vec::new(),
        status: vec![Status::OK; log.rows()],
    };
    for inputs in inputs(set, log)? {
        macro_rules! run_for {
            ($($axes:literal)+) => {
                match inputs.channel.axes.len() {
                    $($axes => run::<$axes>(&inputs, log, &mut applied)?,)+
                    _ => unreachable!("a set has 1 to {MAX_AXES} axes"),
                }
            };
        }
        run_for!(1 2 3 4 5 6);
    }
    Ok(applied)
}

/// The columns of a log that a channel of a set takes.
pub struct ChannelInputs<'a> {
    /// The channel.
    pub channel: &'a ChannelSet,
    /// Its temperature \[degC\].
    pub temp_c: &'a [f32],
    /// The values of its axes.
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

/// Finds the columns of each channel of the set in the log, by the names of the axes.
///
/// # Errors
/// An axis that is not in the log, or in another unit.
pub fn inputs<'a>(
    set: &'a CoefficientSet,
    log: &'a Log,
) -> Result<Vec<ChannelInputs<'a>>, ApplyError> {
    set.channels
        .iter()
        .map(|channel| {
            let mut temp_c = None;
            let mut raw = Vec::new();
            for axis in &channel.axes {
                let found = log.channels.iter().find_map(|candidate| {
                    let axes = &candidate.axes;
                    let column = axes.iter().find(|column| column.name == axis.name)?;
                    Some((candidate, column))
                });
                let (source, column) = found.ok_or_else(|| ApplyError::NoAxis {
                    file: log.file.clone(),
                    axis: axis.name.clone(),
                    serial: set.serial.clone(),
                })?;
                if column.unit != axis.unit {
                    return Err(ApplyError::Unit {
                        file: log.file.clone(),
                        axis: axis.name.clone(),
                        found: column.unit.name(),
                        expected: axis.unit.name(),
                    });
                }
                temp_c.get_or_insert(&source.temp_c[..]);
                raw.push(&column.raw[..]);
            }
            Ok(ChannelInputs {
                channel,
                temp_c: temp_c.unwrap_or_default(),
                raw,
            })
        })
        .collect()
}

fn run<const AXES: usize>(
    inputs: &ChannelInputs,
    log: &Log,
    applied: &mut Applied,
) -> Result<(), ApplyError> {
    let task = Run::<AXES> {
        inputs,
        log,
        status: &mut applied.status,
    };
    let axes = use_tables([&inputs.channel.table], task)?;
    applied.axes.extend(axes);
    Ok(())
}

/// Running the rows of a channel through the compensator.
struct Run<'a, const AXES: usize> {
    inputs: &'a ChannelInputs<'a>,
    log: &'a Log,
    status: &'a mut [Status],
}

impl<const AXES: usize> TableUse<1, AXES> for Run<'_, AXES> {
    type Output = [AxisOutput; AXES];

    fn with<const PLAYS: usize, const SLOW: usize>(
        self,
        [table]: &[Table<AXES, PLAYS, SLOW>; 1],
    ) -> Self::Output {
        let temps_c = self.inputs.temp_c;
        let mut unit = Compensator::new(table);
        unit.start(temps_c[0]);
        let mut axes: [AxisOutput; AXES] = std::array::from_fn(|_| AxisOutput::default());
        for (row, (dt_s, &temp_c)) in self.log.intervals_s().zip(temps_c).enumerate() {
            let raw = self.inputs.row::<AXES>(row);
            let out = unit.step(&Interval::new(table.thermal(), dt_s), temp_c, raw);
            push_row(&mut axes, &raw, &out);
            self.status[row] |= out.status;
        }
        axes
    }
}

/// Adds a row to each axis.
pub(super) fn push_row<const AXES: usize>(
    axes: &mut [AxisOutput],
    raw: &[f32; AXES],
    out: &Output<AXES>,
) {
    for (axis, output) in axes.iter_mut().enumerate() {
        output.raw.push(raw[axis]);
        output.bias.push(out.bias[axis]);
        output.compensated.push(out.compensated[axis]);
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
