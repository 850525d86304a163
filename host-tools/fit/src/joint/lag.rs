//! The lag shift: the filter's time constant and kappa, by variable projection.

use tempco::{TableError, ThermalSettings};

use crate::joint::basis::{Basis, SparseRow};
use crate::joint::blocks::Blocks;
use crate::joint::folds::Folds;
use crate::joint::gram::Gram;
use crate::regress::ChannelData;

/// Shifts that are tried.
pub(crate) const KAPPA_RANGE: (f64, f64) = (0.0, 1.3);

/// Time constants that are tried \[s\].
pub(crate) const TAU_RANGE_S: (f64, f64) = (30.0, 2400.0);

/// Time constants of the first pass; neighbours are a factor of 1.44 apart.
const GRID: usize = 13;

/// Golden sections of kappa; the last interval is 1 % of the range.
const KAPPA_STEPS: usize = 10;

/// Golden sections of log tau between the neighbours of the best grid point.
const TAU_STEPS: usize = 5;

/// A time constant with its shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lag {
    pub(crate) tau_s: f64,
    pub(crate) kappa: f64,
}

/// What the caller has fixed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FixedLag {
    pub(crate) tau_s: Option<f64>,
    pub(crate) kappa: Option<f64>,
}

/// Temperatures and rates of the blocks at one time constant.
#[derive(Clone, Debug)]
pub(crate) struct Regressors<'a> {
    temp_c: &'a [f64],
    rates: Vec<f64>,
    tau_s: f64,
}

impl<'a> Regressors<'a> {
    pub(crate) fn new(
        blocks: &'a Blocks,
        data: &ChannelData,
        settings: &ThermalSettings,
        tau_s: f64,
    ) -> Result<Self, TableError> {
        Ok(Self {
            temp_c: &blocks.temp_c,
            rates: blocks.rates(data, settings, tau_s)?,
            tau_s,
        })
    }

    pub(crate) fn tau_s(&self) -> f64 {
        self.tau_s
    }

    pub(crate) fn rates(&self) -> &[f64] {
        &self.rates
    }

    /// Effective temperature of a block: linear in kappa, as in the core.
    pub(crate) fn effective_c(&self, block: usize, kappa: f64) -> f64 {
        self.temp_c[block] - kappa * self.tau_s / 60.0 * self.rates[block]
    }

    /// Lowest and highest effective temperature.
    pub(crate) fn range_c(&self, kappa: f64) -> (f64, f64) {
        let count = self.rates.len();
        let temps: Vec<f64> = (0..count).map(|i| self.effective_c(i, kappa)).collect();
        Blocks::range(&temps)
    }

    /// The normal equations of each fold.
    pub(crate) fn grams(
        &self,
        blocks: &Blocks,
        folds: &Folds,
        basis: &Basis,
        kappa: f64,
    ) -> Vec<Gram> {
        let mut grams = vec![Gram::new(basis.columns(), blocks.axes()); folds.count];
        let mut row = SparseRow::new();
        for (i, block) in blocks.blocks.iter().enumerate() {
            basis.row(block.log, self.effective_c(i, kappa), self.rates[i], &mut row);
            grams[folds.of_block[i]].push(&row, blocks.observations(i), block.weight);
        }
        grams
    }
}

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

/// Searches tau and kappa of least residual; the coefficients are eliminated at every step.
///
/// `layout` makes the basis over a range of effective temperatures.
pub(crate) fn search(
    data: &ChannelData,
    blocks: &Blocks,
    settings: &ThermalSettings,
    fixed: FixedLag,
    layout: &dyn Fn((f64, f64)) -> Basis,
) -> Result<Lag, TableError> {
    let whole = Folds {
        of_block: vec![0; blocks.blocks.len()],
        count: 1,
        legs: 1,
    };
    let best_kappa = |tau_s: f64| -> Result<(f64, f64), TableError> {
        let regressors = Regressors::new(blocks, data, settings, tau_s)?;
        let cost = |kappa: f64| {
            let basis = layout(regressors.range_c(kappa));
            let grams = regressors.grams(blocks, &whole, &basis, kappa);
            log_likelihood(&grams[0], blocks.axes())
        };
        Ok(match fixed.kappa {
            Some(kappa) => (kappa, cost(kappa)),
            None => golden(KAPPA_RANGE, KAPPA_STEPS, cost),
        })
    };
    if let Some(tau_s) = fixed.tau_s {
        let (kappa, _) = best_kappa(tau_s)?;
        return Ok(Lag { tau_s, kappa });
    }
    // A filter must see several rows per time constant.
    let slowest = data.logs.iter().map(|log| log.interval_s).fold(0.0, f64::max);
    let (low, high) = TAU_RANGE_S;
    let low = (4.0 * slowest).clamp(low, high);
    let tau_at = |x: f64| low * (high / low).powf(x);
    let mut tried = Vec::with_capacity(GRID);
    for step in 0..GRID {
        let x = step as f64 / (GRID - 1) as f64;
        let (kappa, cost) = best_kappa(tau_at(x))?;
        tried.push((cost, x, kappa));
    }
    let best = tried.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0));
    let (cost, x, kappa) = best.unwrap_or((f64::INFINITY, 0.0, 0.0));
    let step = 1.0 / (GRID - 1) as f64;
    let mut failed = None;
    let around = ((x - step).max(0.0), (x + step).min(1.0));
    let (refined, refined_cost) = golden(around, TAU_STEPS, |x| {
        best_kappa(tau_at(x)).map_or_else(
            |error| {
                failed = Some(error);
                f64::INFINITY
            },
            |(_, cost)| cost,
        )
    });
    if let Some(error) = failed {
        return Err(error);
    }
    if refined_cost < cost {
        let tau_s = tau_at(refined);
        let (kappa, _) = best_kappa(tau_s)?;
        return Ok(Lag { tau_s, kappa });
    }
    Ok(Lag {
        tau_s: tau_at(x),
        kappa,
    })
}

/// The least of a function with one minimum, and its value; the ends are tried as well.
fn golden((low, high): (f64, f64), steps: usize, mut cost: impl FnMut(f64) -> f64) -> (f64, f64) {
    const RATIO: f64 = 0.618_033_988_749_894_8;
    let mut best = (low, cost(low));
    let mut note = |x: f64, value: f64| {
        if value < best.1 {
            best = (x, value);
        }
    };
    note(high, cost(high));
    let (mut from, mut to) = (low, high);
    let (mut a, mut b) = (to - RATIO * (to - from), from + RATIO * (to - from));
    let (mut at_a, mut at_b) = (cost(a), cost(b));
    for _ in 0..steps {
        note(a, at_a);
        note(b, at_b);
        if at_a < at_b {
            (to, b, at_b) = (b, a, at_a);
            a = to - RATIO * (to - from);
            at_a = cost(a);
        } else {
            (from, a, at_a) = (a, b, at_b);
            b = from + RATIO * (to - from);
            at_b = cost(b);
        }
    }
    note(a, at_a);
    note(b, at_b);
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_sections_find_a_minimum_inside_and_at_the_ends() {
        for (minimum, expected) in [(0.7, 0.7), (-1.0, 0.0), (3.0, 1.3)] {
            let (x, _) = golden(KAPPA_RANGE, 14, |x| (x - minimum).powi(2));
            assert!((x - expected).abs() < 2e-3, "{x} for {minimum}");
        }
    }
}
