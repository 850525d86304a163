//! Chamber profiles: steps in a row, with what else happens to the unit.

use core::ops::RangeInclusive;

use serde::Deserialize;

use crate::air::Air;
use crate::check::{Invalid, Range, element};
use crate::events::{Fault, Motion};
use crate::step::Step;

/// Air temperatures a profile may ask for, degC.
///
/// Wider than any chamber for this purpose, narrow enough to catch a temperature in kelvin.
pub const AIR_RANGE_C: RangeInclusive<f64> = -100.0..=200.0;

/// What a profile file says: the chamber's steps, and what else happens to the unit.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProfileParts {
    /// One line for lists of profiles.
    #[serde(default)]
    pub description: String,
    /// Temperature at which air and unit have settled before anything happens, degC.
    pub start_c: f64,
    /// Whether power comes on at time 0: self-heating begins then. Otherwise the unit has been
    /// powered for long.
    #[serde(default)]
    pub cold_start: bool,
    /// What the air does before time 0: the unit follows it, and there is no log of it.
    #[serde(default)]
    pub before: Vec<Step>,
    /// Constant rate about the axes, deg/h: the share of Earth rate that they see, say.
    #[serde(default)]
    pub input_rate_dph: [f64; 3],
    /// The steps, in order.
    pub step: Vec<Step>,
    /// Faults of sensors and data.
    #[serde(default)]
    pub fault: Vec<Fault>,
    /// Disturbances by motion.
    #[serde(default)]
    pub motion: Vec<Motion>,
}

/// A profile that has been found sound.
///
/// The unit has stood at [`start_c`](ProfileParts::start_c) long enough to have settled when the
/// profile begins: at time 0, or earlier where it has steps [`before`](ProfileParts::before) that.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    name: String,
    parts: ProfileParts,
    before: Air,
    air: Air,
}

impl Profile {
    /// Makes a profile that begins at `start_c` and runs through `steps`.
    ///
    /// # Errors
    ///
    /// As [`Profile::from_parts`].
    pub fn new(name: &str, start_c: f64, steps: &[Step]) -> Result<Self, Invalid> {
        let parts = ProfileParts {
            start_c,
            step: steps.to_vec(),
            ..ProfileParts::default()
        };
        Self::from_parts(name, parts)
    }

    /// Checks the parts of a profile.
    ///
    /// # Errors
    ///
    /// [`Invalid`] names the first number outside the range given at its field, or says that the
    /// profile is empty or too long.
    pub fn from_parts(name: &str, parts: ProfileParts) -> Result<Self, Invalid> {
        Range::TEMPERATURE.check("start_c", parts.start_c)?;
        for rate_dph in parts.input_rate_dph {
            Range::SIGNED.check("input_rate_dph", rate_dph)?;
        }
        if parts.step.is_empty() {
            return Err(Invalid::new("step", "an empty list", "one step or more"));
        }
        let before = Air::new(parts.start_c, &parts.before, "before")?;
        let air = Air::new(before.end_c, &parts.step, "step")?;
        for (index, fault) in parts.fault.iter().enumerate() {
            let place = element("fault", index);
            fault.check().map_err(|error| error.inside(place))?;
        }
        for (index, motion) in parts.motion.iter().enumerate() {
            let place = element("motion", index);
            motion.check().map_err(|error| error.inside(place))?;
        }
        Ok(Self {
            name: name.to_owned(),
            parts,
            before,
            air,
        })
    }

    /// Name of the profile.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the profile was made from.
    pub fn parts(&self) -> &ProfileParts {
        &self.parts
    }

    /// The steps, in order.
    pub fn steps(&self) -> &[Step] {
        &self.parts.step
    }

    /// Temperature at which air and unit have settled before anything happens, degC.
    pub fn start_c(&self) -> f64 {
        self.parts.start_c
    }

    /// Duration of the profile from time 0 on, s.
    pub fn duration_s(&self) -> f64 {
        self.air.duration_s
    }

