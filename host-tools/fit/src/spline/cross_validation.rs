//! Errors on what was left out of the fit.

use tempco_set::{AxisModel, Overlap, Polynomial, Segmentation};

use crate::least_squares::{Basis, Blocks, Gram, RateForm};
use crate::segments::solve::SegmentRows;
use crate::spline::folds::Folds;
use crate::spline::regressors::Regressors;

/// Sums of squared errors of held-out blocks, by axis and fold.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HeldOut {
    pub(crate) squares: Vec<Vec<f64>>,
    /// Rows in each fold.
    pub(crate) weights: Vec<f64>,
}

impl HeldOut {
    fn new(blocks: &Blocks, folds: &Folds) -> Self {
        let mut weights = vec![0.0; folds.count];
        for (block, &fold) in blocks.blocks.iter().zip(&folds.of_block) {
            weights[fold] += block.weight;
        }
        Self {
            squares: vec![vec![0.0; folds.count]; blocks.axes()],
            weights,
        }
    }

    /// Without any model: each axis about the mean of its log.
    pub(crate) fn none(blocks: &Blocks, folds: &Folds) -> Self {
        let mut held_out = Self::new(blocks, folds);
        for (axis, squares) in held_out.squares.iter_mut().enumerate() {
            for (i, block) in blocks.blocks.iter().enumerate() {
                squares[folds.of_block[i]] += block.weight * blocks.raw[axis][i].powi(2);
            }
        }
        held_out
    }

    /// A model that is linear in its coefficients, from the normal equations of its folds. `None`
    /// where what remains cannot be solved.
    pub(crate) fn linear(blocks: &Blocks, folds: &Folds, grams: &[Gram]) -> Option<Self> {
        let mut held_out = Self::new(blocks, folds);
        let mut whole = grams[0].clone();
        for gram in &grams[1..] {
            whole.merge(gram);
        }
        for (fold, gram) in grams.iter().enumerate() {
            let solution = whole.without(gram).solve()?;
            for (axis, coefficients) in solution.iter().enumerate() {
                held_out.squares[axis][fold] = gram.residual(axis, coefficients);
            }
        }
        Some(held_out)
    }

    /// The spline model, with the values of its history terms block by block.
    pub(crate) fn spline(
        blocks: &Blocks,
        folds: &Folds,
        regressors: &Regressors,
        kappa: f64,
        basis: &Basis,
        history: &[Vec<f64>],
    ) -> Option<Self> {
        let grams = regressors.grams(blocks, folds, basis, kappa, history);
        Self::linear(blocks, folds, &grams)
    }

    /// A model of the leading columns and some of the others. `pick` chooses these for each fold
    /// left out, from the normal equations of the others after the leading ones.
    pub(crate) fn picked(
        blocks: &Blocks,
        folds: &Folds,
        grams: &[Gram],
        leading: usize,
        pick: impl Fn(&Gram) -> Option<Vec<usize>>,
    ) -> Option<Self> {
        let mut held_out = Self::new(blocks, folds);
        let mut whole = grams[0].clone();
        for gram in &grams[1..] {
            whole.merge(gram);
        }
        for (fold, gram) in grams.iter().enumerate() {
            let training = whole.without(gram);
            let picked = pick(&training.reduced(leading)?)?;
            let others = picked.into_iter().map(|position| leading + position);
            let columns: Vec<usize> = (0..leading).chain(others).collect();
            let solution = training.only(&columns).solve()?;
            let judged = gram.only(&columns);
            for (axis, coefficients) in solution.iter().enumerate() {
                held_out.squares[axis][fold] = judged.residual(axis, coefficients);
            }
        }
        Some(held_out)
    }

    /// One cubic in T.
    pub(crate) fn cubic(blocks: &Blocks, folds: &Folds) -> Option<Self> {
        let (low, high) = Blocks::range(&blocks.temp_c);
        let mut grams = vec![Gram::new(3 + blocks.logs(), blocks.axes()); folds.count];
        let contrast = Basis::new(vec![low, high], RateForm::None, blocks.logs());
        let mut row = Vec::new();
        for (i, block) in blocks.blocks.iter().enumerate() {
            contrast.row(block.log, low, 0.0, &mut row);
            let constants: Vec<_> = row.iter().filter(|(column, _)| *column >= 3).collect();
            let z = (2.0 * blocks.temp_c[i] - low - high) / (high - low);
            let powers = [1.0, z, z * z, z * z * z];
            let mut entries: Vec<(usize, f64)> = powers.into_iter().enumerate().collect();
            entries.extend(
                constants
                    .into_iter()
                    .map(|&(column, value)| (column + 1, value)),
            );
            grams[folds.of_block[i]].push(&entries, blocks.observations(i), block.weight);
        }
        Self::linear(blocks, folds, &grams)
    }

