//! Decides which temperatures to believe, before anything is differentiated.

use core::hint::select_unpredictable;

use crate::interval::Interval;
use crate::{Status, Thermal};

/// The last believed temperature and the memory of faults.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Conditioner {
    temp_c: f32,
    /// The last temperature within the sensor's range, believed or not \[degC\].
    candidate_c: f32,
    /// Time since `temp_c` was measured \[ticks\].
    age: i32,
    /// Time for which the status still says settling \[ticks\].
    settling: i32,
    pub(crate) rejected: u32,
    pub(crate) restarts: u32,
}

/// A temperature to go on with.
pub(crate) struct Conditioned {
    /// The present temperature if believed, else the last one that was \[degC\].
    pub(crate) temp_c: f32,
    /// The part of the change from the last believed temperature that is no movement of the part
    /// and from which no rate may be derived \[degC\].
    pub(crate) shift_c: f32,
    /// Nothing was believed for longer than the hold time.
    pub(crate) lost: bool,
    pub(crate) status: Status,
}

impl Conditioner {
    pub(crate) const fn new(reference_c: f32) -> Self {
        Self {
            temp_c: reference_c,
            candidate_c: f32::NAN,
            age: i32::MAX,
            settling: 0,
            rejected: 0,
            restarts: 0,
        }
    }

    /// Makes the next temperature, if it is `temp_c`, believed without a second one that agrees.
    pub(crate) fn trust(&mut self, temp_c: f32) {
        self.candidate_c = temp_c;
    }

    /// A temperature is believed if the sensor can report it and the part can have reached it
    /// since the last believed one; once the temperature was lost, if it agrees with the reading
    /// before it. NaN fails every comparison.
    ///
    /// All of it is computed for every sample: `&` and `|` instead of `&&` and `||`, and selections
    /// that the compiler cannot gather into a branch.
    #[inline]
    pub(crate) fn update(
        &mut self,
        thermal: &Thermal,
        interval: &Interval,
        temp_c: f32,
    ) -> Conditioned {
        let settings = &thermal.settings;
        let was_lost = self.age > thermal.hold_ticks;
        let age = self.age.saturating_add(interval.ticks);
        let near_c = settings.spike_gate_c + interval.slew_c;
        let far_c = settings.spike_gate_c + thermal.slew_c_per_tick * age as f32;

        let in_range = (temp_c >= settings.sensor_min_c) & (temp_c <= settings.sensor_max_c);
        let change_c = temp_c - self.temp_c;
        let agrees = (temp_c - self.candidate_c).abs() <= near_c;
        let reachable = change_c.abs() <= far_c;
        let plausible = select_unpredictable(was_lost, agrees, reachable);
        let believed = in_range & plausible & interval.forward;
        let stepped = change_c.abs() > near_c;
        let restart = believed & (stepped | (age > thermal.restart_ticks));

        let healing = self.settling.saturating_add(interval.ticks);
        let healing = healing.max(thermal.heal_ticks);
        let healed = self.settling.saturating_sub(interval.ticks);
        let settling =
            select_unpredictable(believed, healed, healing.min(thermal.longest_heal_ticks));
        self.settling = select_unpredictable(restart, thermal.settle_ticks, settling.max(0));

        self.candidate_c = select_unpredictable(in_range, temp_c, self.candidate_c);
        self.temp_c = select_unpredictable(believed, temp_c, self.temp_c);
        self.age = select_unpredictable(believed, 0, age);
        self.rejected = self.rejected.wrapping_add(u32::from(!believed));
        self.restarts = self.restarts.wrapping_add(u32::from(restart));

        let lost = self.age > thermal.hold_ticks;
        Conditioned {
            temp_c: self.temp_c,
            shift_c: select_unpredictable(restart, change_c, 0.0),
            lost,
            status: interval.status
                | Status::TEMPERATURE_INVALID.when(!in_range)
                | Status::TEMPERATURE_SPIKE.when(in_range & !plausible)
                | Status::TEMPERATURE_LOST.when(lost)
                | Status::SETTLING.when(self.settling > 0),
        }
    }
}
