//! The two-rate pair: thermal work at the temperature's slow rate, a subtraction at the gyro's.

use tempco::Status;

use crate::compensator::{BiasState, subtract};
use crate::mask::{Mask, max};
use crate::{FixedInterval, FixedOutput, FixedPoint, FixedTable, FixedThermalState};

/// Compensates units whose gyro is sampled faster than their temperature, as
/// [`tempco::TwoRateCompensator`] does.
///
/// Between two updates the bias moves in a straight line to its new value, to within one last
/// place, and arrives exactly; a compensation is an addition of 64 bits per axis, without a
/// multiplication.
#[derive(Clone, Debug)]
pub struct FixedTwoRate<
    't,
    const AXES: usize,
    const CELLS: usize,
    const PLAYS: usize = 0,
    const SLOW: usize = 0,
> {
    table: &'t FixedTable<AXES, CELLS, PLAYS, SLOW>,
    state: BiasState<PLAYS, SLOW>,
    /// The bias now, with 32 fractional bits more.
    level: [i64; AXES],
    /// Its change per gyro sample.
    slope: [i64; AXES],
    /// The bias the ramp ends at.
    bias: [i32; AXES],
    /// Gyro samples until the end of the ramp; below zero, since then.
    remaining: i32,
    samples_per_update: i32,
    /// Updates per sample \[2^-48\].
    share: (u32, u32),
    point: FixedPoint,
    status: Status,
}

impl<'t, const AXES: usize, const CELLS: usize, const PLAYS: usize, const SLOW: usize>
    FixedTwoRate<'t, AXES, CELLS, PLAYS, SLOW>
{
    /// A compensator that has not seen a temperature: it applies the constant bias.
    ///
    /// `samples_per_update` is the number of gyro samples between two thermal updates, 1 to
    /// 65535 (0 counts as 1).
    pub fn new(table: &'t FixedTable<AXES, CELLS, PLAYS, SLOW>, samples_per_update: u16) -> Self {
        let samples = if samples_per_update == 0 {
            1
        } else {
            samples_per_update
        };
        let share = (1_u64 << 48) / u64::from(samples);
        let mut unit = Self {
            table,
            state: BiasState::new(table),
            level: [0; AXES],
            slope: [0; AXES],
            bias: [0; AXES],
            remaining: 0,
            samples_per_update: i32::from(samples),
            share: ((share >> 32) as u32, share as u32),
            point: FixedPoint {
                effective: table.thermal().reference,
                rate: 0,
                status: Status::TEMPERATURE_LOST,
            },
            status: Status::OK,
        };
        unit.jump();
        unit
    }

    /// Starts at the first temperature after power-on \[2^-20 degC\], without ramping to it.
    pub fn start(&mut self, temp: i32) {
        self.point = self.state.start(self.table, temp);
        self.jump();
    }

    /// Takes a temperature \[2^-20 degC\], `interval` after the last one: all the thermal work.
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline]
    pub fn update(&mut self, interval: &FixedInterval, temp: i32) -> FixedPoint {
        (self.point, self.bias, self.status) = self.state.update(self.table, interval, temp);
        self.slope = core::array::from_fn(|axis| {
            // Both are within 2^30 of zero.
            let way = i64::from(self.bias[axis] - (self.level[axis] >> 32) as i32);
            let (upper, lower) = self.share;
            ((way * i64::from(upper)) << 16) + ((way * i64::from(lower)) >> 16)
        });
        self.remaining = self.samples_per_update;
        self.point
    }

    /// Takes one gyro sample per axis \[2^exponent\]; see [`FixedCompensator::step`] for samples
    /// that are invalid or do not fit.
    ///
    /// [`FixedCompensator::step`]: crate::FixedCompensator::step
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline]
    pub fn compensate(&mut self, raw: [i32; AXES]) -> FixedOutput<AXES> {
        // Stops where it is overdue for certain, so that it never wraps.
        self.remaining = max(self.remaining - 1, -self.samples_per_update - 1);
        let overdue = Mask::negative(self.remaining + self.samples_per_update);
        let arrived = Mask::negative(self.remaining - 1);
        self.level = core::array::from_fn(|axis| {
            let moved = self.level[axis] + self.slope[axis];
            let upper = arrived.pick(self.bias[axis], (moved >> 32) as i32);
            let lower = arrived.not().keep(moved as i32) as u32;
            (i64::from(upper) << 32) | i64::from(lower)
        });
        let bias = core::array::from_fn(|axis| (self.level[axis] >> 32) as i32);
        let status = self.status | overdue.flags(Status::INTERVAL_INVALID);
        subtract(raw, bias, self.point, status)
    }

    /// The state of the thermal path, for its counters.
    pub const fn thermal_state(&self) -> &FixedThermalState {
        &self.state.thermal
    }

    /// Puts the bias where the point says, without a ramp.
    fn jump(&mut self) {
        (self.bias, self.status) = self.table.bias(&self.point);
        self.level = self.bias.map(|bias| i64::from(bias) << 32);
        self.slope = [0; AXES];
        self.remaining = 0;
    }
}
