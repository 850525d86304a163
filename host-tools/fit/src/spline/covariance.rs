//! Uncertainty of the coefficients where what remains is white noise and a random walk.
//!
//! Least squares takes residuals for independent. A bias that walks is not: with weights `w` the
//! residuals of the weighted rows have the covariance `s^2 I + q^2 D R D`, where `D = diag(sqrt w)`
//! and `R_ij = min(t_i, t_j)` within a log. With `A = (X'X)^-1` of the weighted rows `X`,
//!
//! ```text
//! cov = s^2 A + q^2 A S A,    S = X' D R D X
//! ```
//!
//! `R` is a sum over time steps of outer products of step functions, so that `S` costs one pass.
//! `s^2` and `q^2` are those for which two sums of squares of the residuals have their expected
//! values: of all residuals, and of their means over some dozen stretches of time.

use nalgebra::{DMatrix, DVector};

use crate::least_squares::Blocks;
use crate::spline::rows::Rows;

/// Stretches whose means tell the walk: at least this many, and twice as many as coefficients.
const STRETCHES: usize = 40;

/// Noise of an axis, as found in the residuals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Noise {
    /// Variance of a block of usual weight.
    pub(crate) white: f64,
    /// Growth of the variance of the walk, per second.
    pub(crate) walk: f64,
}

/// What the rows alone determine.
pub(crate) struct Covariance<'a> {
    rows: &'a Rows,
    blocks: &'a Blocks,
    columns: usize,
    /// `A`.
    inverse: DMatrix<f64>,
    /// `A S A`.
    of_walk: DMatrix<f64>,
    /// For each block its stretch.
    stretches: Vec<usize>,
    /// Expected sums of squares, of all residuals and of the stretches, per white and per walk.
    expected: [[f64; 2]; 2],
}

impl<'a> Covariance<'a> {
    /// For the leading `columns` of the rows; `None` where these are not independent.
    pub(crate) fn new(rows: &'a Rows, blocks: &'a Blocks, columns: usize) -> Option<Self> {
        let count = blocks.blocks.len();
        let x = DMatrix::from_fn(count, columns, |i, j| rows.root_weights[i] * rows.row(i)[j]);
        let inverse = (x.transpose() * &x).cholesky()?.inverse();
        let sums = step_sums(&x, rows, blocks);
        let s = sums.transpose() * sums;
        let of_walk = &inverse * &s * &inverse;

        let (stretches, number) = stretches(blocks, (2 * columns).max(STRETCHES).min(count));
        let mut lengths = vec![0.0; number];
        for (i, &stretch) in stretches.iter().enumerate() {
            lengths[stretch] += rows.root_weights[i].powi(2);
        }
        let mut w = DMatrix::zeros(count, number);
        for (i, &stretch) in stretches.iter().enumerate() {
            w[(i, stretch)] = rows.root_weights[i] / f64::sqrt(lengths[stretch]);
        }
        let projected = &w - &x * (&inverse * (x.transpose() * &w));
        let total_walk: f64 = elapsed_s(blocks)
            .iter()
            .zip(&rows.root_weights)
            .map(|(t, root)| t * root * root)
            .sum();
        Some(Self {
            rows,
            blocks,
            columns,
            expected: [
                [
                    (count - columns) as f64,
                    total_walk - (&inverse * &s).trace(),
                ],
                [
                    projected.norm_squared(),
                    step_sums(&projected, rows, blocks).norm_squared(),
                ],
            ],
            inverse,
            of_walk,
            stretches,
        })
    }

