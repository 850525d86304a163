//! Decides which temperatures to believe, by the rules of the f32 core.

use tempco::Status;

use crate::mask::{Mask, abs, min, saturating_sum};
use crate::{FixedInterval, FixedThermal};

/// The last believed temperature and the memory of faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Conditioner {
    /// The temperature gone on with: the last believed one, or once that is lost, the last
    /// reading, which the next one may confirm.
    temp: i32,
    /// Time since a temperature was believed \[ticks\].
    age: i32,
    /// Below zero, the time until the status ceases to say settling \[ticks\].
    settled: i32,
    pub(crate) rejected: u32,
    pub(crate) restarts: u32,
}

/// A temperature to go on with.
pub(crate) struct Conditioned {
    /// The present temperature if it is taken, else the last one that was.
    pub(crate) temp: i32,
    /// How far the part moved since the one before: none of it where there is no new one, or
    /// where it came in a way no rate may be derived from.
    pub(crate) movement: i32,
    /// A change up to this is noise and movement of one interval; negative if no time has passed.
    pub(crate) near: i32,
    /// Nothing was believed for longer than the hold time.
    pub(crate) lost: Mask,
    pub(crate) status: Status,
}

impl Conditioner {
    /// Nothing was ever believed.
    pub(crate) const fn new(reference: i32) -> Self {
        Self {
            temp: reference,
            age: i32::MAX,
            settled: 0,
            rejected: 0,
            restarts: 0,
        }
    }

    /// Believes a first temperature, if the sensor can report it.
    pub(crate) fn start(thermal: &FixedThermal, temp: i32) -> Option<Self> {
        let in_range = temp >= thermal.sensor_min && temp <= thermal.sensor_max;
        in_range.then_some(Self {
            temp,
            age: 0,
            settled: -thermal.settle_ticks,
            rejected: 0,
            restarts: 1,
        })
    }

    /// As `Conditioner::update` of the f32 core, where the rules are explained. A difference from
    /// a temperature beyond the sensor's range may wrap; what follows from it is masked.
    #[inline]
    pub(crate) fn update(
        &mut self,
        thermal: &FixedThermal,
        interval: &FixedInterval,
        temp: i32,
    ) -> Conditioned {
        let healing = saturating_sum(thermal.heal_ticks, self.age).wrapping_neg();
        let was_lost = Mask::less(thermal.hold_ticks, self.age);
        let age = saturating_sum(self.age, interval.ticks);

        let forward = Mask::negative(-interval.forward);
        let near = forward.pick(saturating_sum(thermal.gate, interval.slew), -1);
        // Below 1300 degC, so that the sum below fits.
        let counted = min(age, thermal.anywhere_ticks);
        let reach = (i64::from(counted) * i64::from(thermal.slew_per_tick) + (1 << 19)) >> 20;
        let far = forward.pick(saturating_sum(thermal.gate, reach as i32), -1);

        let below = Mask::less(temp, thermal.sensor_min);
        let above = Mask::less(thermal.sensor_max, temp);
        let impossible = below.or(above);
        let change = temp.wrapping_sub(self.temp);
        let gate = was_lost.pick(near, far);
        let implausible = Mask::less(gate, abs(change));
        let rejected = impossible.or(implausible);

        let outage = Mask::less(thermal.restart_ticks, age);
        let anew = Mask::less(near, abs(change)).or(outage);
        let restart = anew.and(rejected.not());

        self.age = rejected.keep(age);
        let lost = Mask::less(thermal.hold_ticks, self.age);
        let left = impossible.or(implausible.and(lost.not()));
        self.temp = left.pick(self.temp, temp);

        let settled = min(self.settled.wrapping_add(interval.ticks), 0);
        let settled = rejected.pick(min(self.settled, healing), settled);
        self.settled = restart.pick(-thermal.settle_ticks, settled);
        self.rejected = self.rejected.wrapping_add(rejected.count());
        self.restarts = self.restarts.wrapping_add(restart.count());

        let spike = implausible.and(impossible.not()).and(forward);
        Conditioned {
            temp: self.temp,
            movement: left.or(anew).not().keep(change),
            near,
            lost,
            status: interval.status
                | impossible.flags(Status::TEMPERATURE_INVALID)
                | spike.flags(Status::TEMPERATURE_SPIKE)
                | lost.flags(Status::TEMPERATURE_LOST)
                | Mask::negative(self.settled).flags(Status::SETTLING),
        }
    }
}
