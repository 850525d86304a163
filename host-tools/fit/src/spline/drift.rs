//! How much of what a model leaves may pass for drift: what late soaks show, in which no model has
//! anything to do.
//!
//! What a model leaves in ramps looks like a drift. Least squares that follows it looks at short
//! times alone, where the errors of model and sensor are. So drift is bounded by late soaks. A drift
//! that forgets within minutes there (flicker) is not followed at all: over the times in which
//! temperatures change it is white, and only makes the noise larger.

use std::ops::Range;

use libm::log;
use tempco_log::parallel;

use crate::least_squares::{Block, Blocks, SparseRow};
use crate::spline::evidence::posterior;
use crate::spline::folds::SOAK_C_PER_MIN;
use crate::spline::lowest::lowest_exp;
use crate::spline::whitening::{NoiseShares, Whitening};

/// A drift that forgets this slowly is a random walk \[s\].
pub(crate) const FOREVER_S: f64 = 1e6;

/// Shorter drift times need late soaks \[s\], down to the shortest that is tried.
const SHORT_S: f64 = 3000.0;
const SHORTEST_S: f64 = 60.0;

/// How much more likely the late soaks must be with a short one, as -2 ln L.
const LEAST_GAIN: f64 = 20.0;

/// Late soaks know the drift to this factor, and not below this growth of its variance \[1/s\].
const MARGIN: f64 = 2.0;
const LEAST_LIMIT_PER_S: f64 = 1e-6;

/// A drift is possible if late soaks are less likely with it by no more than this, as -2 ln L: two
/// standard deviations.
const MOST_RISE: f64 = 4.0;
const LIMIT_STEPS: usize = 12;

/// A soak is late after this time \[s\].
const LATE_S: f64 = 600.0;

/// Noise that a search starts with, and the logarithms of what it tries, one after the other.
pub(crate) const START_NOISE: NoiseShares = NoiseShares {
    walk_per_s: 1e-6,
    drift_s: FOREVER_S,
    angle: 0.3,
};
pub(crate) const LN_WALK_PER_S: (f64, f64) = (-23.0, -2.3);
pub(crate) const LN_ANGLE: (f64, f64) = (-6.0, 6.0);
const STEPS: usize = 8;
const ROUNDS: usize = 3;

/// A shorter stretch says nothing \[s\].
const LEAST_S: f64 = 200.0;

/// What late soaks allow of the drift of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DriftLimits {
    /// Fastest growth of the variance that coefficients are to follow \[1/s\].
    pub(crate) most_walk_per_s: f64,
    /// Fastest growth that is possible: standard errors are to allow for it \[1/s\].
    pub(crate) possible_walk_per_s: f64,
    /// How many times as large the variance of what forgets makes the white noise over long times.
    pub(crate) inflation: f64,
}

/// The limits of each axis.
pub(crate) fn limits(blocks: &Blocks) -> Vec<DriftLimits> {
    let soaks = late_soaks(blocks);
    let unknown = DriftLimits {
        most_walk_per_s: LEAST_LIMIT_PER_S,
        possible_walk_per_s: LEAST_LIMIT_PER_S,
        inflation: 1.0,
    };
    if soaks.is_empty() {
        return vec![unknown; blocks.axes()];
    }
    let late = blocks.stretches(&soaks);
    let axes: Vec<usize> = (0..blocks.axes()).collect();
    parallel::map(&axes, |&axis| {
        let deviance = deviance_of(&late, axis);
        let (long, noise) = best(&deviance, (FOREVER_S, FOREVER_S));
        let (short, forgets) = best(&deviance, (SHORTEST_S, SHORT_S));
        if long - short > LEAST_GAIN {
            let slow = forgets.walk_per_s * forgets.drift_s.powi(2) / late.step_s();
            return DriftLimits {
                inflation: 1.0 + slow,
                ..unknown
            };
        }
        DriftLimits {
            most_walk_per_s: (MARGIN * noise.walk_per_s).max(LEAST_LIMIT_PER_S),
            possible_walk_per_s: possible_walk_per_s(&deviance, (long, noise))
                .max(LEAST_LIMIT_PER_S),
            ..unknown
        }
    })
}

/// Stretches of blocks in which the temperature has been still for long.
fn late_soaks(blocks: &Blocks) -> Vec<Range<usize>> {
    let numbers: Vec<usize> = (0..blocks.blocks.len()).collect();
    let rates = blocks.slow_rates();
    let kind = |i: usize| (blocks.blocks[i].log, rates[i].abs() < SOAK_C_PER_MIN);
    let stretches = numbers.chunk_by(|&a, &b| kind(a) == kind(b));
    let late = stretches.filter(|stretch| kind(stretch[0]).1).map(|soak| {
        let time_s = |i: usize| blocks.blocks[i].time_s;
        let early = soak.partition_point(|&i| time_s(i) - time_s(soak[0]) < LATE_S);
        soak[0] + early..soak[0] + soak.len()
    });
    late.filter(|soak| soak.len() >= blocks.steps_in(LEAST_S))
        .collect()
}

/// The fastest drift that late soaks allow, if `noise` is the most likely one, with the `least`
/// deviance.
fn possible_walk_per_s(
    deviance: impl Fn(NoiseShares) -> f64,
    (least, noise): (f64, NoiseShares),
) -> f64 {
    let most = least + MOST_RISE;
    let (mut low, mut high) = (log(noise.walk_per_s), LN_WALK_PER_S.1);
    for _ in 0..LIMIT_STEPS {
        let middle = 0.5 * (low + high);
        let walk_per_s = libm::exp(middle);
        match deviance(NoiseShares {
            walk_per_s,
            ..noise
        }) <= most
        {
            true => low = middle,
            false => high = middle,
        }
    }
    libm::exp(low)
}

/// -2 ln L of late soaks, each about a constant of its own.
fn deviance_of(late: &Blocks, axis: usize) -> impl Fn(NoiseShares) -> f64 {
    let constant = |block: &Block| SparseRow::from([(block.log, 1.0)]);
    let rows: Vec<SparseRow> = late.blocks.iter().map(constant).collect();
    let soaks = late.logs();
    move |noise| {
        let whitening = Whitening::new(late, noise, |_| true);
        let products = whitening.products(&rows, soaks, &late.raw[axis]);
        posterior(&products, &[], &[], soaks).map_or(f64::INFINITY, |of| of.deviance)
    }
}

/// The least -2 ln L of late soaks with drift times within a range \[s\].
fn best(deviance: impl Fn(NoiseShares) -> f64, drift_s: (f64, f64)) -> (f64, NoiseShares) {
    let mut noise = NoiseShares {
        drift_s: drift_s.1,
        ..START_NOISE
    };
    let mut least = (f64::INFINITY, noise);
    for _ in 0..ROUNDS {
        let mut cost = |noise: NoiseShares| {
            let found = deviance(noise);
            if found < least.0 {
                least = (found, noise);
            }
            found
        };
        noise.angle = lowest_exp(LN_ANGLE, STEPS, |angle| {
            cost(NoiseShares { angle, ..noise })
        });
        let ln_drift_s = (log(drift_s.0), log(drift_s.1));
        noise.drift_s = lowest_exp(ln_drift_s, STEPS, |drift_s| {
            cost(NoiseShares { drift_s, ..noise })
        });
        noise.walk_per_s = lowest_exp(LN_WALK_PER_S, STEPS, |walk_per_s| {
            cost(NoiseShares {
                walk_per_s,
                ..noise
            })
        });
    }
    least
}
