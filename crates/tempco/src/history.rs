//! Where the temperature has been: the second lag and the plays.
//!
//! Both follow temperatures that move no faster than the part can, so neither a fault nor a return
//! makes a step. While the temperature is lost both stand still. Where there was none at all
//! before, both begin at the first one, and then have no weight yet.

use core::hint::select_unpredictable;

use crate::conditioner::Conditioned;
use crate::estimator::Filter;
use crate::settings::PLAYS;
use crate::sign::{Sign, limit, magnitude};
use crate::{Interval, Thermal};

/// Any way is short enough \[bits\].
const ANY: i32 = f32::INFINITY.to_bits() as i32;

/// A play (backlash): a temperature drags a contact along, as through a slot.
///
/// ```text
/// c = min(max(c, v - w), v + w)          the contact follows at a distance of w at most [degC]
/// ```
///
/// A bias with a term `gain (v - c)` runs through a loop that is `2 w gain` high, whether the
/// temperature cycles fast or slowly (play operator; Prandtl, Krasnosel'skii).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Play {
    contact_c: f32,
}

impl Play {
    /// A play whose contact is where the temperature is \[degC\].
    pub const fn new(drag_c: f32) -> Self {
        Self { contact_c: drag_c }
    }

    /// Takes the temperature `v` that drags it; returns `v - c` \[degC\].
    #[inline(always)]
    pub fn follow(&mut self, half_width_c: f32, drag_c: f32) -> f32 {
        let contact_c = self.contact_c;
        let (least_c, most_c) = (drag_c - half_width_c, drag_c + half_width_c);
        let contact_c = select_unpredictable(contact_c < least_c, least_c, contact_c);
        self.contact_c = select_unpredictable(contact_c > most_c, most_c, contact_c);
        drag_c - self.contact_c
    }
}

/// A second thermal lag, of a part that is slower than the rate estimator.
///
/// ```text
/// L2 += alpha2 (T - L2)
/// d2  = T - L2                           [degC]
/// ```
///
/// After an interval of more than half its time constant it begins again at zero.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SecondLag {
    filtered: Filter,
}

impl SecondLag {
    /// A part that has been at this temperature for long \[degC\].
    pub const fn new(temp_c: f32) -> Self {
        Self {
            filtered: Filter::new(temp_c),
        }
    }

    /// Takes a temperature, `interval` after the one before; returns `d2`, without limits
    /// \[degC\].
    #[inline(always)]
    pub fn update(&mut self, interval: &Interval, temp_c: f32) -> f32 {
        self.follow(interval.alpha2, temp_c)
    }

    #[inline(always)]
    fn follow(&mut self, alpha2: f32, temp_c: f32) -> f32 {
        // Nothing is left of it where alpha is 1.
        self.filtered.lag(alpha2, temp_c) * (1.0 - alpha2)
    }
}

/// The second lag as the conditioned temperature drives it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct SecondLagState {
    lag: SecondLag,
    /// The conditioned temperature, but no faster than the part can \[degC\].
    temp_c: f32,
}

impl SecondLagState {
    pub(crate) const fn new(temp_c: f32) -> Self {
        Self {
            lag: SecondLag::new(temp_c),
            temp_c,
        }
    }

    /// The second lag, without limits \[degC\].
    ///
    /// If it `starts`, it is put at `start_c`.
    #[inline(always)]
    pub(crate) fn update(
        &mut self,
        interval: &Interval,
        conditioned: &Conditioned,
        starts: Sign,
        start_c: f32,
    ) -> f32 {
        let way_c = conditioned.temp_c - self.temp_c;
        let slew = conditioned.first.select(ANY, interval.slew);
        let temp_c = self.temp_c + limit(way_c, slew);
        self.temp_c = conditioned.lost.select(self.temp_c, temp_c);
        let alpha2 = conditioned.lost.select(0.0, interval.alpha2);
        let alpha2 = conditioned.first.select(1.0, alpha2);
        let lag_c = self.lag.follow(alpha2, self.temp_c);
        self.lag.filtered.put(starts, self.temp_c - start_c);
        starts.select(start_c, lag_c)
    }
}

