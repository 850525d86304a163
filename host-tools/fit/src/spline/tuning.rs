//! A model at some lags, with the noise and ridges that make the logs most likely.

use crate::least_squares::{Basis, Blocks, SparseRow};
use crate::spline::drift::{DriftLimits, LN_ANGLE, LN_WALK_PER_S};
use crate::spline::evidence::{Posterior, posterior, tune};
use crate::spline::lags::Lags;
use crate::spline::lowest::lowest_exp;
use crate::spline::ridges::Ridges;
use crate::spline::sensor_noise::SensorNoise;
use crate::spline::whitening::{NoiseShares, Whitening};

/// Steps of the search for each number of the noise, and rounds over all of them.
const NOISE_STEPS: usize = 5;
const NOISE_ROUNDS: usize = 2;

/// The same once it was found: so far on both sides, in logarithms, and so many steps.
const NEAR: f64 = 1.2;
const FEW_NOISE_STEPS: usize = 1;

/// Share of the sensor's noise in whitened temperatures. Least squares takes it for temperature,
/// and makes every coefficient smaller by this share.
const MOST_SENSOR_NOISE: f64 = 0.01;

/// Rounds of the ridges.
const TUNING: usize = 25;

/// Noise and ridges of an axis.
#[derive(Clone, Debug)]
pub(crate) struct AxisPriors {
    pub(crate) noise: NoiseShares,
    pub(crate) limits: DriftLimits,
    /// Whether `noise` was searched over its whole range.
    pub(crate) is_tuned: bool,
    pub(crate) precisions: Vec<f64>,
}

/// A model at some lags.
pub(crate) struct Trial {
    pub(crate) lags: Lags,
    pub(crate) basis: Basis,
    pub(crate) ridges: Ridges,
    pub(crate) rows: Vec<SparseRow>,
    /// By axis.
    pub(crate) priors: Vec<AxisPriors>,
    pub(crate) posteriors: Vec<Posterior>,
    /// Sum over the axes.
    pub(crate) deviance: f64,
}

/// What is known of an axis if its drift is as fast as the logs and late soaks together allow, with
/// ridges and all other noise as they are; the noise with it. `known` is what is known under `priors`.
pub(crate) fn with_possible_drift(
    blocks: &Blocks,
    trial: &Trial,
    axis: usize,
    priors: &AxisPriors,
    known: Posterior,
) -> (NoiseShares, Posterior) {
    let (columns, ridges) = (trial.basis.columns(), &trial.ridges);
    let now = priors.noise.walk_per_s;
    let mut best = (priors.noise, known);
    let cost = |walk_per_s: f64| {
        let noise = NoiseShares {
            walk_per_s,
            ..priors.noise
        };
        let whitening = Whitening::new(blocks, noise, |_| true);
        let products = whitening.products(&trial.rows, columns, &blocks.raw[axis]);
        let found = posterior(&products, &ridges.groups, &priors.precisions, ridges.free);
        let deviance = found.as_ref().map_or(f64::INFINITY, |of| of.deviance);
        if let Some(found) = found.filter(|_| deviance < best.1.deviance) {
            best = (noise, found);
        }
        deviance
    };
    let most = priors.limits.possible_walk_per_s;
    if now < most {
        lowest_exp((libm::log(now), libm::log(most)), NOISE_STEPS, cost);
    }
    best
}

/// An axis with the most likely noise and ridges.
pub(crate) fn tuned_axis(
    blocks: &Blocks,
    sensor: &SensorNoise,
    trial: &Trial,
    axis: usize,
) -> Option<(AxisPriors, Posterior)> {
    let columns = trial.basis.columns();
    let (groups, free) = (&trial.ridges.groups, trial.ridges.free);
    let from = &trial.priors[axis];
    let mut best: Option<(AxisPriors, Posterior)> = None;
    // A division coarser than the search's has other groups.
    let mut precisions = match from.precisions.len() == groups.len() {
        true => from.precisions.clone(),
        false => {
            let whitening = Whitening::new(blocks, from.noise, |_| true);
            let products = whitening.products(&trial.rows, columns, &blocks.raw[axis]);
            groups.iter().map(|of| of.even(&products)).collect()
        }
    };
    let mut cost = |noise: NoiseShares| {
        let whitening = Whitening::new(blocks, noise, |_| true);
        // Temperatures whose noise would bend the curve are not looked at so closely.
        let share = whitening.share_of_noise(&sensor.temp_c, sensor.variance);
        if share > MOST_SENSOR_NOISE && noise != from.noise {
            return f64::INFINITY;
        }
        let products = whitening.products(&trial.rows, columns, &blocks.raw[axis]);
        let Some(found) = tune(&products, groups, &mut precisions, free, TUNING) else {
            return f64::INFINITY;
        };
        let deviance = found.deviance;
        if best.as_ref().is_none_or(|(_, of)| deviance < of.deviance) {
            let precisions = precisions.clone();
            let priors = AxisPriors {
                noise,
                precisions,
                is_tuned: true,
                ..*from
            };
            best = Some((priors, found));
        }
        deviance
    };
    // One after the other: short and long times say which is which. What is nearly known is looked
    // for nearby.
    let mut noise = from.noise;
    cost(noise);
    let walks = (LN_WALK_PER_S.0, libm::log(from.limits.most_walk_per_s));
    let near = |range: (f64, f64), now: f64| match from.is_tuned {
        true => {
            let now = libm::log(now).clamp(range.0, range.1);
            ((now - NEAR).max(range.0), (now + NEAR).min(range.1))
        }
        false => range,
    };
    let (rounds, steps) = if from.is_tuned {
        (1, FEW_NOISE_STEPS)
    } else {
        (NOISE_ROUNDS, NOISE_STEPS)
    };
    for _ in 0..rounds {
        let angles = near(LN_ANGLE, noise.angle);
        noise.angle = lowest_exp(angles, steps, |angle| cost(NoiseShares { angle, ..noise }));
        let walks = near(walks, noise.walk_per_s);
        noise.walk_per_s = lowest_exp(walks, steps, |walk_per_s| {
            cost(NoiseShares {
                walk_per_s,
                ..noise
            })
        });
    }
    best
}
