//! The two-rate pair: thermal work at the temperature's slow rate, a subtraction at the gyro's.

use crate::compensator::BiasState;
use crate::sign::Sign;
use crate::{Interval, Status, Table, ThermalPoint, ThermalState};

/// Compensates units whose gyro is sampled faster than their temperature.
///
/// Call [`update`](Self::update) at 1 to 100 Hz and [`compensate`](Self::compensate) for every
/// gyro sample. Between two updates the bias moves in a straight line to its new value, so there
/// is no step when an update comes; where an update is late the bias stays, and once it is late by
/// a whole period [`Status::INTERVAL_INVALID`] says so.
#[derive(Clone, Debug)]
pub struct TwoRateCompensator<'t, const AXES: usize, const PLAYS: usize = 0, const SLOW: usize = 0>
{
    table: &'t Table<'t, AXES, PLAYS, SLOW>,
    state: BiasState<PLAYS, SLOW>,
    /// The bias the ramp ends at.
    end: [f32; AXES],
    /// Change of the bias per gyro sample during the ramp.
    slope: [f32; AXES],
    /// Gyro samples until the end of the ramp; below zero, since then.
    remaining: i32,
    samples_per_update: i32,
    updates_per_sample: f32,
    point: ThermalPoint,
    status: Status,
}

impl<'t, const AXES: usize, const PLAYS: usize, const SLOW: usize>
    TwoRateCompensator<'t, AXES, PLAYS, SLOW>
{
    /// A compensator that has not seen a temperature: it applies the constant bias.
    ///
    /// `samples_per_update` is the number of gyro samples between two thermal updates, 1 to
    /// 65535 (0 counts as 1).
    pub fn new(table: &'t Table<'t, AXES, PLAYS, SLOW>, samples_per_update: u16) -> Self {
        let samples = samples_per_update.max(1);
        let point = ThermalPoint {
            effective_c: table.thermal().settings().reference_c,
            rate_c_per_min: 0.0,
            status: Status::TEMPERATURE_LOST,
        };
        let (end, status) = table.bias(&point);
        Self {
            table,
            state: BiasState::new(table),
            end,
            slope: [0.0; AXES],
            remaining: 0,
            samples_per_update: samples.into(),
            updates_per_sample: 1.0 / f32::from(samples),
            point,
            status,
        }
    }

    /// Starts at the first temperature after power-on \[degC\], without ramping to it.
    pub fn start(&mut self, temp_c: f32) {
        self.point = self.state.start(self.table, temp_c);
        (self.end, self.status) = self.table.bias(&self.point);
        self.remaining = 0;
    }

    /// Takes a temperature \[degC\], `interval` after the last one: all the thermal work.
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline(always)]
    pub fn update(&mut self, interval: &Interval, temp_c: f32) -> ThermalPoint {
        let now = self.bias();
        (self.point, self.end, self.status) = self.state.update(self.table, interval, temp_c);
        self.slope =
            core::array::from_fn(|axis| (self.end[axis] - now[axis]) * self.updates_per_sample);
        self.remaining = self.samples_per_update;
        self.point
    }

    /// Takes one gyro sample per axis and returns it without its bias. What led to it is to be had
    /// from [`bias`](Self::bias), [`point`](Self::point) and [`status`](Self::status).
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline(always)]
    pub fn compensate(&mut self, raw: [f32; AXES]) -> [f32; AXES] {
        self.remaining = self.remaining.saturating_sub(1);
        let bias = self.bias();
        core::array::from_fn(|axis| raw[axis] - bias[axis])
    }

    /// The bias taken out of the last gyro sample; always finite \[unit of each axis\].
    #[inline(always)]
    pub fn bias(&self) -> [f32; AXES] {
        let remaining = (!Sign(self.remaining)).keep(self.remaining) as f32;
        core::array::from_fn(|axis| self.end[axis] - self.slope[axis] * remaining)
    }

    /// Where the model was evaluated at the last update; the bias ramps to its value there.
    pub const fn point(&self) -> ThermalPoint {
        self.point
    }

    /// Flags of the temperature, the range and late updates. Gyro samples are checked apart, by
    /// [`Status::of_raw`].
    #[inline(always)]
    pub fn status(&self) -> Status {
        let overdue = self.remaining < self.samples_per_update.wrapping_neg();
        self.status | Status::INTERVAL_INVALID.when(overdue)
    }

    /// The state of the thermal path, for its counters.
    pub const fn thermal_state(&self) -> &ThermalState {
        &self.state.thermal
    }
}