/// The plays of a unit, and how far their past is known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct PlayState {
    /// The temperature that drags the plays, `v` \[degC\].
    drag_c: f32,
    plays: [Play; PLAYS],
    /// Time since the temperature was last lost \[ticks\], and the lowest and highest `v` since
    /// then and since it and the rate had settled again.
    since_loss: i32,
    low_c: f32,
    high_c: f32,
}

impl PlayState {
    /// Plays that add nothing. What was before power-on is not known and not asked for.
    pub(crate) const fn new(temp_c: f32) -> Self {
        Self {
            drag_c: temp_c,
            plays: [Play::new(temp_c); PLAYS],
            since_loss: i32::MAX,
            low_c: f32::MIN,
            high_c: f32::MAX,
        }
    }

    /// Takes where `v` is to go \[degC\], whether the plays are put and how far the contacts are then
    /// to be behind, within the half widths \[degC\]. Returns what each play is behind \[degC\],
    /// and whether some of that follows from a past that is not known.
    #[inline(always)]
    pub(crate) fn update(
        &mut self,
        thermal: &Thermal,
        interval: &Interval,
        conditioned: &Conditioned,
        target_c: f32,
        starts: Sign,
        start_c: f32,
    ) -> ([f32; PLAYS], Sign) {
        let starts = starts | conditioned.first;
        let slew = starts.select(ANY, interval.slew);
        let way_c = target_c - self.drag_c;
        let catching_up = Sign::above(magnitude(way_c), slew);
        let moved_c = self.drag_c + limit(way_c, slew);
        self.drag_c = conditioned.lost.select(self.drag_c, moved_c);
        let drag_c = self.drag_c;

        let plays = self.plays.iter_mut().zip(thermal.half_widths);
        let mut plays_c = [0.0; PLAYS];
        for (play_c, (play, half_width)) in plays_c.iter_mut().zip(plays) {
            let contact_c = drag_c - limit(start_c, half_width);
            play.contact_c = starts.select(contact_c, play.contact_c);
            *play_c = play.follow(f32::from_bits(half_width as u32), drag_c);
        }

        // After a loss a play is where it seems to be once the temperature has moved through it:
        // `v` itself, not its way to where it is by now, nor that of a rate which settles.
        let waits = Sign(self.since_loss.wrapping_add(thermal.settling)) & catching_up;
        let ticks = (!waits).keep(interval.ticks);
        let since_loss = self.since_loss.saturating_add(ticks);
        self.since_loss = (!conditioned.unseen).keep(since_loss);
        let is_early = Sign(self.since_loss.wrapping_add(thermal.settling));
        let low_c = select_unpredictable(drag_c < self.low_c, drag_c, self.low_c);
        let high_c = select_unpredictable(drag_c > self.high_c, drag_c, self.high_c);
        self.low_c = is_early.select(drag_c, low_c);
        self.high_c = is_early.select(drag_c, high_c);
        let moved = Sign::of(self.high_c - self.low_c < thermal.known_c);
        let unknown = moved | Sign::above(thermal.known_ticks, self.since_loss);
        (plays_c, unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ThermalSettings;

    #[test]
    fn a_second_lag_follows_its_equation_and_begins_again_after_a_gap() {
        let thermal = Thermal::new(ThermalSettings::DEFAULT).unwrap();
        let [tenth, gap] = [60.0, 301.0].map(|dt_s| Interval::new(&thermal, dt_s));
        let mut lag = SecondLag::new(20.0);
        assert!((lag.update(&tenth, 30.0) - 10.0 * (1.0 - tenth.alpha2)).abs() < 1e-5);
        assert_eq!(lag.update(&gap, 50.0), 0.0);
    }
}
