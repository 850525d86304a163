//! A log that is read once more, row by row through the core, in memory of a fixed size.
//!
//! The core starts and steps as in [`apply`](super::apply()). The interval of the log must be
//! known, from the first reading: the first row takes it, and pulse counts are divided by it.

use std::path::{Path, PathBuf};

use tempco::{Compensator, Interval, Status, Table, TableError, ThermalPoint, ThermalState};
use tempco_log::{Chunk, LogError, LogStream, ReadOptions};
use thiserror::Error;

use super::apply::{ApplyError, AxisOutput, push_row};
use super::core_run::with_every_rate;
use crate::{ChannelSet, CoefficientSet, TableUse, use_tables};

/// A log and what is known of it from the first reading.
#[derive(Clone, Debug)]
pub struct Reread {
    /// The file.
    pub path: PathBuf,
    /// Median time between rows \[s\].
    pub interval_s: f64,
    /// SHA-256 of the file's bytes, in hexadecimal.
    pub sha256: String,
}

/// Consecutive rows of a log and what the core made of them.
#[derive(Clone, Debug, Default)]
pub struct Answers {
    /// Time of each row \[s\].
    pub time_s: Vec<f64>,
    /// For each row, the flags of all channels together.
    pub status: Vec<Status>,
    /// The channels in the order of the set.
    pub channels: Vec<ChannelAnswers>,
}

/// The part of one temperature channel.
#[derive(Clone, Debug, Default)]
pub struct ChannelAnswers {
    /// Where the model stands, with the rate before it is limited to the calibrated range.
    pub points: Vec<ThermalPoint>,
    /// The axes in the order of the set.
    pub axes: Vec<AxisOutput>,
}

/// Runs `set` over a log as a unit switched on at its first row; `sink` gets the rows and the
/// number of bytes of the file that were read so far.
///
/// # Errors
/// A log that cannot be read, lacks an axis of the set, or is not the one of the first reading.
pub fn rerun(
    set: &CoefficientSet,
    log: &Reread,
    options: &ReadOptions,
    mut sink: impl FnMut(&Answers, u64),
) -> Result<(), RerunError> {
    let mut stream = LogStream::open(&log.path, options)?;
    let inputs = columns(set, log, &stream, options)?;
    let task = Rerun {
        inputs: &inputs,
        interval_s: log.interval_s,
        stream: &mut stream,
        sink: &mut sink,
    };
    macro_rules! run_for {
        ($($channels:literal of $axes:literal),+) => {
            match (set.channels.len(), set.channels[0].axes.len()) {
                $(($channels, $axes) => {
                    let tables = std::array::from_fn(|channel| &set.channels[channel].table);
                    use_tables::<$channels, $axes, _>(tables, task)??;
                })+
                _ => unreachable!("a set has 1 to 6 axes in channels of equally many"),
            }
        };
    }
    run_for!(1 of 1, 1 of 2, 1 of 3, 1 of 4, 1 of 5, 1 of 6, 2 of 1, 2 of 2, 2 of 3, 3 of 1, 3 of 2, 4 of 1, 5 of 1, 6 of 1);
    match stream.sha256() {
        Some(found) if found == log.sha256 => Ok(()),
        _ => Err(RerunError::Changed(log.path.clone())),
    }
}

/// Where the values of a channel stand in a chunk.
struct Columns {
    temp: usize,
    /// For each axis, its column and the factor to the unit of the set.
    axes: Vec<(usize, f64)>,
}

fn columns(
    set: &CoefficientSet,
    log: &Reread,
    stream: &LogStream,
    options: &ReadOptions,
) -> Result<Vec<Columns>, ApplyError> {
    // (channel, axis among all, column) of everything in the log.
    let candidates = || {
        let channels = stream.channels().iter().enumerate();
        let axes = channels.flat_map(|(channel, columns)| {
            columns.axes.iter().map(move |(_, axis)| (channel, axis))
        });
        axes.enumerate()
    };
    let file = || log.path.display().to_string();
    let of_channel = |channel: &ChannelSet| {
        let mut temp = 0;
        let mut axes = Vec::new();
        for axis in &channel.axes {
            let found = candidates().find(|(_, (_, column))| column.name == axis.name);
            let (number, (from, column)) = found.ok_or_else(|| ApplyError::NoAxis {
                file: file(),
                axis: axis.name.clone(),
                serial: set.serial.clone(),
            })?;
            let (factor, unit) = column
                .unit
                .in_axis_unit(log.interval_s, options.scale_factor_arcsec);
            if unit != axis.unit {
                return Err(ApplyError::Unit {
                    file: file(),
                    axis: axis.name.clone(),
                    found: unit.name(),
                    expected: axis.unit.name(),
                });
            }
            temp = from;
            axes.push((number, factor));
        }
        Ok(Columns { temp, axes })
    };
    set.channels.iter().map(of_channel).collect()
}

