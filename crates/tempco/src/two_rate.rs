//! The two-rate pair: thermal work at the temperature's slow rate, a subtraction at the gyro's.

use core::hint::select_unpredictable;

use crate::compensator::subtract;
use crate::{Interval, Output, Status, Table, ThermalPoint, ThermalState};

/// Compensates units whose gyro is sampled faster than their temperature.
///
/// Call [`update`](Self::update) at 1 to 100 Hz and [`compensate`](Self::compensate) for every
/// gyro sample. Between two updates the bias moves in a straight line to its new value, so there
/// is no step when an update comes; where an update is late the bias stays, and once it is late by
/// a whole period [`Status::INTERVAL_INVALID`] says so.
#[derive(Clone, Debug)]
pub struct TwoRateCompensator<'t, const AXES: usize> {
    table: &'t Table<'t, AXES>,
    state: ThermalState,
    /// The bias the ramp ends at.
    bias: [f32; AXES],
    /// Change of the bias per gyro sample during the ramp.
    slope: [f32; AXES],
    /// Gyro samples until the end of the ramp; below zero, since then.
    remaining: f32,
    samples_per_update: f32,
    updates_per_sample: f32,
    point: ThermalPoint,
    status: Status,
}

impl<'t, const AXES: usize> TwoRateCompensator<'t, AXES> {
    /// A compensator that has not seen a temperature: it applies the constant bias.
    ///
    /// `samples_per_update` is the number of gyro samples between two thermal updates, 1 to
    /// 65535 (0 counts as 1).
    pub fn new(table: &'t Table<'t, AXES>, samples_per_update: u16) -> Self {
        let samples = f32::from(if samples_per_update == 0 {
            1
        } else {
            samples_per_update
        });
        let point = ThermalPoint {
            effective_c: table.thermal().settings().reference_c,
            rate_c_per_min: 0.0,
            status: Status::TEMPERATURE_LOST,
        };
        let (bias, status) = table.bias(&point);
        Self {
            table,
            state: ThermalState::new(table.thermal()),
            bias,
            slope: [0.0; AXES],
            remaining: 0.0,
            samples_per_update: samples,
            updates_per_sample: 1.0 / samples,
            point,
            status,
        }
    }

    /// Starts at the first temperature after power-on \[degC\], without ramping to it.
    pub fn start(&mut self, temp_c: f32) {
        self.point = self.state.start(self.table.thermal(), temp_c);
        (self.bias, self.status) = self.table.bias(&self.point);
        self.remaining = 0.0;
    }

    /// Takes a temperature \[degC\], `interval` after the last one: all the thermal work.
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline]
    pub fn update(&mut self, interval: &Interval, temp_c: f32) -> ThermalPoint {
        let now = self.present_bias();
        self.point = self.state.update(self.table.thermal(), interval, temp_c);
        (self.bias, self.status) = self.table.bias(&self.point);
        self.slope =
            core::array::from_fn(|axis| (self.bias[axis] - now[axis]) * self.updates_per_sample);
        self.remaining = self.samples_per_update;
        self.point
    }

    /// Takes one gyro sample per axis.
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline]
    pub fn compensate(&mut self, raw: [f32; AXES]) -> Output<AXES> {
        self.remaining -= 1.0;
        let overdue = self.remaining < -self.samples_per_update;
        let status = self.status | Status::INTERVAL_INVALID.when(overdue);
        subtract(raw, self.present_bias(), self.point, status)
    }

    /// The state of the thermal path, for its counters.
    pub const fn thermal_state(&self) -> &ThermalState {
        &self.state
    }

    #[inline]
    fn present_bias(&self) -> [f32; AXES] {
        let remaining = select_unpredictable(self.remaining > 0.0, self.remaining, 0.0);
        core::array::from_fn(|axis| self.bias[axis] - self.slope[axis] * remaining)
    }
}
