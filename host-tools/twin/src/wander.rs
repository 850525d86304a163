//! Air that wanders: a mission that no calibration has seen.

use serde::Deserialize;

use crate::check::{Invalid, Range};
use crate::legs::{Course, Legs};
use crate::normal::{NormalSource, Stream};

/// Ramps at random within a range, as a unit in use may see them.
///
/// Of ten stretches, about five are ramps that turn back after 5 to 25 degC, three are ramps to any
/// temperature of the range, one is a soak of 5 to 30 min, and one a sine wave with a period of 0.7 to
/// 2 h. The logarithm of a ramp's rate is uniform. No ramp is longer than an eighth of the duration.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wander {
    /// Every seed gives another course.
    pub seed: u64,
    /// Lowest air temperature, degC. Air that begins outside the range moves into it.
    pub low_c: f64,
    /// Highest air temperature, degC, 10 degC or more above the lowest.
    pub high_c: f64,
    /// Slowest rate, degC/min, 0.01 to 100.
    pub slowest_c_per_min: f64,
    /// Fastest rate, degC/min, not below the slowest.
    pub fastest_c_per_min: f64,
    /// Duration, h, 0.1 to 1000.
    pub duration_h: f64,
}

/// Spans after which a ramp turns back, degC.
const TURN_BACK_C: [f64; 2] = [5.0, 25.0];
/// Durations of soaks, minutes.
const SOAK_MIN: [f64; 2] = [5.0, 30.0];
/// Periods of sine waves, minutes.
const PERIOD_MIN: [f64; 2] = [42.0, 120.0];
/// Amplitudes of sine waves, degC.
const AMPLITUDE_C: [f64; 2] = [4.0, 15.0];

