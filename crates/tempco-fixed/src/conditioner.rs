//! Decides which temperatures to believe, by the rules of the f32 core.

use tempco::Status;

use crate::mask::{Mask, abs, max, min, saturating_sum};
use crate::{FixedInterval, FixedThermal};

/// The last believed temperature and the memory of faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Conditioner {
    temp: i32,
    /// The last temperature within the sensor's range, believed or not.
    candidate: i32,
    has_candidate: Mask,
    /// Time since `temp` was measured \[ticks\].
    age: i32,
    /// Time for which the status still says settling \[ticks\].
    settling: i32,
    pub(crate) rejected: u32,
    pub(crate) restarts: u32,
}

/// A temperature to go on with.
pub(crate) struct Conditioned {
    /// The present temperature if believed, else the last one that was.
    pub(crate) temp: i32,
    /// How far the part moved since the last believed temperature: none of it where there is no
    /// new one, or where it came in a way no rate may be derived from.
    pub(crate) movement: i32,
    /// Nothing was believed for longer than the hold time.
    pub(crate) lost: Mask,
    pub(crate) status: Status,
}

impl Conditioner {
    pub(crate) const fn new(reference: i32) -> Self {
        Self {
            temp: reference,
            candidate: reference,
            has_candidate: Mask::NO,
            age: i32::MAX,
            settling: 0,
            rejected: 0,
            restarts: 0,
        }
    }

    /// Makes the next temperature, if it is `temp`, believed without a second one that agrees.
    /// Nothing agrees with one beyond 1024 degC, no more than with NaN.
    pub(crate) const fn trust(&mut self, temp: i32) {
        const FURTHEST: i32 = 1 << 30;
        self.candidate = temp;
        self.has_candidate = Mask::less(temp, FURTHEST).and(Mask::less(-FURTHEST, temp));
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
        let was_lost = Mask::less(thermal.hold_ticks, self.age);
        let age = saturating_sum(self.age, interval.ticks);
        let near = saturating_sum(thermal.gate, interval.slew);
        // Below 1300 degC, so that the sum below fits.
        let counted = min(age, thermal.anywhere_ticks);
        let reach = (i64::from(counted) * i64::from(thermal.slew_per_tick) + (1 << 19)) >> 20;
        let far = saturating_sum(thermal.gate, reach as i32);

        let below = Mask::less(temp, thermal.sensor_min);
        let above = Mask::less(thermal.sensor_max, temp);
        let in_range = below.or(above).not();
        let change = temp.wrapping_sub(self.temp);
        let from_candidate = temp.wrapping_sub(self.candidate);
        let agrees = Mask::less(near, abs(from_candidate))
            .not()
            .and(self.has_candidate);
        let reachable = Mask::less(far, abs(change)).not();
        let plausible = was_lost.choose(agrees, reachable);
        let forward = Mask::negative(-interval.forward);
        let believed = in_range.and(plausible).and(forward);
        let stepped = Mask::less(near, abs(change));
        let outage = Mask::less(thermal.restart_ticks, age);
        let restart = believed.and(stepped.or(outage));

        let healing = saturating_sum(self.settling, interval.ticks);
        let healing = min(max(healing, thermal.heal_ticks), thermal.longest_heal_ticks);
        let healed = max(self.settling.wrapping_sub(interval.ticks), 0);
        let settling = believed.pick(healed, healing);
        self.settling = restart.pick(thermal.settle_ticks, settling);

        self.candidate = in_range.pick(temp, self.candidate);
        self.has_candidate = self.has_candidate.or(in_range);
        self.temp = believed.pick(temp, self.temp);
        self.age = believed.not().keep(age);
        self.rejected = self.rejected.wrapping_add(believed.not().count());
        self.restarts = self.restarts.wrapping_add(restart.count());

        let lost = Mask::less(thermal.hold_ticks, self.age);
        Conditioned {
            temp: self.temp,
            movement: believed.and(restart.not()).keep(change),
            lost,
            status: interval.status
                | in_range.not().flags(Status::TEMPERATURE_INVALID)
                | in_range
                    .and(plausible.not())
                    .flags(Status::TEMPERATURE_SPIKE)
                | lost.flags(Status::TEMPERATURE_LOST)
                | Mask::negative(-self.settling).flags(Status::SETTLING),
        }
    }
}
