//! The final least squares of the spline model, on the core's own regressors.

use nalgebra::DMatrix;

use crate::least_squares::{AxisTerms, Basis, Blocks};
use crate::spline::covariance::{Covariance, Noise};
use crate::spline::rows::Rows;

/// What least squares finds for an axis, in all columns; 0 in those that the axis does not have.
pub(crate) struct AxisSolution {
    pub(crate) coefficients: Vec<f64>,
    pub(crate) covariance: DMatrix<f64>,
    pub(crate) noise: Noise,
}

/// Solves for every axis with the terms it has, and says the largest condition number. `None` where
/// the rows do not determine them.
pub(crate) fn solve_axes(
    rows: &Rows,
    blocks: &Blocks,
    basis: &Basis,
    axes: &[AxisTerms],
) -> Option<(Vec<AxisSolution>, f64)> {
    let mut found: Vec<Option<AxisSolution>> = axes.iter().map(|_| None).collect();
    let mut condition = 0.0_f64;
    for (first, &terms) in axes.iter().enumerate() {
        if found[first].is_some() {
            continue;
        }
        let columns = basis.columns_of(terms);
        let part = rows.only(&columns);
        let solution = part.factor(blocks).solve(columns.len())?;
        let covariance = Covariance::new(&part, blocks, columns.len())?;
        condition = condition.max(solution.condition);
        for axis in (first..axes.len()).filter(|&axis| axes[axis] == terms) {
            let own = &solution.coefficients[axis];
            let noise = covariance.noise(axis, own);
            let own_covariance = covariance.of(noise);
            let mut coefficients = vec![0.0; basis.columns()];
            let mut all = DMatrix::zeros(basis.columns(), basis.columns());
            for (i, &column) in columns.iter().enumerate() {
                coefficients[column] = own[i];
                for (j, &other) in columns.iter().enumerate() {
                    all[(column, other)] = own_covariance[(i, j)];
                }
            }
            found[axis] = Some(AxisSolution {
                coefficients,
                covariance: all,
                noise,
            });
        }
    }
    Some((found.into_iter().collect::<Option<_>>()?, condition))
}
