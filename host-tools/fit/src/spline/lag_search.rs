//! The lag shift: the filter's time constant and kappa, by variable projection.

use tempco::{TableError, ThermalSettings};

use crate::least_squares::{Basis, Blocks, Gram};
use crate::spline::folds::Folds;
use crate::spline::history_terms::{Shape, block_history};
use crate::spline::regressors::{FixedLag, Lag, Regressors};
use crate::summary::ChannelData;

/// Shifts that are tried.
pub(crate) const KAPPA_RANGE: (f64, f64) = (0.0, 1.3);

/// Time constants that are tried \[s\].
pub(crate) const TAU_RANGE_S: (f64, f64) = (30.0, 2400.0);

/// Time constants of the first pass; neighbours are a factor of 1.44 apart.
const GRID: usize = 13;

/// Parabolas through the three best shifts while time constants are compared, and at the end.
const KAPPA_STEPS: (usize, usize) = (1, 6);

/// The same for log tau, between the neighbours of the best grid point.
const TAU_STEPS: usize = 3;

/// How far a search near a time constant goes, as a factor.
const NEAR: f64 = 2.0;

/// Sum over the axes of the logarithm of the mean squared residual: independent of the units, and
/// the likelihood of axes with noise of their own.
pub(crate) fn log_likelihood(whole: &Gram, axes: usize) -> f64 {
    let Some(solution) = whole.solve() else {
        return f64::INFINITY;
    };
    (0..axes)
        .map(|axis| {
            let residual = whole.residual(axis, &solution[axis]) / whole.weight();
            residual.max(f64::MIN_POSITIVE).ln()
        })
        .sum()
}

/// What a search found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Found {
    pub(crate) best: Lag,
    /// The best of those without shift; `best` where the shift is given.
    pub(crate) unshifted: Lag,
}

/// The search for tau and kappa of least residual; the coefficients are eliminated at every step.
pub(crate) struct Search<'a> {
    pub(crate) data: &'a ChannelData<'a>,
    pub(crate) blocks: &'a Blocks,
    pub(crate) settings: &'a ThermalSettings,
    pub(crate) fixed: FixedLag,
    /// Makes the basis over a range of lag-compensated temperatures.
    pub(crate) layout: &'a dyn Fn((f64, f64)) -> Basis,
    /// History terms that go with it.
    pub(crate) shape: &'a Shape,
}

impl Search<'_> {
    /// Over all time constants.
    pub(crate) fn everywhere(&self) -> Result<Found, TableError> {
        let without = |tau_s: f64| Lag {
            tau_s,
            kappa: self.fixed.kappa.unwrap_or(0.0),
        };
        if let Some(tau_s) = self.fixed.tau_s {
            return Ok(Found {
                best: self.finest(tau_s)?,
                unshifted: without(tau_s),
            });
        }
        let (low, high) = self.tau_range_s();
        let tau_at = |x: f64| low * (high / low).powf(x);
        let step = 1.0 / (GRID - 1) as f64;
        let mut least = [(f64::INFINITY, 0.0); 2];
        let mut of_grid = Vec::with_capacity(GRID);
        for x in (0..GRID).map(|i| i as f64 * step) {
            let (unshifted, shifted) = self.costs_at(tau_at(x), KAPPA_STEPS.0)?;
            of_grid.push((x, shifted.value));
            for (least, cost) in least.iter_mut().zip([unshifted, shifted.value]) {
                if cost < least.0 {
                    *least = (cost, x);
                }
            }
        }
        let [(_, unshifted), (_, x)] = least;
        let around = ((x - step).max(0.0), (x + step).min(1.0));
        let best = lowest(around, TAU_STEPS, |x| {
            let known = of_grid.iter().find(|(at, _)| (at - x).abs() < 1e-9);
            if let Some(&(_, cost)) = known {
                return Ok(cost);
            }
            Ok(self.costs_at(tau_at(x), KAPPA_STEPS.0)?.1.value)
        })?;
        Ok(Found {
            best: self.finest(tau_at(best.x))?,
            unshifted: without(tau_at(unshifted)),
        })
    }

    /// Around a time constant, for a basis that is not far from the one it was found with.
    pub(crate) fn near(&self, tau_s: f64) -> Result<Lag, TableError> {
        if let Some(tau_s) = self.fixed.tau_s {
            return self.finest(tau_s);
        }
        let (low, high) = self.tau_range_s();
        let around = [tau_s / NEAR, tau_s * NEAR].map(|tau_s| tau_s.clamp(low, high).ln());
        let best = lowest((around[0], around[1]), TAU_STEPS, |x| {
            Ok(self.costs_at(x.exp(), KAPPA_STEPS.0)?.1.value)
        })?;
        self.finest(best.x.exp())
    }

    /// A filter must see several rows per time constant.
    fn tau_range_s(&self) -> (f64, f64) {
        let intervals = self.data.logs.iter().map(|log| log.interval_s);
        let (low, high) = TAU_RANGE_S;
        let low = (4.0 * intervals.fold(0.0, f64::max)).clamp(low, high);
        (low, high)
    }

    /// Cost without shift, and with the best one.
    fn costs_at(&self, tau_s: f64, steps: usize) -> Result<(f64, Lowest), TableError> {
        let regressors = Regressors::new(self.blocks, self.data, self.settings, tau_s)?;
        let whole = Folds::whole(self.blocks);
        let terms = self.shape.terms();
        let cost = |kappa: f64| {
            let basis = (self.layout)(regressors.range_c(kappa)).with_history(terms.len());
            let history = block_history(self.blocks, &regressors, kappa, &terms);
            let grams = regressors.grams(self.blocks, &whole, &basis, kappa, &history);
            log_likelihood(&grams[0], self.blocks.axes())
        };
        if let Some(kappa) = self.fixed.kappa {
            let at = cost(kappa);
            return Ok((
                at,
                Lowest {
                    x: kappa,
                    value: at,
                },
            ));
        }
        let mut unshifted = f64::INFINITY;
        let lowest = lowest(KAPPA_RANGE, steps, |kappa| {
            let at = cost(kappa);
            if kappa == 0.0 {
                unshifted = at;
            }
            Ok(at)
        })?;
        Ok((unshifted, lowest))
    }

    /// A time constant with its shift, to the last digit that matters.
    fn finest(&self, tau_s: f64) -> Result<Lag, TableError> {
        let (_, lowest) = self.costs_at(tau_s, KAPPA_STEPS.1)?;
        Ok(Lag {
            tau_s,
            kappa: lowest.x,
        })
    }
}

