//! The steps of a chamber profile.

use serde::Deserialize;

use crate::check::{Invalid, Range};
use crate::legs::{Course, Legs};
use crate::wander::Wander;

/// One step of a chamber profile.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Step {
    /// The air is at one temperature for a time.
    ///
    /// Where the step before ended at another temperature, the air changes at once, as when a
    /// unit is moved into a second chamber.
    Soak {
        /// Air temperature, degC, inside [`AIR_RANGE_C`](crate::AIR_RANGE_C).
        air_c: f64,
        /// Duration, minutes, positive.
        duration_min: f64,
    },
    /// The air moves at a constant rate, up or down, until it reaches a temperature.
    Ramp {
        /// Air temperature at the end, degC, inside [`AIR_RANGE_C`](crate::AIR_RANGE_C).
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
    /// The door is opened: the air moves in a straight line towards the room, and back when
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
    /// The air wanders: ramps at random, most of them turning back early, with soaks and waves.
    Random(Wander),
}

impl Step {
    /// Appends the stretches of this step.
    pub(crate) fn append(&self, legs: &mut Legs) -> Result<(), Invalid> {
        let air = Range::TEMPERATURE;
        // Each step checks its numbers by name, then appends its stretches.
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
                // Both ends of the sine are air temperatures, and its steepest rate has a limit.
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
                // A share of the way to the room, and back.
                let before_c = legs.air_c;
                legs.line(before_c + share * (room_c - before_c), open_min);
                legs.line(before_c, recover_min);
            }
            Self::Random(wander) => {
                wander.check().map_err(|error| error.inside("random"))?;
                wander.append(legs);
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
