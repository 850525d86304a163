//! The chamber programme: air temperature over time.

use core::ops::RangeInclusive;

use serde::Deserialize;

use crate::check::{Invalid, Range, element};
use crate::events::{Fault, Motion};

/// Air temperatures a programme may ask for, degC.
///
/// Wider than any chamber for this purpose, narrow enough to catch a temperature in kelvin.
pub const AIR_RANGE_C: RangeInclusive<f64> = -100.0..=200.0;

/// Longest programme, s (10 000 h).
pub const MAX_DURATION_S: f64 = 3.6e7;

/// Most legs a programme may have, cycles written out.
const MAX_LEGS: usize = 100_000;

/// One step of a chamber programme.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Step {
    /// The air is at one temperature for a time.
    ///
    /// Where the step before ended at another temperature, the air changes at once, as when a
    /// unit is moved into a second chamber.
    Soak {
        /// Air temperature, degC, inside [`AIR_RANGE_C`].
        air_c: f64,
        /// Duration, minutes, positive.
        duration_min: f64,
    },
    /// The air moves at a constant rate, up or down, until it reaches a temperature.
    Ramp {
        /// Air temperature at the end, degC, inside [`AIR_RANGE_C`].
        to_c: f64,
        /// Magnitude of the rate, degC/min, 1e-4 to 100; the sign follows from `to_c`.
        rate_c_per_min: f64,
    },
    /// Ramp to one temperature, soak, ramp to another, soak; several times.
    Cycle {
        /// First temperature, degC.
        first_c: f64,
        /// Second temperature, degC.
        second_c: f64,
        /// Magnitude of the rate, degC/min, 1e-4 to 100.
        rate_c_per_min: f64,
        /// Duration of every soak, minutes, positive.
        soak_min: f64,
        /// How many times.
        count: u32,
    },
    /// The air swings about a mean, upwards first.
    Sine {
        /// Mean, degC; where the step before ended at another temperature, the air changes at once.
        mean_c: f64,
        /// Amplitude, degC.
        amplitude_c: f64,
        /// Period, minutes, positive; the fastest change must stay within 100 degC/min.
        period_min: f64,
        /// How many periods.
        count: u32,
    },
    /// The door is opened: the air moves towards that of the room in a straight line, and back when
    /// the door is shut.
    Door {
        /// Temperature of the room, degC.
        room_c: f64,
        /// Part of the way to the room's temperature that the air goes, 0 to 1.
        share: f64,
        /// How long the door is open, minutes.
        open_min: f64,
        /// How long the chamber takes to recover, minutes.
        recover_min: f64,
    },
}

/// Temperature of the air as a function of time since the beginning of a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Course {
    Line {
        start_c: f64,
        slope_c_per_s: f64,
    },
    Sine {
        mean_c: f64,
        amplitude_c: f64,
        rad_per_s: f64,
    },
}

impl Course {
    const fn constant(air_c: f64) -> Self {
        Self::Line {
            start_c: air_c,
            slope_c_per_s: 0.0,
        }
    }

    fn air_c(&self, time_s: f64) -> f64 {
        match *self {
            Self::Line {
                start_c,
                slope_c_per_s,
            } => start_c + slope_c_per_s * time_s,
            Self::Sine {
                mean_c,
                amplitude_c,
                rad_per_s,
            } => mean_c + amplitude_c * libm::sin(rad_per_s * time_s),
        }
    }
}

/// A stretch of time with one course.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leg {
    pub(crate) start_s: f64,
    /// Infinite for the last leg, which holds the final temperature.
    pub(crate) end_s: f64,
    pub(crate) course: Course,
}

impl Leg {
    /// Air temperature, degC, at a time inside the leg.
    pub(crate) fn air_c(&self, time_s: f64) -> f64 {
        self.course.air_c(time_s - self.start_s)
    }
}

/// What a programme file says: the chamber's steps, and what else happens to the unit.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Programme {
    /// One line for lists of programmes.
    #[serde(default)]
    pub description: String,
    /// Temperature of air and unit before time 0, degC.
    pub start_c: f64,
    /// Whether power comes on at time 0: self-heating begins then. Otherwise the unit has been
    /// powered for long.
    #[serde(default)]
    pub cold_start: bool,
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

