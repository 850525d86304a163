//! Decides which temperatures to accept, before anything is differentiated.

use crate::Thermal;
use crate::interval::Interval;
use crate::sign::{Sign, magnitude};

/// The last accepted temperature and the memory of faults.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(C, align(8))]
pub(crate) struct Conditioner {
    /// Time since a temperature was accepted \[ticks\].
    age: i32,
    /// Time since the status ceased to say settling; negative, until it will \[ticks\].
    settled: i32,
    pub(crate) rejected: u32,
    pub(crate) restarts: u32,
    /// The temperature gone on with: the last accepted one, or once that is lost, the last
    /// reading, which the next one may confirm \[degC\].
    temp_c: f32,
}

/// A temperature to go on with.
pub(crate) struct Conditioned {
    /// The present temperature if it is taken, else the last one that was \[degC\].
    pub(crate) temp_c: f32,
    /// The change from the one before \[degC\].
    pub(crate) change_c: f32,
    /// The change is a movement of the part, from which a rate may be derived, or there is none.
    pub(crate) moved: Sign,
    /// Nothing was accepted for longer than the hold time.
    pub(crate) lost: Sign,
    pub(crate) settling: Sign,
    pub(crate) impossible: Sign,
    pub(crate) spike: Sign,
}

impl Conditioner {
    /// Nothing was ever accepted.
    pub(crate) const fn new(reference_c: f32) -> Self {
        Self {
            age: i32::MAX,
            settled: 0,
            rejected: 0,
            restarts: 0,
            temp_c: reference_c,
        }
    }

    /// Accepts a first temperature, if the sensor can report it.
    pub(crate) fn start(thermal: &Thermal, temp_c: f32) -> Option<Self> {
        let in_range = Self::beyond_sensor(thermal, temp_c).0 >= 0;
        in_range.then_some(Self {
            age: 0,
            settled: thermal.settling,
            rejected: 0,
            restarts: 1,
            temp_c,
        })
    }

    /// A temperature is accepted if the sensor can report it and the part can have reached it
    /// since the last accepted one; once the temperature was lost, if it agrees with the reading
    /// before it.
    ///
    /// All of it is computed for every sample.
    #[inline(always)]
    pub(crate) fn update(
        &mut self,
        thermal: &Thermal,
        interval: &Interval,
        temp_c: f32,
    ) -> Conditioned {
        let healing = thermal.healing.saturating_sub(self.age);
        let was_lost = Sign::above(self.age, thermal.hold_ticks);
        let age = self.age.saturating_add(interval.ticks);

        let impossible = Self::beyond_sensor(thermal, temp_c);
        let change_c = temp_c - self.temp_c;
        let change = magnitude(change_c);
        let far_c = interval.gate_c + thermal.slew_c_per_tick * age as f32;
        let gate = was_lost.select(interval.near, far_c.to_bits() as i32);
        let implausible = Sign::above(change, gate);
        let rejected = impossible | implausible;

        let fresh = Sign::above(change, interval.near) | Sign::above(age, thermal.restart_ticks);
        let restart = fresh & !rejected;

        self.age = rejected.keep(age);
        let lost = Sign::above(self.age, thermal.hold_ticks);
        let left = impossible | (implausible & !lost);
        self.temp_c = left.select(self.temp_c, temp_c);

        let settled = self.settled.saturating_add(interval.ticks);
        let settled = rejected.select(self.settled.min(healing), settled);
        self.settled = restart.select(thermal.settling, settled);
        self.rejected = self.rejected.wrapping_add(rejected.count());
        self.restarts = self.restarts.wrapping_add(restart.count());

        Conditioned {
            temp_c: self.temp_c,
            change_c,
            moved: left | !fresh,
            lost,
            settling: Sign(self.settled),
            impossible,
            spike: implausible & !impossible & !Sign(interval.near),
        }
    }

    #[inline(always)]
    fn beyond_sensor(thermal: &Thermal, temp_c: f32) -> Sign {
        Sign::above(
            magnitude(temp_c - thermal.sensor_middle_c),
            thermal.sensor_reach,
        )
    }
}
