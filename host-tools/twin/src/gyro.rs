//! The fast noise of a gyro, from the angle that it turns to its output.

use serde::Deserialize;

use crate::check::{Invalid, Range};
use crate::normal::{NormalSource, Stream};
use crate::output::Quantiser;

/// Fast noise of a gyro.
///
/// With `a` the angle of one step of the output (a pulse), a mean rate over `tau` carries, as Allan
/// deviation: `N / sqrt(tau)` of random walk, `sqrt(3) phi / tau` of white angle noise, and of counting
/// whole steps `a / (2 tau)`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GyroNoise {
    /// Angle random walk N, rate unit times sqrt(s).
    #[serde(default)]
    pub angle_random_walk: f64,
    /// White noise phi of the angle at the sampling instants (read-out, dither removal), sigma in
    /// rate unit times s.
    #[serde(default)]
    pub angle_white_noise: f64,
}

impl GyroNoise {
    /// No noise. The output has whole steps all the same.
    pub const NONE: Self = Self {
        angle_random_walk: 0.0,
        angle_white_noise: 0.0,
    };

    pub(crate) fn check(&self) -> Result<(), Invalid> {
        Range::MAGNITUDE.check("angle_random_walk", self.angle_random_walk)?;
        Range::MAGNITUDE.check("angle_white_noise", self.angle_white_noise)
    }
}

/// One gyro's channel.
#[derive(Debug, Clone)]
pub(crate) struct GyroChannel {
    walk: NormalSource,
    walk_sigma: f64,
    white: NormalSource,
    white_sigma: f64,
    /// White angle noise at the last sample.
    white_angle: f64,
    quantiser: Quantiser,
}

impl GyroChannel {
    /// Channel of one axis for samples `interval_s` apart.
    pub(crate) fn new(
        noise: &GyroNoise,
        quantiser: Quantiser,
        interval_s: f64,
        seed: u64,
        axis: usize,
    ) -> Self {
        let mut white = NormalSource::new(seed, Stream::AngleNoise(axis));
        Self {
            walk: NormalSource::new(seed, Stream::AngleWalk(axis)),
            walk_sigma: noise.angle_random_walk * interval_s.sqrt(),
            white_sigma: noise.angle_white_noise,
            white_angle: noise.angle_white_noise * white.next(),
            white,
            quantiser,
        }
    }

