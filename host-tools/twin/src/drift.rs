//! The part of an axis's bias that chance decides: turn-on, flicker and random walk.

use serde::Deserialize;

use crate::check::{Invalid, Range};
use crate::normal::{NormalSource, Stream};

/// Random drift of an axis's bias. All are 0 unless given.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drift {
    /// Turn-on repeatability: sigma of a constant that is new for every seed, rate unit.
    #[serde(default)]
    pub turn_on_sigma: f64,
    /// Bias instability B, rate unit: the Allan deviation of the flicker is 0.664 B, from some 2 s to
    /// 10 000 s.
    #[serde(default)]
    pub bias_instability: f64,
    /// Rate random walk K, rate unit per sqrt(s): Allan deviation `K sqrt(tau / 3)`.
    #[serde(default)]
    pub rate_random_walk: f64,
}

impl Drift {
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        let range = Range::MAGNITUDE;
        range.check("turn_on_sigma", self.turn_on_sigma)?;
        range.check("bias_instability", self.bias_instability)?;
        range.check("rate_random_walk", self.rate_random_walk)
    }
}

/// Markov processes whose sum is the flicker, their time constants a factor of 4 apart.
const PROCESSES: usize = 9;
const FASTEST_S: f64 = 0.5;
const SPACING: f64 = 4.0;

/// One axis's drift, as a function of time alone.
///
/// New values are drawn once per second of simulated time and joined by straight lines, so that runs
/// at any rate have the same drift, and high rates pay nothing for it. The flicker is a sum of
/// first-order Markov processes of equal sigma: with time constants a factor r apart its spectral
/// density is `sigma^2 / (2 ln(r) f)`, to be `B^2 / (2 pi f)`.
#[derive(Debug, Clone)]
pub(crate) struct DriftState {
    drift: Drift,
    noise: NormalSource,
    turn_on: f64,
    walk: f64,
    processes: [f64; PROCESSES],
    decays: [f64; PROCESSES],
    sigmas: [f64; PROCESSES],
    /// Whole second at which `value` holds; `next` holds a second later.
    second: f64,
    value: f64,
    next: f64,
}

impl DriftState {
    pub(crate) fn new(drift: &Drift, seed: u64, axis: usize) -> Self {
        let mut noise = NormalSource::new(seed, Stream::Drift(axis));
        let turn_on = drift.turn_on_sigma * noise.next();
        let variance = libm::log(SPACING) / core::f64::consts::PI;
        let sigma = drift.bias_instability * variance.sqrt();
        let mut time_constant_s = FASTEST_S / SPACING;
        let decays = core::array::from_fn(|_| {
            time_constant_s *= SPACING;
            libm::exp(-1.0 / time_constant_s)
        });
        let mut state = Self {
            drift: *drift,
            turn_on,
            walk: 0.0,
            processes: core::array::from_fn(|_| sigma * noise.next()),
            sigmas: decays.map(|decay: f64| sigma * (1.0 - decay * decay).sqrt()),
            decays,
            noise,
            second: 0.0,
            value: 0.0,
            next: 0.0,
        };
        state.value = state.sum();
        state.next = state.draw();
        state
    }

    fn sum(&self) -> f64 {
        self.turn_on + self.walk + self.processes.iter().sum::<f64>()
    }

    /// The value a second later.
    fn draw(&mut self) -> f64 {
        if self.drift.bias_instability > 0.0 {
            for ((process, decay), sigma) in
                self.processes.iter_mut().zip(self.decays).zip(self.sigmas)
            {
                *process = decay * *process + sigma * self.noise.next();
            }
        }
        if self.drift.rate_random_walk > 0.0 {
            self.walk += self.drift.rate_random_walk * self.noise.next();
        }
        self.sum()
    }

    /// Drift at a time not before the last call's, rate unit.
    pub(crate) fn at(&mut self, time_s: f64) -> f64 {
        while self.second + 1.0 <= time_s {
            self.second += 1.0;
            self.value = self.next;
            self.next = self.draw();
        }
        self.value + (self.next - self.value) * (time_s - self.second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Allan deviation of values a second apart, non-overlapping, over `m` seconds.
    fn allan(values: &[f64], m: usize) -> f64 {
        let means: Vec<f64> = values
            .chunks_exact(m)
            .map(|chunk| chunk.iter().sum::<f64>() / m as f64)
            .collect();
        let square: f64 = means.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
        (square / (2.0 * (means.len() - 1) as f64)).sqrt()
    }

    fn values(drift: &Drift, seed: u64, count: u32) -> Vec<f64> {
        let mut state = DriftState::new(drift, seed, 0);
        (0..count).map(|i| state.at(f64::from(i))).collect()
    }

    #[test]
    fn flicker_has_a_floor_of_the_stated_height() {
        let drift = Drift {
            bias_instability: 3.0,
            ..Drift::default()
        };
        let values = values(&drift, 1, 1_000_000);
        for m in [4, 16, 64, 256, 1024, 4096] {
            let ratio = allan(&values, m) / (0.664 * 3.0);
            assert!((ratio - 1.0).abs() < 0.15, "{m} s: {ratio}");
        }
    }

    #[test]
    fn a_random_walk_grows_with_the_root_of_time() {
        let drift = Drift {
            rate_random_walk: 0.02,
            ..Drift::default()
        };
        let values = values(&drift, 2, 1_000_000);
        for m in [10, 100, 1000] {
            let ratio = allan(&values, m) / (0.02 * (m as f64 / 3.0).sqrt());
            assert!((ratio - 1.0).abs() < 0.15, "{m} s: {ratio}");
        }
    }

    #[test]
    fn turn_on_is_constant_in_a_run_and_new_for_every_seed() {
        let drift = Drift {
            turn_on_sigma: 2.0,
            ..Drift::default()
        };
        let constants: Vec<f64> = (0..2000)
            .map(|seed| {
                let values = values(&drift, seed, 3);
                assert!(values[0] == values[1] && values[1] == values[2]);
                values[0]
            })
            .collect();
        let square: f64 = constants.iter().map(|c| c * c).sum();
        let sigma = (square / 2000.0).sqrt();
        assert!((sigma / 2.0 - 1.0).abs() < 0.06, "{sigma}");
    }

    #[test]
    fn runs_at_any_rate_have_the_same_drift() {
        let drift = Drift {
            turn_on_sigma: 1.0,
            bias_instability: 1.0,
            rate_random_walk: 0.1,
        };
        let (mut coarse, mut fine) = (DriftState::new(&drift, 3, 1), DriftState::new(&drift, 3, 1));
        for i in 0..4000 {
            let time_s = f64::from(i) * 0.25;
            let value = fine.at(time_s);
            if i % 50 == 0 {
                assert_eq!(coarse.at(time_s), value);
            }
        }
    }

    #[test]
    fn without_drift_the_bias_is_left_alone() {
        assert!(values(&Drift::default(), 1, 100).iter().all(|v| *v == 0.0));
    }
}
