//! The chamber programme: air temperature over time.

use core::ops::RangeInclusive;

use crate::error::ProfileError;

/// Air temperatures a programme may ask for, degC.
///
/// Wider than any chamber for this purpose, narrow enough to catch a temperature in kelvin.
pub const AIR_RANGE_C: RangeInclusive<f64> = -100.0..=200.0;

/// Longest programme, s (10 000 h).
pub const MAX_DURATION_S: f64 = 3.6e7;

/// One step of a chamber programme.
#[derive(Debug, Clone, Copy, PartialEq)]
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
        /// Magnitude of the rate, degC/min, positive; the sign follows from `to_c`.
        rate_c_per_min: f64,
    },
}

/// A stretch of time on which the air temperature is linear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leg {
    pub(crate) start_s: f64,
    /// Infinite for the last leg, which holds the final temperature.
    pub(crate) end_s: f64,
    pub(crate) start_c: f64,
    pub(crate) slope_c_per_s: f64,
}

impl Leg {
    /// Air temperature, degC, at a time inside the leg.
    pub(crate) fn air_c(&self, time_s: f64) -> f64 {
        self.start_c + self.slope_c_per_s * (time_s - self.start_s)
    }
}

/// A chamber programme: soaks and ramps, one after the other.
///
/// The unit has stood at [`start_c`](Self::start_c) long enough to be at one temperature
/// throughout when the programme begins at time 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    name: String,
    steps: Vec<Step>,
    /// One leg for each step that takes time, then one that never ends.
    legs: Vec<Leg>,
    start_c: f64,
    duration_s: f64,
}

impl Profile {
    /// Makes a profile that begins at `start_c` and runs through `steps`.
    ///
    /// # Errors
    ///
    /// [`ProfileError`] names the first step with a temperature, a duration or a rate outside
    /// the range given at [`Step`], or says that the programme is empty or too long.
    pub fn new(name: &str, start_c: f64, steps: &[Step]) -> Result<Self, ProfileError> {
        if steps.is_empty() {
            return Err(ProfileError::Empty);
        }
        check_air(0, start_c)?;
        let mut legs = Vec::with_capacity(steps.len() + 1);
        let mut time_s = 0.0;
        let mut air_c = start_c;
        for (index, step) in steps.iter().enumerate() {
            let (leg, end_c) = step.leg(index + 1, time_s, air_c)?;
            // A ramp to where the air already is takes no time and has no slope.
            if leg.end_s > leg.start_s {
                legs.push(leg);
            }
            time_s = leg.end_s;
            air_c = end_c;
        }
        if time_s > MAX_DURATION_S {
            return Err(ProfileError::TooLong);
        }
        legs.push(Leg {
            start_s: time_s,
            end_s: f64::INFINITY,
            start_c: air_c,
            slope_c_per_s: 0.0,
        });
        Ok(Self {
            name: name.to_owned(),
            steps: steps.to_vec(),
            legs,
            start_c,
            duration_s: time_s,
        })
    }

    /// Name of the profile.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The programme, in order.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Temperature of air, case and cavities before time 0, degC.
    pub fn start_c(&self) -> f64 {
        self.start_c
    }

    /// Duration of the whole programme, s.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Air temperature, degC, at any time: the start temperature before time 0, the final
    /// temperature after the last step.
    pub fn air_c(&self, time_s: f64) -> f64 {
        if time_s < 0.0 {
            return self.start_c;
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

impl Step {
    /// The leg this step makes when it begins at `start_s` with the air at `from_c`, and the air
    /// temperature at its end. `number` is the step's own, for errors.
    fn leg(&self, number: usize, start_s: f64, from_c: f64) -> Result<(Leg, f64), ProfileError> {
        match *self {
            Self::Soak {
                air_c,
                duration_min,
            } => {
                check_air(number, air_c)?;
                if !is_positive(duration_min) {
                    return Err(ProfileError::SoakDuration {
                        step: number,
                        duration_min,
                    });
                }
                let leg = Leg {
                    start_s,
                    end_s: start_s + 60.0 * duration_min,
                    start_c: air_c,
                    slope_c_per_s: 0.0,
                };
                Ok((leg, air_c))
            }
            Self::Ramp {
                to_c,
                rate_c_per_min,
            } => {
                check_air(number, to_c)?;
                if !is_positive(rate_c_per_min) {
                    return Err(ProfileError::RampRate {
                        step: number,
                        rate_c_per_min,
                    });
                }
                let rise_c = to_c - from_c;
                let leg = Leg {
                    start_s,
                    end_s: start_s + 60.0 * rise_c.abs() / rate_c_per_min,
                    start_c: from_c,
                    slope_c_per_s: rate_c_per_min.copysign(rise_c) / 60.0,
                };
                Ok((leg, to_c))
            }
        }
    }
}

fn is_positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

fn check_air(step: usize, air_c: f64) -> Result<(), ProfileError> {
    if AIR_RANGE_C.contains(&air_c) {
        Ok(())
    } else {
        Err(ProfileError::AirTemperature { step, air_c })
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
        let refused = |start_c, steps: &[Step]| Profile::new("test", start_c, steps).unwrap_err();
        assert_eq!(refused(20.0, &[]), ProfileError::Empty);
        assert_eq!(
            refused(293.15, &[soak(20.0, 1.0)]),
            ProfileError::AirTemperature {
                step: 0,
                air_c: 293.15
            }
        );
        assert!(matches!(
            refused(20.0, &[soak(20.0, 1.0), ramp(f64::NAN, 1.0)]),
            ProfileError::AirTemperature { step: 2, .. }
        ));
        for duration_min in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                refused(20.0, &[soak(20.0, duration_min)]),
                ProfileError::SoakDuration { step: 1, .. }
            ));
        }
        for rate in [0.0, -0.5, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                refused(20.0, &[soak(20.0, 1.0), ramp(30.0, rate)]),
                ProfileError::RampRate { step: 2, .. }
            ));
        }
        assert_eq!(refused(20.0, &[ramp(30.0, 1e-300)]), ProfileError::TooLong);
    }

    #[test]
    fn errors_say_what_was_expected() {
        let error = Profile::new("test", 20.0, &[ramp(30.0, -2.0)]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "step 1: ramp at -2 degC/min, expected a positive rate"
        );
    }
}
