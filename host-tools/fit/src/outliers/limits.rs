//! How far a block may be from a fit.

use tempco_log::median::median;

use crate::least_squares::{Block, Blocks};
use crate::outliers::SIGMA_PER_MAD;
use crate::summary::ChannelData;

/// Blocks further from the fit than this many standard deviations are left out.
const LIMIT: f64 = 6.0;

/// Number of rows of most blocks.
pub(super) fn usual_weight(blocks: &Blocks) -> f64 {
    let mut weights: Vec<f64> = blocks.blocks.iter().map(|block| block.weight).collect();
    median(&mut weights)
}

/// For each axis the standard deviation of a block mean, as far as neighbouring rows tell it: no
/// residual below that is out of the ordinary, however well the reference fits.
pub(super) fn white_sigmas(data: &ChannelData, blocks: &Blocks) -> Vec<f64> {
    let root = usual_weight(blocks).sqrt();
    let of_axis = |axis: usize| {
        let logs = 0..data.logs.len();
        let mut of_logs: Vec<f64> = logs.map(|log| data.of(log).white_sigmas[axis]).collect();
        median(&mut of_logs) / root
    };
    (0..data.axes()).map(of_axis).collect()
}

/// For each axis how far a residual may be; what leaps does not count.
pub(super) fn limits(residuals: &[Vec<f64>], leap: &[bool], least_sigmas: &[f64]) -> Vec<f64> {
    let of_axis = |(residuals, least): (&Vec<f64>, &f64)| {
        let quiet = residuals.iter().zip(leap).filter(|(_, leap)| !**leap);
        let mut distances: Vec<f64> = quiet.map(|(r, _)| r.abs()).collect();
        LIMIT * least.max(SIGMA_PER_MAD * median(&mut distances))
    };
    residuals.iter().zip(least_sigmas).map(of_axis).collect()
}

/// For each block, whether all axes are within the limit of their own scale.
pub(super) fn undisturbed(blocks: &Blocks, residuals: &[Vec<f64>], limits: &[f64]) -> Vec<bool> {
    let usual = usual_weight(blocks);
    let is_within = |i: usize| {
        let axes = residuals.iter().zip(limits);
        let mut axes = axes.map(|(residuals, limit)| (residuals[i], *limit));
        axes.all(|(residual, limit)| !is_beyond(residual, limit, &blocks.blocks[i], usual))
    };
    (0..blocks.blocks.len()).map(is_within).collect()
}

/// A block of few rows may be further away, as its mean is noisier.
pub(super) fn is_beyond(residual: f64, limit: f64, block: &Block, usual: f64) -> bool {
    limit > 0.0 && residual.abs() > limit * (usual / block.weight).sqrt().max(1.0)
}