/// Reading the log and running its rows through a compensator for each channel.
struct Rerun<'a, S> {
    inputs: &'a [Columns],
    interval_s: f64,
    stream: &'a mut LogStream,
    sink: &'a mut S,
}

impl<const CHANNELS: usize, const AXES: usize, S: FnMut(&Answers, u64)> TableUse<CHANNELS, AXES>
    for Rerun<'_, S>
{
    type Output = Result<(), RerunError>;

    fn with<const PLAYS: usize, const SLOW: usize>(
        self,
        tables: &[Table<AXES, PLAYS, SLOW>; CHANNELS],
    ) -> Self::Output {
        let mut units = tables
            .iter()
            .map(Unit::new)
            .collect::<Result<Vec<_>, _>>()?;
        let mut last_s = None;
        let mut answers = Answers::default();
        while let Some(chunk) = self.stream.next_chunk()? {
            let since_last_s = |time_s: f64| {
                let last_s = last_s.replace(time_s);
                last_s.map_or(self.interval_s, |last_s| time_s - last_s) as f32
            };
            let intervals_s: Vec<f32> = chunk.time_s.iter().copied().map(since_last_s).collect();
            answers.time_s.clone_from(&chunk.time_s);
            answers.status = vec![Status::OK; chunk.rows()];
            let status = &mut answers.status;
            answers.channels = units
                .iter_mut()
                .zip(self.inputs)
                .map(|(unit, columns)| unit.answer(columns, &chunk, &intervals_s, status))
                .collect();
            (self.sink)(&answers, self.stream.bytes_read());
        }
        Ok(())
    }
}

/// A channel in the course of a log.
struct Unit<'t, const AXES: usize, const PLAYS: usize, const SLOW: usize> {
    core: Compensator<'t, AXES, PLAYS, SLOW>,
    table: &'t Table<'t, AXES, PLAYS, SLOW>,
    /// The thermal path without limits of the rate.
    open: tempco::Thermal,
    state: ThermalState,
    started: bool,
}

impl<'t, const AXES: usize, const PLAYS: usize, const SLOW: usize> Unit<'t, AXES, PLAYS, SLOW> {
    fn new(table: &'t Table<'t, AXES, PLAYS, SLOW>) -> Result<Self, TableError> {
        let open = with_every_rate(*table.thermal().settings())?;
        Ok(Self {
            core: Compensator::new(table),
            table,
            state: ThermalState::new(&open),
            open,
            started: false,
        })
    }

    fn answer(
        &mut self,
        columns: &Columns,
        chunk: &Chunk,
        intervals_s: &[f32],
        status: &mut [Status],
    ) -> ChannelAnswers {
        let temps_c = &chunk.temps_c[columns.temp];
        if let (false, Some(&first)) = (self.started, temps_c.first()) {
            self.core.start(first);
            self.state.start(&self.open, first);
            self.started = true;
        }
        let mut points = Vec::with_capacity(chunk.rows());
        let mut axes = vec![AxisOutput::default(); AXES];
        for (row, (&temp_c, &dt_s)) in temps_c.iter().zip(intervals_s).enumerate() {
            let raw: [f32; AXES] = std::array::from_fn(|axis| {
                let (column, factor) = columns.axes[axis];
                (chunk.axes[column][row] * factor) as f32
            });
            let interval = Interval::new(self.table.thermal(), dt_s);
            let out = self.core.step(&interval, temp_c, raw);
            points.push(self.state.update(&self.open, &interval, temp_c));
            status[row] |= out.status;
            push_row(&mut axes, &raw, &out);
        }
        ChannelAnswers { points, axes }
    }
}

/// A log cannot be run through the core again.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RerunError {
    /// The log cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// It does not have what the set compensates.
    #[error(transparent)]
    Apply(#[from] ApplyError),
    /// The core refuses the table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The file is not the one that was read before.
    #[error("{}: changed while it was in use: expected the bytes of the first reading", .0.display())]
    Changed(PathBuf),
}

/// Whether a file can be read a second time: not a pipe or a terminal.
pub fn is_rereadable(path: &Path) -> bool {
    path.metadata().is_ok_and(|metadata| metadata.is_file())
}