    /// The models of overlapping segments with some numbers of `terms`, those that the data cannot
    /// carry dropped as in the fit. None where a segment cannot be fitted.
    pub(crate) fn segments<const N: usize>(
        blocks: &Blocks,
        folds: &Folds,
        regressors: &Regressors,
        (kappa, terms): (f64, [usize; N]),
        segmentation: &Segmentation,
        overlap: Overlap,
    ) -> [Option<Self>; N] {
        let rows = SegmentParts::new(blocks, folds, regressors, kappa, (segmentation, overlap));
        terms.map(|terms| {
            let polynomials = rows.polynomials(segmentation, terms, regressors.tau_s())?;
            let pieces = segmentation.pieces(overlap);
            let (low, high) = segmentation.range_c();
            let mut held_out = Self::new(blocks, folds);
            for (i, block) in blocks.blocks.iter().enumerate() {
                let fold = folds.of_block[i];
                let temp_c = regressors.effective_c(i, kappa).clamp(low, high);
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
                    let error = blocks.levelled(axis, i) - fixed - per_rate * regressors.rates()[i];
                    held_out.squares[axis][fold] += block.weight * error * error;
                }
            }
            Some(held_out)
        })
    }

    fn weight(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// Mean squared error of an axis.
    pub(crate) fn mean_square(&self, axis: usize) -> f64 {
        self.squares[axis].iter().sum::<f64>() / self.weight()
    }

    /// Sum over the axes of the logarithm of the mean squared error: the same in every unit.
    pub(crate) fn score(&self) -> f64 {
        (0..self.squares.len())
            .map(|axis| self.mean_square(axis).max(f64::MIN_POSITIVE).ln())
            .sum()
    }

    /// How much larger the mean squared error is than that of `best`, as a share, averaged over
    /// `axes`, and the standard error of that: from the differences of the folds, since what is
    /// hard to predict in a fold is so for both.
    pub(crate) fn excess(&self, best: &Self, axes: &[usize]) -> (f64, f64) {
        let count = self.weights.len() as f64;
        let differences: Vec<f64> = (0..self.weights.len())
            .map(|fold| {
                let of_axis = axes.iter().map(|&axis| {
                    let difference = self.squares[axis][fold] - best.squares[axis][fold];
                    difference / (best.mean_square(axis).max(f64::MIN_POSITIVE) * best.weight())
                });
                of_axis.sum::<f64>() / axes.len() as f64
            })
            .collect();
        let total: f64 = differences.iter().sum();
        let mean = total / count;
        let squares: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum();
        (total, (squares * count / (count - 1.0).max(1.0)).sqrt())
    }
}

/// The rows of overlapping segments, by segment and left-out fold.
struct SegmentParts(Vec<Vec<SegmentRows>>);

impl SegmentParts {
    fn new(
        blocks: &Blocks,
        folds: &Folds,
        regressors: &Regressors,
        kappa: f64,
        (segmentation, overlap): (&Segmentation, Overlap),
    ) -> Self {
        let ranges = segmentation.fit_ranges(overlap);
        let of_segment = segmentation.segments().iter().zip(&ranges);
        let without_each = of_segment.map(|(segment, range)| {
            let mut parts = vec![SegmentRows::new(blocks.axes()); folds.count];
            for i in 0..blocks.blocks.len() {
                let temp_c = regressors.effective_c(i, kappa);
                if temp_c >= range.t_min_c && temp_c <= range.t_max_c {
                    let z = (temp_c - segment.centre_c()) / segment.half_width_c();
                    let observations = (0..blocks.axes()).map(|axis| blocks.levelled(axis, i));
                    parts[folds.of_block[i]].push(1.0, z, regressors.rates()[i], observations);
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
