//! The compensators of a set in the course of a log.

use tempco::{Compensator, Status, Table, TableError, Thermal, ThermalPoint, ThermalState};

use super::columns::ChannelInputs;
use super::thermal_path::{IntervalCache, with_every_rate};
use crate::{CoefficientSet, TableData, TableUse, use_tables};

/// Consecutive rows of a log after compensation.
#[derive(Clone, Debug, Default)]
pub struct Applied {
    /// For each row, the flags of all channels together.
    pub status: Vec<Status>,
    /// For each channel of the set, where the model stands in each row, with the rate before it is
    /// limited to the calibrated range.
    pub points: Vec<Vec<ThermalPoint>>,
    /// The axes of all channels in the order of the set.
    pub axes: Vec<AxisOutput>,
}

/// Names of the columns of a compensated log, without time and status: the temperatures, then raw, bias
/// and compensated of each axis.
pub fn column_names(set: &CoefficientSet) -> Vec<String> {
    let temperatures = set.channels.iter().map(|of| of.temperature.clone());
    let axes = set.axes().flat_map(|(_, axis)| {
        ["raw", "bias", "compensated"]
            .map(|what| format!("{}_{what}_{}", axis.name, axis.unit.name()))
    });
    temperatures.chain(axes).collect()
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

/// Consecutive rows of a log as a set takes them.
pub(super) struct Rows<'a> {
    /// Time since the last update \[s\], where a row is one.
    pub(super) updates_s: &'a [Option<f32>],
    /// For each channel of the set.
    pub(super) channels: Vec<ChannelInputs<'a>>,
}

/// Passes a function to `feed` that runs the next rows of one log through the core.
pub(super) fn with_compensators<R>(
    set: &CoefficientSet,
    feed: impl FnOnce(&mut Step) -> R,
) -> Result<R, TableError> {
    let tables: Vec<&TableData> = set.channels.iter().map(|channel| &channel.table).collect();
    let (mut feed, mut result) = (Some(feed), None);
    let mut once = |step: &mut Step| {
        result = feed.take().map(|feed| feed(step));
    };
    use_tables(&tables, Run(&mut once))??;
    Ok(result.expect("`Run` feeds once"))
}

/// Runs rows through the core.
pub(super) type Step<'s> = dyn FnMut(&Rows) -> Applied + 's;

/// Without the type of what is fed, so that the compiler makes each shape of tables once.
struct Run<'f>(&'f mut dyn FnMut(&mut Step));

impl TableUse for Run<'_> {
    type Output = Result<(), TableError>;

    fn with<const CHANNELS: usize, const AXES: usize>(
        self,
        tables: &[Table<AXES>; CHANNELS],
    ) -> Self::Output {
        let units: Result<Vec<_>, _> = tables.iter().map(Unit::new).collect();
        let mut units = units?;
        (self.0)(&mut |rows| {
            let mut applied = Applied {
                status: vec![Status::OK; rows.updates_s.len()],
                ..Applied::default()
            };
            for (unit, inputs) in units.iter_mut().zip(&rows.channels) {
                unit.step(inputs, rows.updates_s, &mut applied);
            }
            applied
        });
        Ok(())
    }
}

/// A channel in the course of a log.
struct Unit<'t, const AXES: usize> {
    core: Compensator<'t, AXES>,
    table: &'t Table<'t, AXES>,
    /// The thermal path without limits of the rate.
    open: Thermal,
    state: ThermalState,
    intervals: IntervalCache,
    /// The last update; none before the first row.
    last: Option<Update<AXES>>,
}

/// What an update leaves to the rows up to the next one.
#[derive(Clone, Copy)]
struct Update<const AXES: usize> {
    bias: [f32; AXES],
    status: Status,
    point: ThermalPoint,
}

impl<'t, const AXES: usize> Unit<'t, AXES> {
    fn new(table: &'t Table<'t, AXES>) -> Result<Self, TableError> {
        let open = with_every_rate(*table.thermal().settings())?;
        Ok(Self {
            core: Compensator::new(table),
            table,
            state: ThermalState::new(&open),
            intervals: IntervalCache::new(table.thermal(), 0.0),
            open,
            last: None,
        })
    }

    /// Runs the next rows through the core and adds the channel to the others.
    fn step(&mut self, inputs: &ChannelInputs, updates_s: &[Option<f32>], applied: &mut Applied) {
        let temps_c = inputs.temp_c;
        let mut points = Vec::with_capacity(temps_c.len());
        let mut axes: [AxisOutput; AXES] = std::array::from_fn(|_| AxisOutput::default());
        for (row, (&temp_c, &update_s)) in temps_c.iter().zip(updates_s).enumerate() {
            let raw = inputs.row::<AXES>(row);
            let Update {
                bias,
                status,
                point,
            } = self.update(temp_c, update_s);
            points.push(point);
            applied.status[row] |= status | Status::of_raw(&raw);
            for (axis, output) in axes.iter_mut().enumerate() {
                output.raw.push(raw[axis]);
                output.bias.push(bias[axis]);
                output.compensated.push(raw[axis] - bias[axis]);
            }
        }
        applied.points.push(points);
        applied.axes.extend(axes);
    }

    /// Takes the temperature of a row if that is an update.
    fn update(&mut self, temp_c: f32, update_s: Option<f32>) -> Update<AXES> {
        let dt_s = match (update_s, self.last) {
            (None, Some(last)) => return last,
            (dt_s, _) => dt_s.unwrap_or(0.0),
        };
        if self.last.is_none() {
            self.core.start(temp_c);
            self.state.start(&self.open, temp_c);
        }
        let interval = self.intervals.of(self.table.thermal(), dt_s);
        let out = self.core.step(&interval, temp_c, [0.0; AXES]);
        *self.last.insert(Update {
            bias: out.bias,
            status: out.status,
            point: self.state.update(&self.open, &interval, temp_c),
        })
    }
}
