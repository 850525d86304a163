//! The final least squares of the spline model, on the core's own regressors.

use crate::digest::SamplePoint;
use crate::joint::basis::{Basis, SparseRow};
use crate::joint::blocks::{Blocks, SamplePoints};
use crate::rfactor::RFactor;

/// The rows of the joint least squares: for each block, the mean of the basis over its samples.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    pub(crate) columns: usize,
    /// Block by block.
    pub(crate) values: Vec<f64>,
    /// Square root of the share of rows, 1 on average.
    pub(crate) root_weights: Vec<f64>,
}

impl Rows {
    /// Evaluates the basis at the core's points of every sample and takes means.
    pub(crate) fn new(points: &SamplePoints, blocks: &Blocks, basis: &Basis) -> Self {
        let columns = basis.columns();
        let mut values = vec![0.0; columns * blocks.blocks.len()];
        let mut entries = SparseRow::new();
        for (block, mean) in blocks.blocks.iter().zip(values.chunks_exact_mut(columns)) {
            let rows: f64 = points.of_block(block).map(|(_, kept)| kept).sum();
            for (SamplePoint { point, .. }, kept) in points.of_block(block) {
                let (temp_c, rate) = (point.effective_c.into(), point.rate_c_per_min.into());
                basis.row(block.log, temp_c, rate, &mut entries);
                for &(column, value) in &entries {
                    mean[column] += kept / rows * value;
                }
            }
        }
        let total: f64 = blocks.blocks.iter().map(|block| block.weight).sum();
        let mean = total / blocks.blocks.len() as f64;
        let weights = blocks.blocks.iter().map(|block| block.weight / mean);
        Self {
            columns,
            values,
            root_weights: weights.map(f64::sqrt).collect(),
        }
    }

    pub(crate) fn row(&self, block: usize) -> &[f64] {
        &self.values[block * self.columns..(block + 1) * self.columns]
    }

    /// The factor of all rows with the block means of each axis as observations.
    pub(crate) fn factor(&self, blocks: &Blocks) -> RFactor {
        let mut factor = RFactor::new(self.columns, blocks.axes());
        for (block, &root_weight) in self.root_weights.iter().enumerate() {
            let row = self.row(block).iter().copied();
            let weighted = row
                .chain(blocks.observations(block))
                .map(|value| root_weight * value);
            factor.push(weighted);
        }
        factor
    }
}
