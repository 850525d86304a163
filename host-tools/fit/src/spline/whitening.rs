//! Noise taken apart: rows whose errors are independent and alike.
//!
//! ```text
//! y = X b + w + e + n - n'     e white, variance r / weight; w drifts, n is noise of the angle
//! dw = -w dt / Td + dW         a random walk, q per second, that forgets in the drift time Td
//! ```
//!
//! Whole pulses and optical noise are noise of the angle: what is too much in one mean is missing
//! in the next. A Kalman filter predicts drift and angle from the rows before; what it does not
//! predict has the variance `F`, and divided by its square root it is white. The filter runs over
//! observations and regressors alike, so that least squares on what it leaves is the best linear
//! estimate. The drift is stationary at the start of every log (Durbin & Koopman, Time Series
//! Analysis by State Space Methods, chapter 4); a constant per log is among the regressors.

use nalgebra::{DMatrix, DVector};

use crate::least_squares::{Block, Blocks, SparseRow};

/// Rows that are added up together, so that sums are loaded and stored once for all of them.
const TOGETHER: usize = 4;

/// Rows further apart than this many usual steps have no angle in common.
const GAP: f64 = 1.5;

/// Noise of an axis, in variances of the white noise of a block of usual weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NoiseShares {
    /// Growth of the variance of the drift over short times \[1/s\].
    pub(crate) walk_per_s: f64,
    /// Time in which the drift forgets \[s\].
    pub(crate) drift_s: f64,
    /// Variance of the noise of the angle, per block.
    pub(crate) angle: f64,
}

/// One step of the filter.
#[derive(Clone, Copy)]
enum Step {
    /// A row that is not used.
    Skip,
    /// A row: `scale` makes what is left of it white, and shares of it go to the drift and to what
    /// the angle does to the next row.
    Row {
        /// What is left of the drift of the row before.
        kept: f64,
        drift: f64,
        angle: f64,
        scale: f64,
        /// Nothing is known of the angle before.
        apart: bool,
    },
}

/// The filter, which depends on times, weights and the noise alone.
pub(crate) struct Whitening {
    steps: Vec<Step>,
    /// Sum of `ln F` over the rows.
    log_determinant: f64,
    /// Rows that are left.
    rows: usize,
}

/// The last row that was used, with the variances of drift and angle behind it.
struct Before<'a> {
    block: &'a Block,
    drift: f64,
    angle: f64,
    cross: f64,
}

impl Whitening {
    /// For the blocks that are `used`.
    pub(crate) fn new(blocks: &Blocks, noise: NoiseShares, used: impl Fn(usize) -> bool) -> Self {
        let usual = blocks.usual_weight();
        let stationary = 0.5 * noise.walk_per_s * noise.drift_s;
        let mut found = Self {
            steps: Vec::with_capacity(blocks.blocks.len()),
            log_determinant: 0.0,
            rows: 0,
        };
        let mut before: Option<Before> = None;
        for (i, block) in blocks.blocks.iter().enumerate() {
            if !used(i) {
                found.steps.push(Step::Skip);
                continue;
            }
            let white = usual / block.weight + noise.angle;
            let last = before.filter(|last| last.block.log == block.log);
            let apart = last
                .as_ref()
                .is_none_or(|last| block.time_s - last.block.time_s > GAP * blocks.step_s());
            // From the row before to this one.
            let (kept, drift) = last.as_ref().map_or((0.0, stationary), |last| {
                let kept = libm::exp((last.block.time_s - block.time_s) / noise.drift_s);
                (kept, stationary + kept * kept * (last.drift - stationary))
            });
            let (angle, cross) = match last {
                Some(last) if !apart => (last.angle, kept * last.cross),
                _ => (noise.angle, 0.0),
            };
            let total = drift + 2.0 * cross + angle + white;
            let of_drift = drift + cross;
            found.log_determinant += libm::log(total);
            found.rows += 1;
            found.steps.push(Step::Row {
                kept,
                drift: of_drift / total,
                angle: -noise.angle / total,
                scale: 1.0 / total.sqrt(),
                apart,
            });
            before = Some(Before {
                block,
                drift: drift - of_drift * of_drift / total,
                angle: noise.angle - noise.angle * noise.angle / total,
                cross: of_drift * noise.angle / total,
            });
        }
        found
    }

