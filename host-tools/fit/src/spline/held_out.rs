//! Errors on what was left out of the fit.

use tempco_set::{AxisModel, Overlap, Polynomial, Segmentation};

use tempco_log::median::median;

use crate::least_squares::{Basis, Blocks, Gram, RateForm, SparseRow, dot};
use crate::segments::solve::SegmentRows;
use crate::spline::folds::Folds;
use crate::spline::sensor_noise::MEDIAN_OF_SQUARE;

/// Length of the means that are looked at \[s\]: over it the noise of the angle is gone, and white
/// noise no longer hides the models.
const MEAN_S: f64 = 100.0;

/// Variance of second differences of means, in variances of a mean: 6 where its noise is white, 10
/// where it is noise of the angle. Divided by the larger one, what is taken for noise is noise.
const SECOND_DIFFERENCE: f64 = 10.0;

/// Errors of held-out means of neighbouring blocks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HeldOut {
    /// Sums of squares, by axis and fold, each weighted by its rows.
    squares: Vec<Vec<f64>>,
    /// Rows in each fold, and means.
    weights: Vec<f64>,
    means: Vec<usize>,
    /// For each axis, the variance of the white noise of a mean.
    white: Vec<f64>,
}

impl HeldOut {
    /// From the error of each axis in each block.
    pub(crate) fn new(blocks: &Blocks, folds: &Folds, errors: &[Vec<f64>]) -> Self {
        // Whole soaks and ramps in the order of time, cut into means.
        let together = blocks.steps_in(MEAN_S);
        let numbers: Vec<usize> = (0..blocks.blocks.len()).collect();
        let place = |i: usize| (blocks.blocks[i].log, folds.of_block[i]);
        let runs = numbers.chunk_by(|&a, &b| place(a) == place(b));
        let parts: Vec<&[usize]> = runs.clone().flat_map(|run| run.chunks(together)).collect();
        let weight = |part: &[usize]| part.iter().map(|&i| blocks.blocks[i].weight).sum::<f64>();
        let mut held_out = Self {
            squares: vec![vec![0.0; folds.count]; errors.len()],
            weights: vec![0.0; folds.count],
            means: vec![0; folds.count],
            white: Vec::new(),
        };
        for part in &parts {
            let fold = folds.of_block[part[0]];
            held_out.weights[fold] += weight(part);
            held_out.means[fold] += 1;
        }
        let usual = blocks.usual_weight() * together as f64;
        for (axis, errors) in errors.iter().enumerate() {
            let mean = |part: &[usize]| {
                let weighted = part.iter().map(|&i| blocks.blocks[i].weight * errors[i]);
                weighted.sum::<f64>() / weight(part)
            };
            for part in &parts {
                let fold = folds.of_block[part[0]];
                held_out.squares[axis][fold] += weight(part) * mean(part).powi(2);
            }
            // Second differences of full means: neither ramps nor steps of the error count.
            let mut squares = Vec::new();
            for run in runs.clone() {
                let means: Vec<f64> = run.chunks_exact(together).map(mean).collect();
                let threes = means.windows(3).map(|of| of[0] - 2.0 * of[1] + of[2]);
                squares
                    .extend(threes.map(|difference| difference * difference / SECOND_DIFFERENCE));
            }
            held_out.white.push(match squares.is_empty() {
                true => 0.0,
                false => usual * median(&mut squares) / MEDIAN_OF_SQUARE,
            });
        }
        held_out
    }

    /// For each axis, the white noise that its means hold.
    pub(crate) fn white(&self) -> &[f64] {
        &self.white
    }

    /// The same errors less some white noise, which every model has.
    pub(crate) fn without(mut self, white: &[f64]) -> Self {
        for (squares, white) in self.squares.iter_mut().zip(white) {
            for (square, &means) in squares.iter_mut().zip(&self.means) {
                *square -= means as f64 * white;
            }
        }
        self
    }

    /// Without any model: each axis about the mean of its log.
    pub(crate) fn none(blocks: &Blocks, folds: &Folds) -> Self {
        Self::new(blocks, folds, &blocks.raw)
    }

    /// One cubic in T.
    pub(crate) fn cubic(blocks: &Blocks, folds: &Folds) -> Option<Self> {
        let (low, high) = Blocks::range(&blocks.temp_c);
        let contrast = Basis::new(vec![low, high], RateForm::None, blocks.logs());
        let (mut whole, mut row) = (Gram::new(3 + blocks.logs(), blocks.axes()), Vec::new());
        let mut grams = vec![whole.clone(); folds.count];
        let mut rows = Vec::new();
        for (i, block) in blocks.blocks.iter().enumerate() {
            contrast.row(block.log, low, 0.0, &mut row);
            let constants = row.iter().filter(|(column, _)| *column >= 3);
            let z = (2.0 * blocks.temp_c[i] - low - high) / (high - low);
            let powers = [1.0, z, z * z, z * z * z];
            let mut entries: SparseRow = powers.into_iter().enumerate().collect();
            entries.extend(constants.map(|&(column, value)| (column + 1, value)));
            let gram = &mut grams[folds.of_block[i]];
            gram.push(&entries, blocks.observations(i), block.weight);
            whole.push(&entries, blocks.observations(i), block.weight);
            rows.push(entries);
        }
        let solutions = grams.iter().map(|gram| whole.without(gram).solve());
        let solutions: Vec<Vec<Vec<f64>>> = solutions.collect::<Option<_>>()?;
        let errors = |axis: usize| -> Vec<f64> {
            let of_block = rows.iter().enumerate().map(|(i, row)| {
                blocks.raw[axis][i] - dot(row, &solutions[folds.of_block[i]][axis])
            });
            of_block.collect()
        };
        let errors: Vec<Vec<f64>> = (0..blocks.axes()).map(errors).collect();
        Some(Self::new(blocks, folds, &errors))
    }

