//! Blocks that are far from what temperature and its rate explain.

use tempco::{TableError, ThermalSettings};
use tempco_log::median::median;
use tempco_set::BiasStep;

use crate::least_squares::{Basis, Blocks, Gram, RateForm, SparseRow, dot};
use crate::outliers::{SIGMA_PER_MAD, steps};
use crate::summary::ChannelData;

/// Blocks further from the fit than this many standard deviations are left out.
const LIMIT: f64 = 6.0;

/// Where more blocks than this share would be left out, it is the model that does not fit, not
/// the data: then none is.
const MOST_SHARE: f64 = 0.05;

/// Fits and rejections in turn until nothing changes, at most so many times.
const ROUNDS: usize = 6;

/// Segments of the reference, and the narrowest \[degC\].
const SEGMENTS: usize = 8;
const LEAST_WIDTH_C: f64 = 8.0;

/// A second, slower rate in the reference: this many time constants of the first.
const SLOWER: f64 = 10.0;

/// The reference fit: flexible enough not to take thermal lag for a disturbance. It decides what
/// stays in the fit and is otherwise forgotten.
pub(super) struct Reference {
    blocks: Blocks,
    /// For each block, whether it stays.
    keep: Vec<bool>,
    /// By axis and block; of left-out blocks as well.
    residuals: Vec<Vec<f64>>,
    /// Of each log and axis.
    constants: Vec<Vec<f64>>,
}

/// Fits the reference; with `reject`, without the disturbed blocks.
pub(super) fn find(
    data: &ChannelData,
    settings: &ThermalSettings,
    reject: bool,
) -> Result<Reference, TableError> {
    let blocks = Blocks::new(data);
    let count = blocks.blocks.len();
    let tau_s = f64::from(settings.tau_s);
    let fast = blocks.rates(data, settings, tau_s)?;
    let slow = blocks.rates(data, settings, (SLOWER * tau_s).min(2400.0))?;
    let (low, high) = Blocks::range(&blocks.temp_c);
    let segments = (((high - low) / LEAST_WIDTH_C) as usize).clamp(1, SEGMENTS);
    let edge = |k: usize| low + (high - low) * k as f64 / segments as f64;
    let edges = (0..=segments).map(edge).collect();
    let basis = Basis::new(edges, RateForm::Line, blocks.logs());
    let columns = basis.columns();
    let rows: Vec<SparseRow> = (0..count)
        .map(|i| {
            let mut row = SparseRow::new();
            basis.row(blocks.blocks[i].log, blocks.temp_c[i], fast[i], &mut row);
            row.extend([
                (columns, slow[i]),
                (columns + 1, slow[i] * blocks.temp_c[i] / 100.0),
            ]);
            row
        })
        .collect();

    let least_sigmas = white_sigmas(data, &blocks);
    let mut keep = vec![true; count];
    let mut solution = Vec::new();
    for _ in 0..ROUNDS {
        let mut gram = Gram::new(columns + 2, blocks.axes());
        for i in (0..count).filter(|&i| keep[i]) {
            gram.push(&rows[i], blocks.observations(i), blocks.blocks[i].weight);
        }
        solution = gram
            .solve()
            .unwrap_or_else(|| vec![vec![0.0; columns + 2]; blocks.axes()]);
        if !reject {
            break;
        }
        let now = undisturbed(&blocks, &rows, &solution, &least_sigmas);
        let rejected = now.iter().filter(|&&keep| !keep).count();
        if now == keep || rejected as f64 > MOST_SHARE * count as f64 {
            break;
        }
        keep = now;
    }
    let residuals = residuals(&blocks, &rows, &solution);
    let constants = constants(&blocks, basis.static_columns(), &solution);
    Ok(Reference {
        blocks,
        keep,
        residuals,
        constants,
    })
}

fn residuals(blocks: &Blocks, rows: &[SparseRow], solution: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let of_axis = blocks.raw.iter().zip(solution);
    of_axis
        .map(|(raw, solution)| {
            let pairs = raw.iter().zip(rows);
            pairs.map(|(raw, row)| raw - dot(row, solution)).collect()
        })
        .collect()
}