/// Where a function is lowest, and its value there.
#[derive(Clone, Copy, Debug)]
struct Lowest {
    x: f64,
    value: f64,
}

/// Looks for the lowest place of a smooth function by parabolas: both ends and the middle first,
/// then `steps` times the lowest place of the parabola through the best place and its neighbours.
fn lowest(
    (low, high): (f64, f64),
    steps: usize,
    mut cost: impl FnMut(f64) -> Result<f64, TableError>,
) -> Result<Lowest, TableError> {
    let mut tried: Vec<(f64, f64)> = Vec::new();
    for x in [low, 0.5 * (low + high), high] {
        tried.push((x, cost(x)?));
    }
    for _ in 0..steps {
        let best = position_of_lowest(&tried).clamp(1, tried.len() - 2);
        let [(x0, y0), (x1, y1), (x2, y2)] = [tried[best - 1], tried[best], tried[best + 1]];
        let (before, after) = ((x1 - x0) * (y1 - y2), (x1 - x2) * (y1 - y0));
        let vertex = x1 - 0.5 * ((x1 - x0) * before - (x1 - x2) * after) / (before - after);
        // Where the vertex adds nothing new, the middle of the wider side does.
        let apart = 0.01 * (x2 - x0);
        let near = |x: f64| [x0, x1, x2].iter().any(|known| (x - known).abs() < apart);
        let middle = if x1 - x0 > x2 - x1 {
            0.5 * (x0 + x1)
        } else {
            0.5 * (x1 + x2)
        };
        let inside = vertex > x0 && vertex < x2;
        let x = if inside && !near(vertex) {
            vertex
        } else {
            middle
        };
        let at = tried.partition_point(|&(known, _)| known < x);
        tried.insert(at, (x, cost(x)?));
    }
    let (x, value) = tried[position_of_lowest(&tried)];
    Ok(Lowest { x, value })
}

fn position_of_lowest(tried: &[(f64, f64)]) -> usize {
    let values = tried.iter().enumerate();
    values
        .min_by(|(_, a), (_, b)| a.1.total_cmp(&b.1))
        .map_or(0, |(position, _)| position)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabolas_find_a_minimum_inside_and_at_the_ends() {
        for (minimum, expected) in [(0.7, 0.7), (-1.0, 0.0), (3.0, 1.3)] {
            let found = lowest(KAPPA_RANGE, 6, |x| {
                Ok((x - minimum).powi(2) + 0.3 * (x - minimum).powi(4))
            });
            let x = found.unwrap().x;
            assert!((x - expected).abs() < 0.02, "{x} for {minimum}");
        }
    }
}
