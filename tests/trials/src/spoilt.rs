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

/// What is put into a log.
#[derive(Clone, Copy)]
pub(crate) enum Disturbance {
    /// Single rows far off.
    Outliers,
    /// Ten minutes off.
    Glitch,
}

/// Adds a disturbance to every axis of a run. All of it is upwards: it would not cancel.
pub(crate) fn spoil(run: &mut Run, disturbance: Disturbance, seed: u64) {
    let mut random = Random::new(seed);
    let duration_s = run.log.time_s[run.log.rows() - 1];
    let begin_s = (0.1 + 0.8 * random.uniform()) * duration_s;
    let glitch_s = begin_s..begin_s + GLITCH_S;
    let Run { log, .. } = run;
    for axis in &mut log.channels[0].axes {
        let sigma = row_noise(axis);
        for (raw, time_s) in axis.raw.iter_mut().zip(&log.time_s) {
            let sigmas = match disturbance {
                Disturbance::Outliers if random.uniform() < OUTLIERS => OUTLIER_SIGMAS,
                Disturbance::Glitch if glitch_s.contains(time_s) => GLITCH_SIGMAS,
                _ => 0.0,
            };
            *raw += sigmas * sigma;
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
    fn one_row_in_a_hundred_or_ten_minutes_are_spoilt() {
        let unit = Unit::named("smooth").unwrap();
        let profile = Profile::named("short").unwrap();
        let clean = Run::simulate(&unit, &profile, 1).unwrap();
        let spoilt = |disturbance| {
            let mut spoilt = clean.clone();
            spoil(&mut spoilt, disturbance, 1);
            let [clean, spoilt] = [&clean, &spoilt].map(|run| &run.log.channels[0].axes[0]);
            let sigma = row_noise(clean);
            let rows = spoilt.raw.iter().zip(&clean.raw);
            let added = rows.map(|(spoilt, clean)| (spoilt - clean) / sigma);
            added.collect::<Vec<f64>>()
        };
        let count =
            |added: &[f64], size: f64| added.iter().filter(|of| (*of - size).abs() < 1e-6).count();
        let outliers = spoilt(Disturbance::Outliers);
        let (many, others) = (count(&outliers, OUTLIER_SIGMAS), count(&outliers, 0.0));
        assert!((30..=85).contains(&many), "{many}");
        assert_eq!(many + others, outliers.len());
        let glitch = spoilt(Disturbance::Glitch);
        assert_eq!(count(&glitch, GLITCH_SIGMAS), 600);
        assert_eq!(600 + count(&glitch, 0.0), glitch.len());
    }
}