/// A programme that has been found sound.
///
/// The unit has stood at [`start_c`](Programme::start_c) long enough to have settled when the
/// programme begins at time 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    name: String,
    programme: Programme,
    /// One leg for each stretch that takes time, then one that never ends.
    legs: Vec<Leg>,
    duration_s: f64,
}

impl Profile {
    /// Makes a profile that begins at `start_c` and runs through `steps`.
    ///
    /// # Errors
    ///
    /// As [`Profile::from_programme`].
    pub fn new(name: &str, start_c: f64, steps: &[Step]) -> Result<Self, Invalid> {
        let programme = Programme {
            start_c,
            step: steps.to_vec(),
            ..Programme::default()
        };
        Self::from_programme(name, programme)
    }

    /// Makes a profile of a whole programme.
    ///
    /// # Errors
    ///
    /// [`Invalid`] names the first number outside the range given at its field, or says that the
    /// programme is empty or too long.
    pub fn from_programme(name: &str, programme: Programme) -> Result<Self, Invalid> {
        Range::TEMPERATURE.check("start_c", programme.start_c)?;
        for rate_dph in programme.input_rate_dph {
            Range::SIGNED.check("input_rate_dph", rate_dph)?;
        }
        if programme.step.is_empty() {
            return Err(Invalid::new("step", "an empty list", "one step or more"));
        }
        let mut course = Legs::starting_at(programme.start_c);
        for (index, step) in programme.step.iter().enumerate() {
            let place = element("step", index);
            step.append(&mut course)
                .map_err(|error| error.inside(&place))?;
            if course.time_s > MAX_DURATION_S || course.legs.len() > MAX_LEGS {
                let found = format!("the end of {:.0} h", course.time_s / 3600.0);
                return Err(Invalid::new(place, found, "10000 h in all at most"));
            }
        }
        for (index, fault) in programme.fault.iter().enumerate() {
            let place = element("fault", index);
            fault.check().map_err(|error| error.inside(place))?;
        }
        for (index, motion) in programme.motion.iter().enumerate() {
            let place = element("motion", index);
            motion.check().map_err(|error| error.inside(place))?;
        }
        let duration_s = course.time_s;
        course.legs.push(Leg {
            start_s: duration_s,
            end_s: f64::INFINITY,
            course: Course::constant(course.air_c),
        });
        Ok(Self {
            name: name.to_owned(),
            programme,
            legs: course.legs,
            duration_s,
        })
    }

    /// Name of the profile.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the profile was made from.
    pub fn programme(&self) -> &Programme {
        &self.programme
    }

    /// The steps, in order.
    pub fn steps(&self) -> &[Step] {
        &self.programme.step
    }

    /// Temperature of air and unit before time 0, degC.
    pub fn start_c(&self) -> f64 {
        self.programme.start_c
    }

    /// Duration of the whole programme, s.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Air temperature, degC, at any time: the start temperature before time 0, the final
    /// temperature after the last step.
    pub fn air_c(&self, time_s: f64) -> f64 {
        if time_s < 0.0 {
            return self.start_c();
        }
        // After the end the last leg holds one temperature, so that its first moment will do.
        let time_s = time_s.min(self.duration_s);
        let passed = self.legs.partition_point(|leg| leg.end_s <= time_s);
        self.legs[passed].air_c(time_s)
    }

    pub(crate) fn legs(&self) -> &[Leg] {
        &self.legs
    }
}

/// Legs so far, and where they have led to.
struct Legs {
    legs: Vec<Leg>,
    time_s: f64,
    air_c: f64,
}

impl Legs {
    fn starting_at(air_c: f64) -> Self {
        Self {
            legs: Vec::new(),
            time_s: 0.0,
            air_c,
        }
    }

    fn push(&mut self, course: Course, duration_s: f64, end_c: f64) {
        let start_s = self.time_s;
        let end_s = start_s + duration_s;
        // A ramp to where the air already is takes no time and has no slope.
        if end_s > start_s {
            self.legs.push(Leg {
                start_s,
                end_s,
                course,
            });
        }
        self.time_s = end_s;
        self.air_c = end_c;
    }

    fn soak(&mut self, air_c: f64, duration_min: f64) {
        self.push(Course::constant(air_c), 60.0 * duration_min, air_c);
    }

