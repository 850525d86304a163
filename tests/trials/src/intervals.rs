//! Coverage: how often the 95 % intervals of a fit hold the truth.
//!
//! The truth is a table, evaluated at what the core computes from the temperatures, so that the
//! model fits but for the noise. Each replica has other noise.

use anyhow::Result;
use serde::Serialize;
use tempco::{Terms, Thermal, ThermalSettings};
use tempco_fit::{FitOptions, Method, PlanOptions, fit};
use tempco_log::{Log, parallel};
use tempco_set::run::thermal_points;
use tempco_set::{AxisSet, CoefficientSigmas, Polynomial};
use tempco_twin::{Profile, Unit};

use crate::random::Random;
use crate::run::Run;
use crate::table;

/// Half width of a 95 % interval, in standard deviations.
const SIGMAS: f64 = 1.959_964;

/// Static part of the truth, lowest power of degC first.
const STATIC: [f64; Terms::STATIC] = [1.0, 0.02, -3e-4];

/// Rate part of the truth, lowest power of degC first \[per degC/min\].
const RATE: [f64; Terms::RATE] = [0.3, 0.002];

/// White noise of a row.
const WHITE: f64 = 0.02;

/// Growth of the random walk from row to row.
const WALK: f64 = 0.001;

/// Time between rows \[s\].
const INTERVAL_S: f64 = 10.0;

/// Where the static bias of a segment is looked at, from its cold end -1 to its hot end 1.
const PLACES: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];

/// What is estimated, in the order of [`Counts`].
const ESTIMATES: [&str; 4] = ["static bias", "a", "r", "gains"];

/// How many intervals of each of [`ESTIMATES`] hold the truth, and of how many.
type Counts = [(u32, u32); ESTIMATES.len()];

/// The share of intervals that hold the truth.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Share {
    noise: &'static str,
    estimate: &'static str,
    intervals: u32,
    share: f64,
}

/// Fits replicas under white noise, with and without a random walk.
///
/// # Errors
/// The errors of the fit.
pub(crate) fn coverage(replicas: u64) -> Result<Vec<Share>> {
    let mut shares = Vec::new();
    for (noise, walk) in [("white", 0.0), ("white and walk", WALK)] {
        let counts = counts(replicas, walk)?;
        shares.extend(
            ESTIMATES
                .iter()
                .zip(counts)
                .map(|(estimate, (inside, all))| Share {
                    noise,
                    estimate,
                    intervals: all,
                    share: f64::from(inside) / f64::from(all),
                }),
        );
    }
    // Gains of terms that were not fitted have no intervals.
    shares.retain(|of| of.intervals > 0);
    Ok(shares)
}

/// Prints the shares.
pub(crate) fn print(shares: &[Share]) {
    let row = |of: &Share| {
        let (noise, estimate) = (of.noise.to_owned(), of.estimate.to_owned());
        let share = format!("{:.1} %", 100.0 * of.share);
        [noise, estimate, of.intervals.to_string(), share]
    };
    table::print(
        "95 % intervals that hold the truth",
        ["noise", "estimate", "intervals", "share"],
        &shares.iter().map(row).collect::<Vec<_>>(),
    );
}

fn counts(replicas: u64, walk: f64) -> Result<Counts> {
    let options = options();
    let log = exact(&options.plan.thermal)?;
    let seeds: Vec<u64> = (1..=replicas).collect();
    let of_replicas = parallel::map(&seeds, |&seed| {
        let log = noisy(&log, seed, walk);
        let set = fit(std::slice::from_ref(&log), &options)?.set;
        Ok::<_, anyhow::Error>(of_axis(&set.channels[0].axes[0]))
    });
    let mut sum = Counts::default();
    for of_replica in of_replicas {
        for (sum, count) in sum.iter_mut().zip(of_replica?) {
            sum.0 += count.0;
            sum.1 += count.1;
        }
    }
    Ok(sum)
}

/// Intervals are of a given model: nothing is searched.
fn options() -> FitOptions {
    let thermal = ThermalSettings {
        tau_s: 120.0,
        kappa: 0.5,
        rate_min_c_per_min: -50.0,
        rate_max_c_per_min: 50.0,
        ..ThermalSettings::DEFAULT
    };
    FitOptions {
        plan: PlanOptions {
            thermal,
            ..PlanOptions::default()
        },
        ..FitOptions::new("TRIAL", Method::AUTO)
    }
}

/// A log of one axis whose rows are the truth.
fn exact(settings: &ThermalSettings) -> Result<Log> {
    let (unit, profile) = (Unit::named("smooth")?, Profile::named("verification")?);
    let mut log = Run::at_rate(&unit, &profile, 1, 1.0 / INTERVAL_S)?.log;
    let points = thermal_points(&log, 0, &Thermal::new(*settings)?);
    let rows = points.iter().map(|point| {
        let (u, rate) = (
            f64::from(point.effective_c),
            f64::from(point.rate_c_per_min),
        );
        polynomial(&STATIC, u) + rate * polynomial(&RATE, u)
    });
    let axes = &mut log.channels[0].axes;
    axes.truncate(1);
    axes[0].raw = rows.collect();
    Ok(log)
}