    /// Air temperature, degC, at any time: the start temperature before the first step, the final
    /// temperature after the last one.
    pub fn air_c(&self, time_s: f64) -> f64 {
        if time_s < 0.0 {
            let before = &self.before;
            before.at((time_s + before.duration_s).max(0.0))
        } else {
            self.air.at(time_s)
        }
    }

    /// The air before time 0, from the first step on.
    pub(crate) fn before(&self) -> &Air {
        &self.before
    }

    /// The air from time 0 on.
    pub(crate) fn air(&self) -> &Air {
        &self.air
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soak(air_c: f64, duration_min: f64) -> Step {
        Step::Soak {
            air_c,
            duration_min,
        }
    }

    fn ramp(to_c: f64, rate_c_per_min: f64) -> Step {
        Step::Ramp {
            to_c,
            rate_c_per_min,
        }
    }

    #[test]
    fn steps_take_the_time_they_ask_for() {
        let steps = [soak(20.0, 10.0), ramp(-10.0, 1.5), ramp(0.0, 0.5)];
        let profile = Profile::new("test", 20.0, &steps).unwrap();
        assert_eq!(profile.duration_s(), 600.0 + 1200.0 + 1200.0);
        assert_eq!(profile.air_c(-5.0), 20.0);
        assert_eq!(profile.air_c(599.0), 20.0);
        assert_eq!(profile.air_c(600.0 + 400.0), 10.0);
        assert_eq!(profile.air_c(1800.0), -10.0);
        assert!((profile.air_c(1800.0 + 600.0) + 5.0).abs() < 1e-12);
        assert_eq!(profile.air_c(3000.0), 0.0);
        assert_eq!(profile.air_c(1e9), 0.0);
        assert_eq!(profile.air_c(f64::INFINITY), 0.0);
    }

    #[test]
    fn cycles_are_written_out() {
        let cycle = Step::Cycle {
            first_c: -10.0,
            second_c: 30.0,
            rate_c_per_min: 2.0,
            soak_min: 5.0,
            count: 2,
        };
        let profile = Profile::new("test", 20.0, &[cycle]).unwrap();
        assert_eq!(profile.duration_s(), 60.0 * (15.0 + 3.0 * 20.0 + 4.0 * 5.0));
        for (minute, air_c) in [(15.0, -10.0), (30.0, 10.0), (42.0, 30.0), (65.0, -10.0)] {
            assert!(
                (profile.air_c(60.0 * minute) - air_c).abs() < 1e-9,
                "{minute}"
            );
        }
    }

    #[test]
    fn a_sine_swings_about_its_mean_and_ends_there() {
        let sine = Step::Sine {
            mean_c: 20.0,
            amplitude_c: 15.0,
            period_min: 40.0,
            count: 2,
        };
        let profile = Profile::new("test", 20.0, &[sine]).unwrap();
        assert_eq!(profile.duration_s(), 4800.0);
        for (minute, air_c) in [(0.0, 20.0), (10.0, 35.0), (30.0, 5.0), (50.0, 35.0)] {
            assert!(
                (profile.air_c(60.0 * minute) - air_c).abs() < 1e-9,
                "{minute}"
            );
        }
        assert_eq!(profile.air_c(1e5), 20.0);
    }

    #[test]
    fn an_open_door_lets_the_room_in() {
        let door = Step::Door {
            room_c: 22.0,
            share: 0.5,
            open_min: 2.0,
            recover_min: 8.0,
        };
        let profile = Profile::new("test", -18.0, &[soak(-18.0, 10.0), door]).unwrap();
        assert_eq!(profile.duration_s(), 1200.0);
        for (minute, air_c) in [(10.0, -18.0), (11.0, -8.0), (12.0, 2.0), (16.0, -8.0)] {
            assert!(
                (profile.air_c(60.0 * minute) - air_c).abs() < 1e-9,
                "{minute}"
            );
        }
    }

    #[test]
    fn a_soak_elsewhere_changes_the_air_at_once() {
        let profile = Profile::new("test", 20.0, &[soak(50.0, 1.0)]).unwrap();
        assert_eq!(profile.start_c(), 20.0);
        assert_eq!(profile.air_c(0.0), 50.0);
    }

    #[test]
    fn steps_before_time_0_lead_up_to_it() {
        let parts = ProfileParts {
            start_c: -10.0,
            before: vec![ramp(20.0, 1.0)],
            step: vec![ramp(40.0, 0.5)],
            ..ProfileParts::default()
        };
        let profile = Profile::from_parts("test", parts).unwrap();
        assert_eq!(profile.duration_s(), 2400.0);
        for (minute, air_c) in [(-40.0, -10.0), (-30.0, -10.0), (-10.0, 10.0), (0.0, 20.0)] {
            assert!(
                (profile.air_c(60.0 * minute) - air_c).abs() < 1e-9,
                "{minute}"
            );
        }
        assert_eq!(profile.air_c(600.0), 25.0);

        let parts = ProfileParts {
            before: vec![ramp(20.0, -1.0)],
            step: vec![soak(20.0, 1.0)],
            ..ProfileParts::default()
        };
        assert_eq!(
            Profile::from_parts("test", parts).unwrap_err().to_string(),
            "`before[1].ramp.rate_c_per_min` is -1, expected 0.0001 to 100"
        );
    }

    #[test]
    fn a_ramp_to_where_the_air_is_takes_no_time() {
        let profile = Profile::new("test", 20.0, &[ramp(20.0, 1.0), soak(20.0, 1.0)]).unwrap();
        assert_eq!(profile.duration_s(), 60.0);
        assert_eq!(profile.air().legs.len(), 2);
    }

    #[test]
    fn bad_profiles_are_refused_with_the_step() {
        let sine = |amplitude_c, period_min, count| Step::Sine {
            mean_c: 20.0,
            amplitude_c,
            period_min,
            count,
        };
        for (start_c, steps, expected) in [
            (
                20.0,
                &[][..],
                "`step` is an empty list, expected one step or more",
            ),
            (
                293.15,
                &[soak(20.0, 1.0)],
                "`start_c` is 293.15, expected -100 to 200",
            ),
            (
                20.0,
                &[soak(20.0, 1.0), ramp(f64::NAN, 1.0)],
                "`step[2].ramp.to_c` is NaN, expected -100 to 200",
            ),
            (
                20.0,
                &[soak(20.0, 0.0)],
                "`step[1].soak.duration_min` is 0, expected 0.0001 to 600000",
            ),
            (
                20.0,
                &[soak(20.0, 1.0), ramp(30.0, -0.5)],
                "`step[2].ramp.rate_c_per_min` is -0.5, expected 0.0001 to 100",
            ),
            (
                20.0,
                &[ramp(30.0, 4000.0)],
                "`step[1].ramp.rate_c_per_min` is 4000, expected 0.0001 to 100",
            ),
            (
                20.0,
                &[soak(20.0, 5e5), soak(20.0, 5e5)],
                "`step[2]` is the end of 16667 h, expected 10000 h in all at most",
            ),
            (
                20.0,
                &[sine(190.0, 60.0, 1)],
                "`step[1].sine.amplitude_c` is -170, expected ends within -100 to 200 degC",
            ),
            (
                20.0,
                &[sine(50.0, 1.0, 1)],
                "`step[1].sine.period_min` is too short: up to 314 degC/min, expected 100 degC/min",
            ),
            (
                20.0,
                &[sine(5.0, 60.0, 0)],
                "`step[1].sine.count` is 0, expected 1 to 10000",
            ),
        ] {
            let error = Profile::new("test", start_c, steps).unwrap_err();
            assert_eq!(error.to_string(), expected);
        }
    }
}
