//! The thermal path shared by all axes of a unit.

use tempco::Status;

use crate::conditioner::Conditioner;
use crate::estimator::RateEstimator;
use crate::mask::{Mask, abs, limit_wide};
use crate::{FixedInterval, FixedThermal, INVALID};

/// Where in the space of temperatures and rates the bias model is to be evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FixedPoint {
    /// Effective temperature `u` \[2^-20 degC\], limited to 1024 degC either way.
    pub effective: i32,
    /// Rate of temperature, clamped to the calibrated range \[2^-20 degC/min\].
    pub rate: i32,
    /// Remarks on the temperature.
    pub status: Status,
}

/// The state of the thermal path: conditioner, estimator, effective temperature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FixedThermalState {
    conditioner: Conditioner,
    estimator: RateEstimator,
    effective: i32,
}

/// With both ends of a way within this, their difference fits an i32.
const FURTHEST: i32 = (1 << 30) - 1;

impl FixedThermalState {
    /// The state before any temperature was seen: lost, at the reference temperature.
    pub const fn new(thermal: &FixedThermal) -> Self {
        Self {
            conditioner: Conditioner::new(thermal.reference),
            estimator: RateEstimator::new(thermal),
            effective: thermal.reference,
        }
    }

    /// Starts at the first temperature after power-on \[2^-20 degC\], as
    /// [`tempco::ThermalState::start`] does.
    pub fn start(&mut self, thermal: &FixedThermal, temp: i32) -> FixedPoint {
        *self = Self::new(thermal);
        let Some(conditioner) = Conditioner::start(thermal, temp) else {
            // Counted as rejected; that no time has passed is no remark at power-on.
            let point = self.update(thermal, &FixedInterval::none(thermal), INVALID);
            return FixedPoint {
                status: Status::TEMPERATURE_INVALID | Status::TEMPERATURE_LOST | Status::SETTLING,
                ..point
            };
        };
        self.conditioner = conditioner;
        self.effective = temp;
        FixedPoint {
            effective: temp,
            rate: 0,
            status: Status::SETTLING,
        }
    }

    /// Takes one temperature \[2^-20 degC\], `interval` after the one before;
    /// [`INVALID`](crate::INVALID) where there is none.
    ///
    /// The effective temperature moves by no more than the maximum slew, whatever is passed in.
    /// Where the temperature is held, the rate decays with the time constant of the estimator.
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline]
    pub fn update(
        &mut self,
        thermal: &FixedThermal,
        interval: &FixedInterval,
        temp: i32,
    ) -> FixedPoint {
        let conditioned = self.conditioner.update(thermal, interval, temp);
        let rate = self
            .estimator
            .update(thermal, interval, conditioned.movement);
        // At most 2^41, so no difference below overflows.
        let rate = (rate + (1 << 20)) >> 21;

        let too_slow = Mask::negative_wide(rate - i64::from(thermal.rate_min));
        let too_fast = Mask::negative_wide(i64::from(thermal.rate_max) - rate);
        let rate = too_slow.pick(thermal.rate_min, rate as i32);
        let rate = too_fast.pick(thermal.rate_max, rate);

        let shift = (i64::from(thermal.shift) * i64::from(rate) + (1 << 22)) >> 23;
        let measured = limit_wide(i64::from(conditioned.temp) - shift, FURTHEST);
        let target = conditioned.lost.pick(thermal.reference, measured);
        let way = target - self.effective;
        let back = Mask::less(way, -interval.slew);
        let forth = Mask::less(interval.slew, way);
        let step = back.pick(-interval.slew, way);
        let step = forth.pick(interval.slew, step);
        self.effective += step;
        let ramping = Mask::less(conditioned.near, abs(way));

        FixedPoint {
            effective: self.effective,
            rate,
            status: conditioned.status
                | ramping.flags(Status::SETTLING)
                | too_slow.or(too_fast).flags(Status::RATE_CLAMPED),
        }
    }

    /// Where the effective temperature is \[2^-20 degC\].
    pub(crate) const fn effective(&self) -> i32 {
        self.effective
    }

    /// Temperatures rejected since the start (wraps at 2^32).
    pub const fn rejected(&self) -> u32 {
        self.conditioner.rejected
    }

    /// Restarts of the estimator since the start, the first one included (wraps at 2^32).
    pub const fn restarts(&self) -> u32 {
        self.conditioner.restarts
    }
}