    /// How much of what is left of a series is noise of its own, white with the variance `noise`
    /// in every row.
    pub(crate) fn share_of_noise(&self, values: &[f64], noise: f64) -> f64 {
        let (mut level, mut carried) = (0.0, 0.0);
        let (mut whole, mut own) = (0.0, 0.0);
        for (value, step) in values.iter().zip(&self.steps) {
            if let Step::Row {
                kept,
                drift,
                angle,
                scale,
                apart,
            } = *step
            {
                level *= kept;
                let error = value - (level + if apart { 0.0 } else { carried });
                level += drift * error;
                carried = angle * error;
                whole += (scale * error).powi(2);
                own += scale * scale * noise;
            }
        }
        own / whole
    }

    /// Sums of products of whitened rows and observations.
    pub(crate) fn products(
        &self,
        rows: &[SparseRow],
        columns: usize,
        observations: &[f64],
    ) -> WhiteProducts {
        let width = columns + 1;
        let mut level = vec![0.0; width];
        let mut carried = vec![0.0; width];
        let mut dense = vec![0.0; width];
        let mut left = vec![vec![0.0; width]; TOGETHER];
        let mut sums = vec![0.0; width * width];
        let mut held = 0;
        for ((row, &observation), step) in rows.iter().zip(observations).zip(&self.steps) {
            if matches!(step, Step::Skip) {
                continue;
            }
            dense.fill(0.0);
            for &(column, value) in row {
                dense[column] += value;
            }
            dense[columns] = observation;
            match *step {
                Step::Skip => {}
                Step::Row {
                    kept,
                    drift,
                    angle,
                    scale,
                    apart,
                } => {
                    if apart {
                        carried.fill(0.0);
                    }
                    let states = level.iter_mut().zip(&mut carried);
                    let values = left[held].iter_mut().zip(&dense);
                    for ((level, carried), (left, value)) in states.zip(values) {
                        *level *= kept;
                        let error = value - (*level + *carried);
                        *level += drift * error;
                        *carried = angle * error;
                        *left = scale * error;
                    }
                    held += 1;
                }
            }
            if held == TOGETHER {
                add_products(&mut sums, &left);
                held = 0;
            }
        }
        for rest in &mut left[held..] {
            rest.fill(0.0);
        }
        add_products(&mut sums, &left);
        let at = |i: usize, j: usize| sums[i.min(j) * width + i.max(j)];
        WhiteProducts {
            normal: DMatrix::from_fn(columns, columns, at),
            target: DVector::from_fn(columns, |i, _| at(i, columns)),
            square: at(columns, columns),
            log_determinant: self.log_determinant,
            rows: self.rows,
        }
    }
}

/// Adds the upper triangles of the outer products of some rows.
fn add_products(sums: &mut [f64], rows: &[Vec<f64>]) {
    let [a, b, c, d] = rows else {
        unreachable!("rows come in fours")
    };
    let width = a.len();
    for i in 0..width {
        let [ai, bi, ci, di] = [a[i], b[i], c[i], d[i]];
        let others = a[i..].iter().zip(&b[i..]).zip(c[i..].iter().zip(&d[i..]));
        for (sum, ((a, b), (c, d))) in sums[i * width + i..(i + 1) * width].iter_mut().zip(others) {
            *sum += (ai * a + bi * b) + (ci * c + di * d);
        }
    }
}

/// Normal equations of one axis in whitened rows.
#[derive(Clone)]
pub(crate) struct WhiteProducts {
    /// `X' X`.
    pub(crate) normal: DMatrix<f64>,
    /// `X' y`.
    pub(crate) target: DVector<f64>,
    /// `y' y`.
    pub(crate) square: f64,
    /// Logarithm of the determinant of the errors' covariance, in white variances.
    pub(crate) log_determinant: f64,
    pub(crate) rows: usize,
}