impl Wander {
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        Range::TEMPERATURE.check("low_c", self.low_c)?;
        Range::TEMPERATURE.check("high_c", self.high_c)?;
        if self.high_c - self.low_c < 10.0 {
            let expected = format!("10 or more above {}", self.low_c);
            return Err(Invalid::new("high_c", self.high_c, expected));
        }
        let slowest = self.slowest_c_per_min;
        Range::new(0.01, 100.0).check("slowest_c_per_min", slowest)?;
        Range::new(slowest, 100.0).check("fastest_c_per_min", self.fastest_c_per_min)?;
        Range::new(0.1, 1000.0).check("duration_h", self.duration_h)
    }

    /// Appends the stretches; the last one is cut short at the end.
    pub(crate) fn append(&self, legs: &mut Legs) {
        let mut random = NormalSource::new(self.seed, Stream::Wander);
        let end_s = legs.time_s + 3600.0 * self.duration_h;
        let mut upwards = random.sign() > 0.0;
        while legs.time_s < end_s {
            let left_min = (end_s - legs.time_s) / 60.0;
            let choice = random.between(0.0, 10.0);
            if choice < 1.0 {
                self.soak(legs, &mut random, left_min);
            } else if choice < 2.0 {
                self.wave(legs, &mut random, left_min);
            } else {
                let to_c = if choice < 7.0 {
                    let [least_c, most_c] = TURN_BACK_C;
                    let span_c = random.between(least_c, most_c);
                    legs.air_c + if upwards { -span_c } else { span_c }
                } else {
                    random.between(self.low_c, self.high_c)
                };
                upwards = to_c > legs.air_c;
                self.ramp(legs, &mut random, to_c, left_min);
            }
        }
    }

    fn soak(&self, legs: &mut Legs, random: &mut NormalSource, left_min: f64) {
        let [shortest_min, longest_min] = SOAK_MIN;
        let duration_min = random.between(shortest_min, longest_min);
        legs.soak(legs.air_c, duration_min.min(left_min));
    }

    /// A whole wave about the present temperature, where there is room and time for one.
    fn wave(&self, legs: &mut Legs, random: &mut NormalSource, left_min: f64) {
        let [shortest_min, longest_min] = PERIOD_MIN;
        let period_min = random.between(shortest_min, longest_min);
        let steepest_c = self.fastest_c_per_min * period_min / core::f64::consts::TAU;
        let room_c = (legs.air_c - self.low_c).min(self.high_c - legs.air_c);
        let [least_c, most_c] = AMPLITUDE_C;
        let most_c = most_c.min(room_c).min(steepest_c);
        if most_c >= least_c && period_min <= left_min {
            let course = Course::Sine {
                mean_c: legs.air_c,
                amplitude_c: random.sign() * random.between(least_c, most_c),
                rad_per_s: core::f64::consts::TAU / (60.0 * period_min),
            };
            legs.push(course, 60.0 * period_min, legs.air_c);
        }
    }

    fn ramp(&self, legs: &mut Legs, random: &mut NormalSource, to_c: f64, left_min: f64) {
        let rate_c_per_min = random.log_between(self.slowest_c_per_min, self.fastest_c_per_min);
        let longest_min = left_min.min(7.5 * self.duration_h);
        let most_c = rate_c_per_min * longest_min;
        let rise_c = to_c.clamp(self.low_c, self.high_c) - legs.air_c;
        if rise_c.abs() < most_c {
            legs.ramp(legs.air_c + rise_c, rate_c_per_min);
        } else {
            legs.line(legs.air_c + most_c.copysign(rise_c), longest_min);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wander(seed: u64) -> Wander {
        Wander {
            seed,
            low_c: -12.0,
            high_c: 77.0,
            slowest_c_per_min: 0.2,
            fastest_c_per_min: 2.5,
            duration_h: 12.0,
        }
    }

    fn legs(wander: &Wander) -> Legs {
        wander.check().unwrap();
        let mut legs = Legs::starting_at(20.0);
        wander.append(&mut legs);
        legs
    }

    /// Slopes of the ramps, degC/min, in order.
    fn slopes(legs: &Legs) -> Vec<f64> {
        let slope = |course: &Course| match *course {
            Course::Line { slope_c_per_s, .. } => Some(60.0 * slope_c_per_s),
            Course::Sine { .. } => None,
        };
        let slopes = legs.legs.iter().filter_map(|leg| slope(&leg.course));
        slopes.filter(|slope| *slope != 0.0).collect()
    }

    #[test]
    fn it_stays_within_its_range_and_rates_and_ends_on_time() {
        for seed in 0..200 {
            let legs = legs(&wander(seed));
            assert!((legs.time_s - 12.0 * 3600.0).abs() < 1e-6, "{seed}");
            for leg in &legs.legs {
                for part in 0..=8 {
                    let time_s = leg.start_s + f64::from(part) / 8.0 * (leg.end_s - leg.start_s);
                    let air_c = leg.air_c(time_s);
                    assert!(
                        (-12.0 - 1e-9..77.0 + 1e-9).contains(&air_c),
                        "{seed}: {air_c}"
                    );
                }
            }
            for slope in slopes(&legs) {
                assert!((0.199..2.501).contains(&slope.abs()), "{seed}: {slope}");
            }
        }
    }

    #[test]
    fn neighbouring_stretches_meet() {
        for seed in 0..50 {
            for pair in legs(&wander(seed)).legs.windows(2) {
                assert_eq!(pair[0].end_s, pair[1].start_s);
                let step_c = pair[1].air_c(pair[1].start_s) - pair[0].air_c(pair[0].end_s);
                assert!(step_c.abs() < 1e-9, "{seed}: {step_c}");
            }
        }
    }

    #[test]
    fn it_turns_often_and_has_soaks_and_waves() {
        let (mut turns, mut soaks, mut waves) = (0, 0, 0);
        for seed in 0..50 {
            let legs = legs(&wander(seed));
            let slopes = slopes(&legs);
            turns += slopes
                .windows(2)
                .filter(|pair| pair[0] * pair[1] < 0.0)
                .count();
            waves += legs
                .legs
                .iter()
                .filter(|leg| matches!(leg.course, Course::Sine { .. }))
                .count();
            let still = |leg: &&crate::legs::Leg| {
                matches!(
                    leg.course,
                    Course::Line {
                        slope_c_per_s: 0.0,
                        ..
                    }
                )
            };
            soaks += legs.legs.iter().filter(still).count();
        }
        // Fifty runs of twelve hours.
        assert!(turns > 50 * 10, "{turns}");
        assert!(soaks > 50 && waves > 50, "{soaks} {waves}");
    }

    #[test]
    fn seeds_differ_and_air_from_outside_moves_in() {
        assert_eq!(legs(&wander(1)).legs, legs(&wander(1)).legs);
        assert_ne!(legs(&wander(1)).legs, legs(&wander(2)).legs);
        let mut outside = Legs::starting_at(-60.0);
        wander(3).append(&mut outside);
        assert!((-12.0..77.0).contains(&outside.air_c), "{}", outside.air_c);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let narrow = Wander {
            high_c: -5.0,
            ..wander(1)
        };
        let slow = Wander {
            fastest_c_per_min: 0.1,
            ..wander(1)
        };
        let long = Wander {
            duration_h: f64::NAN,
            ..wander(1)
        };
        for (wander, expected) in [
            (narrow, "`high_c` is -5, expected 10 or more above -12"),
            (slow, "`fastest_c_per_min` is 0.1, expected 0.2 to 100"),
            (long, "`duration_h` is NaN, expected 0.1 to 1000"),
        ] {
            assert_eq!(wander.check().unwrap_err().to_string(), expected);
        }
    }
}
