//! Disturbances that are put into a log: outliers and a glitch.

use tempco_log::Axis;

use crate::random::Random;
use crate::run::Run;

/// Share of the rows that become outliers.
const OUTLIERS: f64 = 0.01;

/// Their size, in standard deviations of the noise of a row.
const OUTLIER_SIGMAS: f64 = 30.0;

/// Length of the glitch \[s\].
const GLITCH_S: f64 = 600.0;

/// Its size, in standard deviations of the noise of a row.
const GLITCH_SIGMAS: f64 = 20.0;

/// Adds outliers and a glitch to every axis of a run. All are upwards: they would not cancel.
pub(crate) fn spoil(run: &mut Run, seed: u64) {
    let mut random = Random::new(seed);
    let duration_s = run.log.time_s[run.log.rows() - 1];
    let begin_s = (0.1 + 0.8 * random.uniform()) * duration_s;
    let glitch_s = begin_s..begin_s + GLITCH_S;
    let time_s = run.log.time_s.clone();
    for axis in &mut run.channel_mut().axes {
        let sigma = row_noise(axis);
        for (raw, time_s) in axis.raw.iter_mut().zip(&time_s) {
            if random.uniform() < OUTLIERS {
                *raw += OUTLIER_SIGMAS * sigma;
            }
            if glitch_s.contains(time_s) {
                *raw += GLITCH_SIGMAS * sigma;
            }
        }
    }
}

/// Standard deviation of the noise of a row, from the differences of neighbours.
fn row_noise(axis: &Axis) -> f64 {
    let pairs = axis.raw.windows(2);
    let squares: f64 = pairs.map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    (0.5 * squares / (axis.raw.len() - 1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use tempco_twin::{Profile, Unit};

    use super::*;

    #[test]
    fn one_row_in_a_hundred_and_ten_minutes_are_spoilt() {
        let unit = Unit::named("smooth").unwrap();
        let profile = Profile::named("short").unwrap();
        let clean = Run::simulate(&unit, &profile, 1).unwrap();
        let mut spoilt = clean.clone();
        spoil(&mut spoilt, 1);
        let [clean, spoilt] = [&clean, &spoilt].map(|run| &run.log.channels[0].axes[0]);
        let sigma = row_noise(clean);
        let added = spoilt
            .raw
            .iter()
            .zip(&clean.raw)
            .map(|(a, b)| (a - b) / sigma);
        let added: Vec<f64> = added.collect();
        let count = |size: f64| added.iter().filter(|of| (*of - size).abs() < 1e-6).count();
        let (outliers, glitch, both) = (count(30.0), count(20.0), count(50.0));
        assert!((25..=85).contains(&outliers), "{outliers}");
        assert_eq!(glitch + both, 600);
        assert_eq!(outliers + 600 + count(0.0), added.len());
    }
}
