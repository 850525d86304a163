//! The least squares of the spline model on the core's own points: what flies.

use nalgebra::{DMatrix, DVector};
use tempco::ThermalPoint;

use crate::least_squares::{Basis, Block, Blocks, SamplePoints, SparseRow, dot};
use crate::spline::evidence::{in_use, posterior};
use crate::spline::folds::Folds;
use crate::spline::held_out::HeldOut;
use crate::spline::ridges::of_basis;
use crate::spline::sensor_noise::SensorNoise;
use crate::spline::tuning::{AxisPriors, Trial, tuned_axis, with_possible_drift};
use crate::spline::whitening::Whitening;

/// The coefficients of an axis, how well they are known, and the noise that remains.
pub(crate) struct AxisSolution {
    /// 0 in columns that explain nothing.
    pub(crate) coefficients: Vec<f64>,
    pub(crate) covariance: DMatrix<f64>,
    /// Variance of a block of usual weight.
    pub(crate) white: f64,
    /// Growth of the variance of the walk, per second.
    pub(crate) walk: f64,
    priors: AxisPriors,
    /// By column, whether it is in use.
    used: Vec<bool>,
}

/// The model on the core's points at the lags that were found.
pub(crate) struct Deployed {
    pub(crate) basis: Basis,
    rows: Vec<SparseRow>,
    pub(crate) axes: Vec<AxisSolution>,
}

impl Deployed {
    /// `None` where no coefficients can be found.
    pub(crate) fn fit(
        points: &SamplePoints,
        blocks: &Blocks,
        sensor: &SensorNoise,
        basis: Basis,
        (found, spread): (Trial, &[DMatrix<f64>]),
    ) -> Option<Self> {
        let rows = rows(points, blocks, &basis);
        let trial = Trial {
            ridges: of_basis(&basis),
            basis,
            rows,
            ..found
        };
        let axes =
            (0..blocks.axes()).map(|axis| solve(blocks, sensor, &trial, axis, &spread[axis]));
        Some(Self {
            axes: axes.collect::<Option<_>>()?,
            basis: trial.basis,
            rows: trial.rows,
        })
    }

    /// Its errors on the folds, each left out in turn; lags, ridges and noise stay.
    pub(crate) fn held_out(&self, blocks: &Blocks, folds: &Folds) -> Option<HeldOut> {
        let ridges = of_basis(&self.basis);
        let mut errors = vec![vec![0.0; blocks.blocks.len()]; blocks.axes()];
        for (axis, of_axis) in self.axes.iter().enumerate() {
            for fold in 0..folds.count {
                let is_used = |block: usize| folds.of_block[block] != fold;
                let whitening = Whitening::new(blocks, of_axis.priors.noise, is_used);
                let columns = self.basis.columns();
                let products = whitening.products(&self.rows, columns, &blocks.raw[axis]);
                let precisions = &of_axis.priors.precisions;
                let found = posterior(&products, &ridges.groups, precisions, ridges.free)?;
                let coefficients = of_axis.masked(&found.coefficients);
                let levels = self.levels(blocks, axis, &coefficients, is_used);
                for i in (0..blocks.blocks.len()).filter(|&i| !is_used(i)) {
                    let level = levels[blocks.blocks[i].log];
                    errors[axis][i] = self.error(blocks, axis, i, &coefficients) - level;
                }
            }
        }
        Some(HeldOut::new(blocks, folds, &errors))
    }

    /// What the model leaves of a block.
    fn error(&self, blocks: &Blocks, axis: usize, block: usize, coefficients: &[f64]) -> f64 {
        blocks.raw[axis][block] - dot(&self.rows[block], coefficients)
    }

    /// The mean of what is left, by log; of all used blocks where a log has none.
    fn levels(
        &self,
        blocks: &Blocks,
        axis: usize,
        coefficients: &[f64],
        is_used: impl Fn(usize) -> bool,
    ) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); blocks.logs()];
        for (i, block) in blocks.blocks.iter().enumerate() {
            if is_used(i) {
                let error = self.error(blocks, axis, i, coefficients);
                sums[block.log].0 += block.weight * error;
                sums[block.log].1 += block.weight;
            }
        }
        let total = sums
            .iter()
            .fold((0.0, 0.0), |all, of| (all.0 + of.0, all.1 + of.1));
        let mean = |(sum, weight): (f64, f64)| match weight > 0.0 {
            true => sum / weight,
            false => total.0 / total.1,
        };
        sums.into_iter().map(mean).collect()
    }

    /// The constant bias of an axis: with it nothing is left in the mean of the logs.
    pub(crate) fn constant(&self, blocks: &Blocks, axis: usize) -> f64 {
        let levels = self.levels(blocks, axis, &self.axes[axis].coefficients, |_| true);
        blocks.mean(axis) + levels.iter().sum::<f64>() / levels.len() as f64
    }
}

impl AxisSolution {
    /// Coefficients without those that explain nothing.
    fn masked(&self, coefficients: &DVector<f64>) -> Vec<f64> {
        let pairs = coefficients.iter().zip(&self.used);
        pairs
            .map(|(of, &used)| if used { *of } else { 0.0 })
            .collect()
    }
}