    /// The models of overlapping segments with some numbers of `terms`, those that the data cannot
    /// carry dropped as in the fit. None where a segment cannot be fitted.
    pub(crate) fn segments<const N: usize>(
        blocks: &Blocks,
        folds: &Folds,
        regressors: &SegmentRegressors,
        terms: [usize; N],
        segmentation: &Segmentation,
        overlap: Overlap,
    ) -> [Option<Self>; N] {
        let rows = SegmentParts::new(blocks, folds, regressors, (segmentation, overlap));
        terms.map(|terms| {
            let polynomials = rows.polynomials(segmentation, terms, regressors.tau_s)?;
            let pieces = segmentation.pieces(overlap);
            let (low, high) = segmentation.range_c();
            let mut errors = vec![Vec::with_capacity(blocks.blocks.len()); blocks.axes()];
            for (i, &fold) in folds.of_block.iter().enumerate() {
                let temp_c = regressors.effective_c(blocks, i).clamp(low, high);
                let piece = pieces
                    .iter()
                    .find(|piece| temp_c < piece.to_c)
                    .unwrap_or(&pieces[pieces.len() - 1]);
                for (axis, polynomials) in polynomials[fold].iter().enumerate() {
                    let model = AxisModel {
                        polynomials,
                        overlap,
                    };
                    let [fixed, per_rate, _] = model.at(piece, temp_c);
                    let error = blocks.levelled(axis, i) - fixed - per_rate * regressors.rates[i];
                    errors[axis].push(error);
                }
            }
            Some(Self::new(blocks, folds, &errors))
        })
    }

    fn weight(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// Mean squared error of an axis.
    pub(crate) fn mean_square(&self, axis: usize) -> f64 {
        (self.squares[axis].iter().sum::<f64>() / self.weight()).max(0.0)
    }

    /// How much larger the mean squared error of an axis is than that of `other`, as a share of
    /// `whole`, and the standard error of that: from the differences of the folds, since what is
    /// hard to predict in a fold is so for both.
    pub(crate) fn excess(&self, other: &Self, axis: usize, whole: f64) -> (f64, f64) {
        let count = self.weights.len() as f64;
        let share = 1.0 / (whole.max(f64::MIN_POSITIVE) * self.weight());
        let pairs = self.squares[axis].iter().zip(&other.squares[axis]);
        let differences: Vec<f64> = pairs.map(|(a, b)| share * (a - b)).collect();
        let total: f64 = differences.iter().sum();
        let mean = total / count;
        let squares: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum();
        (total, (squares * count / (count - 1.0).max(1.0)).sqrt())
    }
}

/// What the paper's models see of the blocks.
pub(crate) struct SegmentRegressors {
    /// \[degC/min\]
    pub(crate) rates: Vec<f64>,
    pub(crate) tau_s: f64,
    pub(crate) kappa: f64,
}

impl SegmentRegressors {
    /// Lag-compensated temperature of a block: linear in kappa, as in the core.
    fn effective_c(&self, blocks: &Blocks, block: usize) -> f64 {
        blocks.temp_c[block] - self.kappa * self.tau_s / 60.0 * self.rates[block]
    }
}

/// The rows of overlapping segments, by segment and left-out fold.
struct SegmentParts(Vec<Vec<SegmentRows>>);

impl SegmentParts {
    fn new(
        blocks: &Blocks,
        folds: &Folds,
        regressors: &SegmentRegressors,
        (segmentation, overlap): (&Segmentation, Overlap),
    ) -> Self {
        let ranges = segmentation.fit_ranges(overlap);
        let of_segment = segmentation.segments().iter().zip(&ranges);
        let without_each = of_segment.map(|(segment, range)| {
            let mut parts = vec![SegmentRows::new(blocks.axes()); folds.count];
            for i in 0..blocks.blocks.len() {
                let temp_c = regressors.effective_c(blocks, i);
                if temp_c >= range.t_min_c && temp_c <= range.t_max_c {
                    let z = (temp_c - segment.centre_c()) / segment.half_width_c();
                    let observations = (0..blocks.axes()).map(|axis| blocks.levelled(axis, i));
                    parts[folds.of_block[i]].push(1.0, z, regressors.rates[i], observations);
                }
            }
            let without = |fold: usize| {
                let mut rest = SegmentRows::new(blocks.axes());
                for (_, part) in parts.iter().enumerate().filter(|(other, _)| *other != fold) {
                    rest.merge(part.clone());
                }
                rest
            };
            (0..folds.count).map(without).collect()
        });
        Self(without_each.collect())
    }

    /// For each fold, the polynomials by axis and segment.
    fn polynomials(
        &self,
        segmentation: &Segmentation,
        terms: usize,
        tau_s: f64,
    ) -> Option<Vec<Vec<Vec<Polynomial>>>> {
        let mut polynomials: Vec<Vec<Vec<Polynomial>>> = vec![Vec::new(); self.0[0].len()];
        for (segment, without_each) in segmentation.segments().iter().zip(&self.0) {
            for (of_fold, rows) in polynomials.iter_mut().zip(without_each) {
                let fit = rows.clone().fit(terms, tau_s).ok()?;
                of_fold.resize(fit.solution.coefficients.len(), Vec::new());
                for (axis, found) in of_fold.iter_mut().zip(&fit.solution.coefficients) {
                    axis.push(Polynomial::new(segment, found));
                }
            }
        }
        Some(polynomials)
    }
}
