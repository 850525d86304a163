//! The groups of coefficients of the spline model, each with its own ridge.

use nalgebra::{DMatrix, DVector};
use tempco::Terms;

use crate::least_squares::Basis;
use crate::spline::evidence::Ridge;

/// Coefficients of the curve that no ridge holds: a line and a parabola. The constants of the logs
/// come on top.
const FREE: usize = 2;

/// What is smoothed, and towards what.
pub(crate) struct Ridges {
    pub(crate) groups: Vec<Ridge>,
    /// Coefficients without ridge.
    pub(crate) free: usize,
}

/// The curve is smooth where its second derivative does not jump from cell to cell; rate and lag
/// terms where they are straight over the range, and small.
pub(crate) fn of_basis(basis: &Basis) -> Ridges {
    let mut groups = Vec::new();
    let segments = basis.segments();
    if segments > 1 {
        let maps = basis.polynomial_maps();
        let columns = basis.static_columns();
        let curvature = |cell: usize| {
            let mut row = DVector::<f64>::zeros(columns);
            for &(column, value) in &maps[cell].1[Terms::STATIC - 1] {
                row[column] += value;
            }
            row
        };
        let mut matrix = DMatrix::zeros(columns, columns);
        for cell in 1..segments {
            let jump = curvature(cell) - curvature(cell - 1);
            matrix += &jump * jump.transpose();
        }
        groups.push(Ridge {
            first: 0,
            matrix,
            rank: segments - 1,
        });
    }
    let first_rate = basis.columns_without_rate();
    let rates = first_rate..first_rate + basis.rate_columns();
    for hats in [rates, basis.lag2_columns()] {
        let count = hats.len();
        if count == 0 {
            continue;
        }
        if count > 2 {
            let mut matrix = DMatrix::zeros(count, count);
            for middle in 1..count - 1 {
                let mut bend = DVector::<f64>::zeros(count);
                bend[middle - 1] = 1.0;
                bend[middle] = -2.0;
                bend[middle + 1] = 1.0;
                matrix += &bend * bend.transpose();
            }
            groups.push(Ridge {
                first: hats.start,
                matrix,
                rank: count - 2,
            });
        }
        groups.push(Ridge {
            first: hats.start,
            matrix: lines(count),
            rank: 2,
        });
    }
    for play in basis.play_columns() {
        groups.push(Ridge {
            first: play,
            matrix: DMatrix::identity(1, 1),
            rank: 1,
        });
    }
    let free = FREE + basis.logs();
    Ridges { groups, free }
}

/// The projection of values at equal distances on straight lines.
fn lines(count: usize) -> DMatrix<f64> {
    let flat = DVector::from_element(count, 1.0 / (count as f64).sqrt());
    let middle = 0.5 * (count as f64 - 1.0);
    let slope = DVector::from_fn(count, |i, _| i as f64 - middle).normalize();
    &flat * flat.transpose() + &slope * slope.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::least_squares::RateForm;

    /// What costs nothing: a parabola, and lines but for their size.
    #[test]
    fn smooth_coefficients_cost_nothing() {
        let edges = (0..=6).map(|k| 10.0 * f64::from(k)).collect();
        let basis = Basis::new(edges, RateForm::Hats, 1).with_history(true, 2);
        let ridges = of_basis(&basis).groups;
        let ranks: Vec<usize> = ridges.iter().map(|of| of.rank).collect();
        assert_eq!(ranks, [5, 5, 2, 5, 2, 1, 1]);
        // Coefficients of the parabola T^2 in the B-splines: products of the two inner knots.
        let knot = |k: usize| 10.0 * (k.clamp(1, 7) as f64 - 1.0);
        let parabola = DVector::from_fn(8, |i, _| knot(i) * knot(i + 1));
        let line = DVector::from_fn(7, |i, _| 3.0 + 0.5 * i as f64);
        let cost = |ridge: usize, own: &DVector<f64>| {
            (own.transpose() * &ridges[ridge].matrix * own)[(0, 0)]
        };
        assert!(cost(0, &parabola).abs() < 1e-6 * parabola.norm_squared());
        assert!(cost(1, &line).abs() < 1e-12);
        assert!((cost(2, &line) - line.norm_squared()).abs() < 1e-9);
    }
}