    /// The noise of an axis, from its residuals with given coefficients.
    pub(crate) fn noise(&self, axis: usize, coefficients: &[f64]) -> Noise {
        let mut all = 0.0;
        let count = self.stretches.iter().max().map_or(0, |last| last + 1);
        let (mut sums, mut lengths) = (vec![0.0; count], vec![0.0; count]);
        for (i, &raw) in self.blocks.raw[axis].iter().enumerate() {
            let row = &self.rows.row(i)[..self.columns];
            let fitted: f64 = row.iter().zip(coefficients).map(|(x, c)| x * c).sum();
            let weight = self.rows.root_weights[i].powi(2);
            let residual = raw - fitted;
            all += weight * residual * residual;
            sums[self.stretches[i]] += weight * residual;
            lengths[self.stretches[i]] += weight;
        }
        let slow: f64 = sums.iter().zip(&lengths).map(|(s, w)| s * s / w).sum();
        let [[a, b], [c, d]] = self.expected;
        let determinant = a * d - b * c;
        let white = (all * d - slow * b) / determinant;
        let walk = (slow * a - all * c) / determinant;
        if walk <= 0.0 || !walk.is_finite() {
            Noise {
                white: all / a,
                walk: 0.0,
            }
        } else if white <= 0.0 {
            Noise {
                white: 0.0,
                walk: all / b,
            }
        } else {
            Noise { white, walk }
        }
    }

    /// Covariance of the coefficients under a noise.
    pub(crate) fn of(&self, noise: Noise) -> DMatrix<f64> {
        noise.white * &self.inverse + noise.walk * &self.of_walk
    }
}

/// Covariance of combinations of coefficients, given as sparse rows; columns beyond the
/// covariance have none.
pub(crate) fn of_combinations<const N: usize>(
    covariance: &DMatrix<f64>,
    rows: &[Vec<(usize, f64)>; N],
) -> [[f64; N]; N] {
    let dense = rows.each_ref().map(|row| {
        let columns = covariance.nrows();
        let mut dense = DVector::zeros(columns);
        for &(column, value) in row.iter().filter(|(column, _)| *column < columns) {
            dense[column] = value;
        }
        dense
    });
    let products = dense.each_ref().map(|row| covariance * row);
    std::array::from_fn(|i| std::array::from_fn(|j| dense[i].dot(&products[j])))
}

/// A matrix whose square is `Z' D R D Z`: for each time step, the sums over all later rows of the
/// log.
fn step_sums(z: &DMatrix<f64>, rows: &Rows, blocks: &Blocks) -> DMatrix<f64> {
    let times = elapsed_s(blocks);
    let count = z.ncols();
    let mut sums = DMatrix::zeros(z.nrows(), count);
    let mut sum = vec![0.0; count];
    for i in (0..z.nrows()).rev() {
        let log = blocks.blocks[i].log;
        if blocks.blocks.get(i + 1).is_none_or(|next| next.log != log) {
            sum.fill(0.0);
        }
        let before = i.checked_sub(1).filter(|&b| blocks.blocks[b].log == log);
        let root_step = (times[i] - before.map_or(0.0, |b| times[b])).sqrt();
        for (j, sum) in sum.iter_mut().enumerate() {
            *sum += rows.root_weights[i] * z[(i, j)];
            sums[(i, j)] = root_step * *sum;
        }
    }
    sums
}

/// Time of each block since the first of its log \[s\].
fn elapsed_s(blocks: &Blocks) -> Vec<f64> {
    let mut first = (usize::MAX, 0.0);
    let times = blocks.blocks.iter().map(|block| {
        if first.0 != block.log {
            first = (block.log, block.time_s);
        }
        block.time_s - first.1
    });
    times.collect()
}

/// Divides the blocks into stretches of about equal numbers, none across two logs.
fn stretches(blocks: &Blocks, number: usize) -> (Vec<usize>, usize) {
    let count = blocks.blocks.len();
    let mut found = Vec::with_capacity(count);
    let (mut stretch, mut last) = (0, (0, 0));
    for (i, block) in blocks.blocks.iter().enumerate() {
        let now = (block.log, i * number / count);
        if i > 0 && now != last {
            stretch += 1;
        }
        last = now;
        found.push(stretch);
    }
    (found, stretch + 1)
}
