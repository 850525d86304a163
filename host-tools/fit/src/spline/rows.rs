//! The rows of the final least squares.

use crate::least_squares::{Basis, Blocks, RFactor, SamplePoints, SparseRow};
use crate::spline::history_terms::Shape;

/// The rows of the least squares of a spline: for each block, the mean of the basis over its samples.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    pub(crate) columns: usize,
    /// Block by block.
    pub(crate) values: Vec<f64>,
    /// Square root of the share of rows, 1 on average.
    pub(crate) root_weights: Vec<f64>,
}

impl Rows {
    /// Evaluates the basis, with the history terms of `shape`, at the core's points of every sample
    /// and takes means.
    pub(crate) fn new(
        points: &SamplePoints,
        blocks: &Blocks,
        basis: &Basis,
        shape: &Shape,
    ) -> Self {
        let columns = basis.columns();
        let mut values = vec![0.0; columns * blocks.blocks.len()];
        let mut entries = SparseRow::new();
        for (block, mean) in blocks.blocks.iter().zip(values.chunks_exact_mut(columns)) {
            let rows: f64 = points.of_block(block).map(|kept| kept.rows).sum();
            for kept in points.of_block(block) {
                let point = &kept.point;
                let (temp_c, rate) = (point.effective_c.into(), point.rate_c_per_min.into());
                basis.row(block.log, temp_c, rate, &mut entries);
                basis.push_history(shape.values(point), &mut entries);
                for &(column, value) in &entries {
                    mean[column] += kept.rows / rows * value;
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

    /// Some of the columns.
    pub(crate) fn only(&self, columns: &[usize]) -> Self {
        let rows = self.values.chunks_exact(self.columns);
        Self {
            columns: columns.len(),
            values: rows
                .flat_map(|row| columns.iter().map(|&column| row[column]))
                .collect(),
            root_weights: self.root_weights.clone(),
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