    /// Output for a sample interval in which the unit's motion and bias turn `angle`, rate unit
    /// times s.
    pub(crate) fn count(&mut self, angle: f64) -> i64 {
        let mut noisy = angle + self.walk_sigma * self.walk.next();
        if self.white_sigma > 0.0 {
            let white_angle = self.white_sigma * self.white.next();
            noisy += white_angle - self.white_angle;
            self.white_angle = white_angle;
        }
        self.quantiser.count(noisy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Output;
    use crate::unit::Unit;

    fn channel(unit: &Unit, interval_s: f64, seed: u64, axis: usize) -> GyroChannel {
        let quantiser = Quantiser::new(unit.output, unit.rate_unit, interval_s);
        GyroChannel::new(&unit.axes[axis].noise, quantiser, interval_s, seed, axis)
    }

    fn paper() -> Unit {
        Unit::named("paper").unwrap()
    }

    fn quiet() -> Unit {
        let mut unit = paper();
        for axis in &mut unit.axes {
            axis.noise = GyroNoise::NONE;
        }
        unit
    }

    fn sigma(values: &[f64]) -> f64 {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        (square / (n - 1.0)).sqrt()
    }

    #[test]
    fn counting_pulses_loses_no_angle() {
        let mut channel = channel(&quiet(), 0.5, 1, 0);
        let mut source = NormalSource::new(3, Stream::Rows);
        let (mut angle, mut pulses) = (0.0, 0);
        for _ in 0..100_000 {
            let increment = 0.7 * source.next() - 0.01;
            angle += increment;
            pulses += channel.count(increment);
            let rest = angle - pulses as f64;
            assert!((-1e-6..1.0 + 1e-6).contains(&rest), "{rest}");
        }
        assert!(pulses < -900, "{pulses}");
    }

    #[test]
    fn noise_of_100_s_means_of_the_paper_unit_is_as_documented() {
        for bias in [0.0173, -0.02, 0.0] {
            let mut channel = channel(&paper(), 0.5, 5, 2);
            let means: Vec<f64> = (0..2000)
                .map(|_| (0..200).map(|_| channel.count(bias * 0.5)).sum::<i64>() as f64 / 100.0)
                .collect();
            let sigma = sigma(&means);
            assert!((sigma / 0.0051 - 1.0).abs() < 0.1, "{sigma}");
        }
    }

    /// Overlapping Allan deviation of the counts of a resting channel, over `m` samples.
    fn allan(unit: &Unit, rate_hz: f64, m: usize) -> f64 {
        let mut channel = channel(unit, 1.0 / rate_hz, 4, 0);
        let mut angles = vec![0];
        for _ in 0..400_000 {
            angles.push(angles.last().unwrap() + channel.count(0.37 / rate_hz));
        }
        let square: f64 = angles
            .windows(2 * m + 1)
            .map(|w| ((w[2 * m] - 2 * w[m] + w[0]) as f64).powi(2))
            .sum();
        let count = (angles.len() - 2 * m) as f64;
        (square / (2.0 * count)).sqrt() * rate_hz / m as f64
    }

    #[test]
    fn the_allan_deviation_has_the_slopes_of_its_parts() {
        let with = |angle_random_walk, angle_white_noise| {
            let mut unit = quiet();
            unit.axes[0].noise = GyroNoise {
                angle_random_walk,
                angle_white_noise,
            };
            unit
        };
        for m in [1, 8, 64, 512] {
            let tau_s = m as f64 / 64.0;
            // Large noise, so that whole pulses do not matter.
            let walk = allan(&with(40.0, 0.0), 64.0, m) / (40.0 / tau_s.sqrt());
            assert!((walk - 1.0).abs() < 0.06, "{m}: {walk}");
            let white = allan(&with(0.0, 40.0), 64.0, m) / (3.0_f64.sqrt() * 40.0 / tau_s);
            assert!((white - 1.0).abs() < 0.03, "{m}: {white}");
        }
        // Whole pulses alone, with enough noise to make their errors independent.
        for m in [64, 512] {
            let tau_s = m as f64 / 64.0;
            let other = 0.8_f64.powi(2) / tau_s;
            let counted = (allan(&with(0.8, 0.0), 64.0, m).powi(2) - other).sqrt();
            if m == 64 {
                assert!((counted / (0.5 / tau_s) - 1.0).abs() < 0.2, "{counted}");
            }
        }
    }

    #[test]
    fn a_rate_is_rounded_and_limited() {
        let unit = Unit {
            rate_unit: crate::RateUnit::Dps,
            output: Output::Rate {
                step: 0.25,
                full_scale: 10.0,
            },
            ..quiet()
        };
        let mut channel = channel(&unit, 0.5, 1, 0);
        let mut count = |rate: f64| channel.count(rate * 0.5);
        assert_eq!(
            [0.0, 0.3, -0.4, 9.99, 500.0, -500.0].map(&mut count),
            [0, 1, -2, 40, 40, -40]
        );
    }

    #[test]
    fn pulses_have_the_angle_of_the_scale_factor() {
        let unit = Unit {
            rate_unit: crate::RateUnit::Dph,
            output: Output::Pulses {
                scale_factor_arcsec: 0.5,
            },
            ..quiet()
        };
        // 36 deg/h are 36 arcsec/s, 18 arcsec in half a second.
        assert_eq!(channel(&unit, 0.5, 1, 0).count(18.1), 36);
    }
}