fn noisy(log: &Log, seed: u64, walk: f64) -> Log {
    let (mut log, mut random, mut walked) = (log.clone(), Random::new(seed), 0.0);
    for raw in &mut log.channels[0].axes[0].raw {
        walked += walk * random.normal();
        *raw += walked + WHITE * random.normal();
    }
    log
}

/// Counts the intervals of a fitted axis.
fn of_axis(axis: &AxisSet) -> Counts {
    let mut counts = Counts::default();
    let mut count = |estimate: usize, error: f64, sigma: f64| {
        if sigma > 0.0 {
            counts[estimate].0 += u32::from(error.abs() < SIGMAS * sigma);
            counts[estimate].1 += 1;
        }
    };
    for (found, sigmas) in axis.polynomials.iter().zip(&axis.sigmas) {
        let truth = truth(found);
        for z in PLACES {
            let error = polynomial(&found.a, z) - polynomial(&truth.a, z);
            count(0, error, static_sigma(sigmas, z));
        }
        for ((found, truth), sigma) in found.a.iter().zip(&truth.a).zip(sigmas.a) {
            count(1, found - truth, sigma);
        }
        for ((found, truth), sigma) in found.r.iter().zip(&truth.r).zip(sigmas.r) {
            count(2, found - truth, sigma);
        }
    }
    for gain in &axis.gains {
        count(3, gain.gain, gain.sigma);
    }
    counts
}

/// The truth over the segment of `found`.
fn truth(found: &Polynomial) -> Polynomial {
    let (c, h) = (found.centre_c, found.half_width_c);
    let ([a0, a1, a2], [r0, r1]) = (STATIC, RATE);
    Polynomial {
        a: [a0 + c * (a1 + c * a2), h * (a1 + 2.0 * c * a2), h * h * a2],
        r: [r0 + c * r1, h * r1],
        s: [0.0; Terms::LAG],
        ..*found
    }
}

/// Standard deviation of the static bias at place `z` of a segment.
fn static_sigma(sigmas: &CoefficientSigmas, z: f64) -> f64 {
    let terms = [1.0, z, z * z];
    let mut variance = 0.0;
    for i in 0..Terms::STATIC {
        for j in 0..Terms::STATIC {
            let covariance = sigmas.correlation[i][j] * sigmas.a[i] * sigmas.a[j];
            variance += terms[i] * covariance * terms[j];
        }
    }
    variance.max(0.0).sqrt()
}

/// A polynomial by its coefficients, lowest power first.
fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients
        .iter()
        .rev()
        .fold(0.0, |sum, coefficient| sum * x + coefficient)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_noise_the_truth_is_found() {
        let mut options = options();
        options.plan.robust = false;
        let log = exact(&options.plan.thermal).unwrap();
        let set = fit(std::slice::from_ref(&log), &options).unwrap().set;
        for found in &set.channels[0].axes[0].polynomials {
            let truth = truth(found);
            for (found, truth) in found.coefficients().iter().zip(truth.coefficients()) {
                // Ridges pull a little, less than any noise.
                assert!((found - truth).abs() < 1e-4, "{found} {truth}");
            }
        }
    }

    #[test]
    fn the_static_bias_takes_correlations_into_account() {
        let mut sigmas = CoefficientSigmas::new(&[3.0, 4.0, 0.0], &[]);
        sigmas.correlation[0][0] = 1.0;
        sigmas.correlation[1][1] = 1.0;
        assert_eq!(static_sigma(&sigmas, 1.0), 5.0);
        sigmas.correlation[0][1] = -1.0;
        sigmas.correlation[1][0] = -1.0;
        assert_eq!(static_sigma(&sigmas, 1.0), 1.0);
        assert_eq!(static_sigma(&sigmas, -1.0), 7.0);
    }

    /// Intervals that are half as wide hold the truth as often as one standard deviation does.
    #[test]
    fn narrow_intervals_are_caught() {
        let options = options();
        let exact = exact(&options.plan.thermal).unwrap();
        let seeds: Vec<u64> = (1..=20).collect();
        let counts = parallel::map(&seeds, |&seed| {
            let log = noisy(&exact, seed, 0.0);
            let set = fit(std::slice::from_ref(&log), &options).unwrap().set;
            let mut axis = set.channels[0].axes[0].clone();
            axis.sigmas.iter_mut().for_each(|sigmas| sigmas.scale(0.5));
            of_axis(&axis)
        });
        let (mut inside, mut all) = (0, 0);
        for (of_these, of_all) in counts.iter().flatten() {
            inside += of_these;
            all += of_all;
        }
        let share = f64::from(inside) / f64::from(all);
        assert!((0.55..0.85).contains(&share), "{share}");
    }
}