/// The settings' core over all samples, as blocks see it: means of the basis.
fn rows(points: &SamplePoints, blocks: &Blocks, basis: &Basis) -> Vec<SparseRow> {
    let mut entries = SparseRow::new();
    let mut dense = vec![0.0; basis.columns()];
    let mut row = |block: &Block| {
        dense.fill(0.0);
        let rows: f64 = points.of_block(block).map(|kept| kept.rows).sum();
        for kept in points.of_block(block) {
            let point = &kept.point;
            let (temp_c, rate) = (point.effective_c.into(), point.rate_c_per_min.into());
            basis.row(block.log, temp_c, rate, &mut entries);
            let plays_c = point.plays_c.iter().map(|&play_c| play_c.into());
            basis.push_history(temp_c, point.lag2_c.into(), plays_c, &mut entries);
            for &(column, value) in &entries {
                dense[column] += kept.rows / rows * value;
            }
        }
        let filled = dense.iter().enumerate().filter(|(_, value)| **value != 0.0);
        filled.map(|(column, &value)| (column, value)).collect()
    };
    blocks.blocks.iter().map(&mut row).collect()
}

fn solve(
    blocks: &Blocks,
    sensor: &SensorNoise,
    trial: &Trial,
    axis: usize,
    spread: &DMatrix<f64>,
) -> Option<AxisSolution> {
    let (priors, posterior) = tuned_axis(blocks, sensor, trial, axis)?;
    let columns = trial.basis.columns();
    // A column counts where one of its groups explains something, or where it has none.
    let in_use = in_use(&trial.ridges.groups, &priors.precisions, &posterior);
    let mut used = vec![false; columns];
    let mut held = vec![false; columns];
    for (ridge, in_use) in trial.ridges.groups.iter().zip(in_use) {
        for column in ridge.first..ridge.first + ridge.matrix.nrows() {
            held[column] = true;
            used[column] |= in_use;
        }
    }
    for (column, used) in used.iter_mut().enumerate() {
        *used |= !held[column] || column < trial.basis.static_columns();
    }
    // Errors are to allow for a drift that coefficients must not follow.
    let coefficients = posterior.coefficients.clone();
    let (noise, known) = with_possible_drift(blocks, trial, axis, &priors, posterior);
    let mut solution = AxisSolution {
        coefficients: Vec::new(),
        covariance: DMatrix::zeros(columns, columns),
        white: known.variance,
        walk: known.variance * noise.walk_per_s,
        priors,
        used,
    };
    solution.coefficients = solution.masked(&coefficients);
    // A division that had to be coarser than the search's has no spread of its own.
    let mut whole = solution.white * solution.priors.limits.inflation * known.inverse;
    if spread.shape() == whole.shape() {
        whole += spread;
    }
    solution.covariance = covariance(blocks, trial, &solution, &whole);
    Some(solution)
}

/// The posterior covariance of the coefficients once the constant is put where the mean of the
/// logs is. A mean over a log has the variance of the walk, which begins with it, and of the
/// white noise.
fn covariance(
    blocks: &Blocks,
    trial: &Trial,
    solution: &AxisSolution,
    whole: &DMatrix<f64>,
) -> DMatrix<f64> {
    let columns = trial.basis.columns();
    let fixed = trial.basis.static_columns();
    let mut mean = DVector::zeros(columns);
    let total: f64 = blocks.blocks.iter().map(|block| block.weight).sum();
    for (row, block) in trial.rows.iter().zip(&blocks.blocks) {
        for &(column, value) in row {
            mean[column] += block.weight / total * value;
        }
    }
    // Each static column loses the mean row: the splines add up to 1.
    let is_static = |column: usize| if column < fixed { 1.0 } else { 0.0 };
    let of_mean = whole * &mean;
    let of_both = mean.dot(&of_mean);
    let level = level_variance(blocks, solution);
    DMatrix::from_fn(columns, columns, |i, j| {
        if !(solution.used[i] && solution.used[j]) {
            return 0.0;
        }
        let (a, b) = (is_static(i), is_static(j));
        let centred = whole[(i, j)] - a * of_mean[j] - b * of_mean[i] + a * b * of_both;
        centred + a * b * level
    })
}

/// Variance of the mean of the logs' means.
fn level_variance(blocks: &Blocks, solution: &AxisSolution) -> f64 {
    let logs = blocks.blocks.chunk_by(|a, b| a.log == b.log);
    let (mut sum, mut count) = (0.0, 0.0);
    for log in logs {
        let length_s = log[log.len() - 1].time_s - log[0].time_s;
        sum += solution.white / log.len() as f64 + solution.walk * length_s / 3.0;
        count += 1.0;
    }
    sum / (count * count)
}

/// Lowest and highest of a figure of the core's points.
pub(crate) fn range(
    points: &SamplePoints,
    blocks: &Blocks,
    figure: fn(&ThermalPoint) -> f32,
) -> (f32, f32) {
    let all = blocks.blocks.iter();
    let figures = all.flat_map(|block| points.of_block(block).map(|kept| figure(&kept.point)));
    let ends = (f32::INFINITY, f32::NEG_INFINITY);
    figures.fold(ends, |(low, high), value| (low.min(value), high.max(value)))
}
