//! The thermal half: all that depends on temperature, at its slow rate.

use crate::{BiasRamp, Interval, Status, Table, ThermalPoint, ThermalState};

/// Turns each temperature into a ramp of the bias, for units whose gyro is sampled faster than
/// their temperature.
///
/// It runs at 1 to 100 Hz in the main loop, and hands its ramps to the sample half by a
/// [`RampBuffer`](crate::RampBuffer). Each ramp begins where the one before ends. So the slope does not
/// depend on where the sample half is, and there is no step while updates come on schedule.
#[derive(Clone, Debug)]
pub struct ThermalHalf<'t, const AXES: usize> {
    table: &'t Table<'t, AXES>,
    state: ThermalState,
    /// The bias the last ramp ends at.
    end: [f32; AXES],
    samples_per_update: u16,
    updates_per_sample: f32,
    point: ThermalPoint,
}

impl<'t, const AXES: usize> ThermalHalf<'t, AXES> {
    /// A thermal half that has not seen a temperature.
    ///
    /// `samples_per_update` is the number of gyro samples between two thermal updates, 1 to
    /// 65535 (0 counts as 1).
    pub fn new(table: &'t Table<'t, AXES>, samples_per_update: u16) -> Self {
        let samples = samples_per_update.max(1);
        Self {
            table,
            state: ThermalState::new(table.thermal()),
            end: Self::constant(table).end,
            samples_per_update: samples,
            updates_per_sample: 1.0 / f32::from(samples),
            point: constant_point(table),
        }
    }

    /// The constant bias, to be applied before the first temperature.
    pub fn constant(table: &Table<'_, AXES>) -> BiasRamp<AXES> {
        level(table, &constant_point(table))
    }

    /// Starts at the first temperature after power-on \[degC\], without ramping to it. Publish this
    /// ramp, or only that of an update that follows at once.
    pub fn start(&mut self, temp_c: f32) -> BiasRamp<AXES> {
        self.point = self.state.start(self.table.thermal(), temp_c);
        let ramp = level(self.table, &self.point);
        self.end = ramp.end;
        BiasRamp {
            samples: self.samples_per_update,
            ..ramp
        }
    }

    /// Takes a temperature \[degC\], `interval` after the last one: all the thermal work.
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline(always)]
    pub fn update(&mut self, interval: &Interval, temp_c: f32) -> BiasRamp<AXES> {
        let before = self.end;
        self.point = self.state.update(self.table.thermal(), interval, temp_c);
        let (end, status) = self.table.bias(&self.point);
        self.end = end;
        let slope =
            core::array::from_fn(|axis| (end[axis] - before[axis]) * self.updates_per_sample);
        BiasRamp {
            end,
            slope,
            samples: self.samples_per_update,
            status,
        }
    }

    /// Goes on with a copy of the same table. The state and the place on the ramp stay.
    pub const fn move_to(&mut self, table: &'t Table<'t, AXES>) {
        self.table = table;
    }

    /// Where the model was evaluated at the last update; the bias ramps to its value there.
    pub const fn point(&self) -> ThermalPoint {
        self.point
    }

    /// The state of the thermal path, for its counters.
    pub const fn thermal_state(&self) -> &ThermalState {
        &self.state
    }
}

/// A bias that stays. A function of its own, so that the start does not take the code of the bias again.
#[inline(never)]
fn level<const AXES: usize>(table: &Table<'_, AXES>, point: &ThermalPoint) -> BiasRamp<AXES> {
    let (end, status) = table.bias(point);
    BiasRamp {
        end,
        slope: [0.0; AXES],
        samples: 0,
        status,
    }
}

/// Where the model is evaluated before any temperature.
fn constant_point<const AXES: usize>(table: &Table<'_, AXES>) -> ThermalPoint {
    ThermalPoint {
        effective_c: table.thermal().settings().reference_c,
        status: Status::TEMPERATURE_LOST,
        ..ThermalPoint::default()
    }
}