    fn ramp(&mut self, to_c: f64, rate_c_per_min: f64) {
        let rise_c = to_c - self.air_c;
        let course = Course::Line {
            start_c: self.air_c,
            slope_c_per_s: rate_c_per_min.copysign(rise_c) / 60.0,
        };
        self.push(course, 60.0 * rise_c.abs() / rate_c_per_min, to_c);
    }

    fn line(&mut self, to_c: f64, duration_min: f64) {
        let course = Course::Line {
            start_c: self.air_c,
            slope_c_per_s: (to_c - self.air_c) / (60.0 * duration_min),
        };
        self.push(course, 60.0 * duration_min, to_c);
    }
}

impl Step {
    /// Appends the legs this step makes.
    fn append(&self, legs: &mut Legs) -> Result<(), Invalid> {
        let air = Range::TEMPERATURE;
        match *self {
            Self::Soak {
                air_c,
                duration_min,
            } => {
                air.check("soak.air_c", air_c)?;
                Range::DURATION_MIN.check("soak.duration_min", duration_min)?;
                legs.soak(air_c, duration_min);
            }
            Self::Ramp {
                to_c,
                rate_c_per_min,
            } => {
                air.check("ramp.to_c", to_c)?;
                Range::AIR_RATE.check("ramp.rate_c_per_min", rate_c_per_min)?;
                legs.ramp(to_c, rate_c_per_min);
            }
            Self::Cycle {
                first_c,
                second_c,
                rate_c_per_min,
                soak_min,
                count,
            } => {
                air.check("cycle.first_c", first_c)?;
                air.check("cycle.second_c", second_c)?;
                Range::AIR_RATE.check("cycle.rate_c_per_min", rate_c_per_min)?;
                Range::DURATION_MIN.check("cycle.soak_min", soak_min)?;
                check_count("cycle.count", count)?;
                for _ in 0..count {
                    for to_c in [first_c, second_c] {
                        legs.ramp(to_c, rate_c_per_min);
                        legs.soak(to_c, soak_min);
                    }
                }
            }
            Self::Sine {
                mean_c,
                amplitude_c,
                period_min,
                count,
            } => {
                air.check("sine.mean_c", mean_c)?;
                Range::DIFFERENCE.check("sine.amplitude_c", amplitude_c)?;
                for end_c in [mean_c - amplitude_c, mean_c + amplitude_c] {
                    air.check("sine.amplitude_c", end_c)
                        .map_err(|error| Invalid {
                            expected: format!("ends within {} degC", error.expected),
                            ..error
                        })?;
                }
                Range::DURATION_MIN.check("sine.period_min", period_min)?;
                check_count("sine.count", count)?;
                let rate_c_per_min = core::f64::consts::TAU * amplitude_c.abs() / period_min;
                if rate_c_per_min > 100.0 {
                    let found = format!("too short: up to {rate_c_per_min:.0} degC/min");
                    return Err(Invalid::new("sine.period_min", found, "100 degC/min"));
                }
                let course = Course::Sine {
                    mean_c,
                    amplitude_c,
                    rad_per_s: core::f64::consts::TAU / (60.0 * period_min),
                };
                legs.push(course, 60.0 * period_min * f64::from(count), mean_c);
            }
            Self::Door {
                room_c,
                share,
                open_min,
                recover_min,
            } => {
                air.check("door.room_c", room_c)?;
                Range::SHARE.check("door.share", share)?;
                Range::DURATION_MIN.check("door.open_min", open_min)?;
                Range::DURATION_MIN.check("door.recover_min", recover_min)?;
                let before_c = legs.air_c;
                legs.line(before_c + share * (room_c - before_c), open_min);
                legs.line(before_c, recover_min);
            }
        }
        Ok(())
    }
}

fn check_count(path: &str, count: u32) -> Result<(), Invalid> {
    if (1..=10_000).contains(&count) {
        Ok(())
    } else {
        Err(Invalid::new(path, count, "1 to 10000"))
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
    fn a_ramp_to_where_the_air_is_takes_no_time() {
        let profile = Profile::new("test", 20.0, &[ramp(20.0, 1.0), soak(20.0, 1.0)]).unwrap();
        assert_eq!(profile.duration_s(), 60.0);
        assert_eq!(profile.legs().len(), 2);
    }

    #[test]
    fn bad_programmes_are_refused_with_the_step() {
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