/// Number of rows of most blocks.
fn usual_weight(blocks: &Blocks) -> f64 {
    let mut weights: Vec<f64> = blocks.blocks.iter().map(|block| block.weight).collect();
    median(&mut weights)
}

/// For each axis the standard deviation of a block mean, as far as neighbouring rows tell it: no
/// residual below that is out of the ordinary, however well the reference fits.
fn white_sigmas(data: &ChannelData, blocks: &Blocks) -> Vec<f64> {
    let root = usual_weight(blocks).sqrt();
    let of_axis = |axis: usize| {
        let logs = 0..data.logs.len();
        let mut of_logs: Vec<f64> = logs.map(|log| data.of(log).white_sigmas[axis]).collect();
        median(&mut of_logs) / root
    };
    (0..data.axes()).map(of_axis).collect()
}

/// For each block, whether all axes are within the limit of their own scale. A block of few rows
/// may be further away, as its mean is noisier.
fn undisturbed(
    blocks: &Blocks,
    rows: &[SparseRow],
    solution: &[Vec<f64>],
    least_sigmas: &[f64],
) -> Vec<bool> {
    let usual = usual_weight(blocks);
    let mut keep = vec![true; rows.len()];
    for (residuals, least) in residuals(blocks, rows, solution).iter().zip(least_sigmas) {
        let mut distances: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
        let limit = LIMIT * least.max(SIGMA_PER_MAD * median(&mut distances));
        for ((residual, block), keep) in residuals.iter().zip(&blocks.blocks).zip(&mut keep) {
            let allowed = limit * (usual / block.weight).sqrt().max(1.0);
            *keep &= limit == 0.0 || residual.abs() <= allowed;
        }
    }
    keep
}

/// How far the constant of each log is from the mean of the logs.
fn constants(blocks: &Blocks, first_log: usize, solution: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let logs = blocks.logs();
    let of_axis = |axis: usize, log: usize| {
        let contrasts = &solution[axis][first_log..first_log + logs - 1];
        let contrast = match contrasts.get(log) {
            Some(contrast) => *contrast,
            None => -contrasts.iter().sum::<f64>(),
        };
        let means = blocks.log_means.iter().map(|means| means[axis]);
        contrast + blocks.log_means[log][axis] - means.sum::<f64>() / logs as f64
    };
    (0..logs)
        .map(|log| (0..blocks.axes()).map(|axis| of_axis(axis, log)).collect())
        .collect()
}

impl Reference {
    /// Leaves the rows of disturbed blocks out and counts them.
    pub(super) fn leave_out(&self, data: &mut ChannelData) -> usize {
        let mut count = 0;
        for (block, _) in self
            .blocks
            .blocks
            .iter()
            .zip(&self.keep)
            .filter(|(_, k)| !**k)
        {
            data.keep[block.log][block.position] = false;
            count += block.weight as usize;
        }
        count
    }

    pub(super) fn constants(&self) -> Vec<Vec<f64>> {
        self.constants.clone()
    }

    /// Steps of the bias that the reference does not explain, by log and time.
    pub(super) fn steps(&self, data: &ChannelData) -> Vec<BiasStep> {
        let mut found = Vec::new();
        for (number, log) in data.logs.iter().enumerate() {
            let kept: Vec<usize> = (0..self.keep.len())
                .filter(|&i| self.keep[i] && self.blocks.blocks[i].log == number)
                .collect();
            let times: Vec<f64> = kept.iter().map(|&i| self.blocks.blocks[i].time_s).collect();
            let axes = &data.of(number).axes;
            for (axis, residuals) in axes.iter().zip(&self.residuals) {
                let values: Vec<f64> = kept.iter().map(|&i| residuals[i]).collect();
                let steps = steps::find(&times, &values).into_iter();
                found.extend(steps.map(|(time_s, size)| BiasStep {
                    file: log.file.clone(),
                    axis: axis.name.clone(),
                    time_s,
                    size,
                }));
            }
        }
        found
    }
}
