//! Decides which temperatures to accept, before anything is differentiated.

use crate::Thermal;
use crate::interval::Interval;
use crate::sign::{Sign, limit, magnitude};

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
    /// What the gate is about: it follows the accepted temperatures no faster than the part can,
    /// so that many small jumps are not accepted either \[degC\].
    anchor_c: f32,
    /// Since a temperature was accepted, the sensor has reported one that the part cannot have
    /// reached, and none since that it can have reached after a loss.
    is_jumping: Sign,
    /// Since the start, a temperature away from the anchor was accepted after such a one.
    has_jumped: Sign,
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
    /// The temperature is lost, or has returned in this update after as long.
    pub(crate) unseen: Sign,
    /// It is the first one of all, or the first one after more time than can be counted.
    pub(crate) first: Sign,
    pub(crate) settling: Sign,
    pub(crate) impossible: Sign,
    pub(crate) spike: Sign,
    pub(crate) jumped: Sign,
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
            anchor_c: reference_c,
            is_jumping: Sign::NO,
            has_jumped: Sign::NO,
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
            anchor_c: temp_c,
            is_jumping: Sign::NO,
            has_jumped: Sign::NO,
        })
    }

    /// A temperature is accepted if the sensor can report it and the part can have reached it,
    /// from the last accepted one and from the anchor; once the temperature was lost, if it agrees
    /// with the reading before it.
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
        // Only the longest time wraps.
        let is_first = Sign(self.age.wrapping_add(1));
        let age = self.age.saturating_add(interval.ticks);

        // Can the sensor report it, and can the part have reached it?
        let impossible = Self::beyond_sensor(thermal, temp_c);
        let change_c = temp_c - self.temp_c;
        let change = magnitude(change_c);
        let way_c = temp_c - self.anchor_c;
        let way = magnitude(way_c);
        let reach_c = thermal.slew_c_per_tick * age as f32;
        let gate = (interval.gate_c + reach_c).to_bits() as i32;
        let beyond = Sign::above(way, gate);
        let unconfirmed = Sign::above(change, interval.near);
        let far = beyond | Sign::above(change, gate);
        let implausible = was_lost.select(unconfirmed, far);
        let rejected = impossible | implausible;

        let fresh = unconfirmed | Sign::above(age, thermal.restart_ticks);
        let restart = fresh & !rejected;
        let unseen = Sign::above(age, thermal.hold_ticks);

        self.age = rejected.keep(age);
        let lost = Sign::above(self.age, thermal.hold_ticks);
        let left = impossible | (implausible & !lost);
        self.temp_c = left.select(self.temp_c, temp_c);

        // A reading that stays where the part cannot have gone is accepted in the end, for it may
        // be right; but not without a flag. Where none was accepted yet, none is a jump.
        let takes_no_time = Sign(interval.near);
        let usable = !impossible & !takes_no_time;
        let jumping = self.is_jumping | (beyond & usable & !is_first);
        let jumped = jumping & Sign::above(way, interval.near) & !rejected;
        self.has_jumped = self.has_jumped | jumped;
        let is_back = was_lost & usable & !beyond;
        self.is_jumping = jumping & rejected & !is_back;
        let reach = (reach_c.to_bits() as i32).max(interval.slew);
        let near_c = self.anchor_c + limit(way_c, reach);
        let anchor_c = was_lost.select(temp_c, near_c);
        self.anchor_c = rejected.select(self.anchor_c, anchor_c);

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
            unseen,
            first: is_first & !rejected,
            settling: Sign(self.settled),
            impossible,
            spike: implausible & !impossible & !takes_no_time,
            jumped: self.has_jumped,
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
