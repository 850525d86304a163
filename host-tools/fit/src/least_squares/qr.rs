//! Least squares from any number of rows in fixed memory: a triangular factor that grows by
//! blocks and merges.

use nalgebra::{DMatrix, DVector, SVD};

/// Rows gathered before they are folded into the factor.
const BLOCK_ROWS: usize = 256;

/// Regressors of a larger condition number are not solved for.
const MOST_CONDITION: f64 = 1e10;

/// Steps of the search for singular values, per regressor: two or three are usual.
const MOST_STEPS: usize = 100;

/// The factor R of a QR decomposition of rows `[regressors | observations]`.
///
/// R carries all that least squares needs of the rows: solutions, residuals and the angles
/// between regressors. It is formed by Householder reflections, so that, unlike with normal
/// equations, the condition number is not squared.
#[derive(Clone, Debug)]
pub struct RFactor {
    regressors: usize,
    width: usize,
    /// The triangle in the first `width` rows, then the rows of the present block.
    stack: DMatrix<f64>,
    pending: usize,
    rows: u64,
    /// For each observation, what its means leave of the squares of the rows.
    within: Vec<f64>,
}

/// The least-squares solution for the leading regressors.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Coefficients of the regressors used, for each observation.
    pub coefficients: Vec<Vec<f64>>,
    /// Standard deviations of the coefficients, for each observation, if the residuals are white.
    pub sigmas: Vec<Vec<f64>>,
    /// Correlations of the coefficients, row by row; the same for all observations.
    pub correlations: Vec<Vec<f64>>,
    /// Root mean square of the residuals, for each observation.
    pub rms: Vec<f64>,
    /// Condition number of the regressors, each scaled to unit length.
    pub condition: f64,
}

impl RFactor {
    /// An empty factor for rows of `regressors` then `observations` values.
    pub fn new(regressors: usize, observations: usize) -> Self {
        let width = regressors + observations;
        Self {
            regressors,
            width,
            stack: DMatrix::zeros(width + BLOCK_ROWS, width),
            pending: 0,
            rows: 0,
            within: vec![0.0; observations],
        }
    }

    /// Number of rows taken in.
    pub const fn rows(&self) -> u64 {
        self.rows
    }

    /// Takes in a row.
    ///
    /// # Panics
    /// If the row does not have the width the factor was made for.
    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        self.rows += 1;
        self.push_row(row);
    }

    /// Takes in the mean of `rows` rows, and for each observation the sum of squares of the rows
    /// about it: to rounding the same as taking in the rows, if these have the same regressors.
    ///
    /// # Panics
    /// If the mean does not have the width the factor was made for.
    pub fn push_mean(
        &mut self,
        rows: u64,
        mean: impl IntoIterator<Item = f64>,
        within: impl IntoIterator<Item = f64>,
    ) {
        let root = (rows as f64).sqrt();
        self.rows += rows;
        self.push_row(mean.into_iter().map(|value| root * value));
        for (sum, squares) in self.within.iter_mut().zip(within) {
            *sum += squares;
        }
    }

    /// Takes in all rows of `other`; the result is that of one factor over both, to rounding.
    ///
    /// # Panics
    /// If the widths differ.
    pub fn merge(&mut self, mut other: Self) {
        assert_eq!(
            (self.regressors, self.width),
            (other.regressors, other.width)
        );
        other.fold();
        for i in 0..other.width {
            self.push_row(other.stack.row(i).iter().copied());
        }
        self.rows += other.rows;
        for (sum, squares) in self.within.iter_mut().zip(other.within) {
            *sum += squares;
        }
    }

    fn push_row(&mut self, row: impl IntoIterator<Item = f64>) {
        if self.pending == BLOCK_ROWS {
            self.fold();
        }
        let at = self.width + self.pending;
        let mut count = 0;
        for (column, value) in row.into_iter().enumerate() {
            self.stack[(at, column)] = value;
            count += 1;
        }
        assert_eq!(count, self.width);
        self.pending += 1;
    }

    fn fold(&mut self) {
        if self.pending == 0 {
            return;
        }
        let used = self.stack.rows(0, self.width + self.pending).into_owned();
        self.stack.fill(0.0);
        self.stack
            .rows_mut(0, self.width)
            .copy_from(&used.qr().r().rows(0, self.width));
        self.pending = 0;
    }

    fn triangle(&mut self) -> DMatrix<f64> {
        self.fold();
        self.stack.rows(0, self.width).into_owned()
    }

    /// The root mean square of each regressor, whole and of the part that the regressors before it
    /// cannot represent.
    pub fn independence(&mut self) -> Vec<Independence> {
        let r = self.triangle();
        let root_rows = (self.rows.max(1) as f64).sqrt();
        (0..self.regressors)
            .map(|j| Independence {
                whole: r.view((0, j), (j + 1, 1)).norm() / root_rows,
                independent: r[(j, j)].abs() / root_rows,
            })
            .collect()
    }

    /// Solves for the first `terms` regressors; `None` where they are not independent, as where one
    /// is 0 in all rows, and where rows or observations are not finite.
    pub fn solve(&mut self, terms: usize) -> Option<Solution> {
        let r = self.triangle();
        let triangle = r.view((0, 0), (terms, terms)).into_owned();
        let condition = condition(&triangle).filter(|&condition| condition <= MOST_CONDITION)?;
        let inverse = triangle.solve_upper_triangular(&DMatrix::identity(terms, terms))?;
        let freedom = (self.rows as f64 - terms as f64).max(1.0);
        let mut solution = Solution {
            coefficients: Vec::new(),
            sigmas: Vec::new(),
            correlations: correlations(&inverse),
            rms: Vec::new(),
            condition,
        };
        for (column, within) in (self.regressors..self.width).zip(&self.within) {
            let target = DVector::from_fn(terms, |i, _| r[(i, column)]);
            let coefficients = triangle.solve_upper_triangular(&target)?;
            let between = r.view((terms, column), (column + 1 - terms, 1));
            let residual = (between.norm_squared() + within).sqrt();
            if !residual.is_finite() {
                return None;
            }
            solution.coefficients.push(coefficients.as_slice().to_vec());
            solution.rms.push(residual / (self.rows as f64).sqrt());
            let scale = residual / freedom.sqrt();
            let sigmas = inverse.row_iter().map(|row| scale * row.norm());
            solution.sigmas.push(sigmas.collect());
        }
        Some(solution)
    }
}

/// Condition number of the columns, each scaled to unit length; `None` where one has no length or
/// is not finite.
fn condition(columns: &DMatrix<f64>) -> Option<f64> {
    let count = columns.ncols();
    let lengths: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
    if !lengths
        .iter()
        .all(|&length| length > 0.0 && length.is_finite())
    {
        return None;
    }
    let scaled = DMatrix::from_fn(count, count, |i, j| columns[(i, j)] / lengths[j]);
    // The library's own precision; it would go on for ever without a limit.
    let (epsilon, steps) = (5.0 * f64::EPSILON, MOST_STEPS * count);
    let singular = SVD::try_new(scaled, false, false, epsilon, steps)?.singular_values;
    Some(singular.max() / singular.min())
}

/// Cosines of the angles between the rows of the inverse triangle.
fn correlations(inverse: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let of_row = |i: usize| {
        let cosine = |j: usize| {
            let (a, b) = (inverse.row(i), inverse.row(j));
            a.dot(&b) / (a.norm() * b.norm())
        };
        (0..inverse.nrows()).map(cosine).collect()
    };
    (0..inverse.nrows()).map(of_row).collect()
}

/// Root mean squares of a regressor, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Independence {
    /// Of all of it.
    pub whole: f64,
    /// Of the part that the regressors before it cannot represent.
    pub independent: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(count: usize) -> impl Iterator<Item = [f64; 5]> {
        (0..count).map(|i| {
            let z = (i as f64 * 0.37).sin();
            let w = (i as f64 * 0.11).cos();
            let noise = (i as f64 * 12.9898).sin() * 0.01;
            [1.0, z, w, 2.0 - 3.0 * z + 0.5 * w + noise, z * z]
        })
    }

    fn factor(rows: impl Iterator<Item = [f64; 5]>) -> RFactor {
        let mut factor = RFactor::new(3, 2);
        rows.for_each(|row| factor.push(row));
        factor
    }

    #[test]
    fn agrees_with_a_direct_solution() {
        for count in [5, 256, 257, 1000] {
            let all: Vec<_> = rows(count).collect();
            let x = DMatrix::from_fn(count, 3, |i, j| all[i][j]);
            let svd = x.clone().svd(true, true);
            let solution = factor(rows(count)).solve(3).unwrap();
            for (observation, column) in [3, 4].into_iter().enumerate() {
                let y = DVector::from_fn(count, |i, _| all[i][column]);
                let expected = svd.solve(&y, 1e-12).unwrap();
                let rms = (&x * &expected - &y).norm() / (count as f64).sqrt();
                for (found, expected) in solution.coefficients[observation].iter().zip(&expected) {
                    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
                }
                assert!((solution.rms[observation] - rms).abs() < 1e-12);
            }
            let singular = DMatrix::from_fn(count, 3, |i, j| x[(i, j)] / x.column(j).norm());
            let singular = singular.singular_values();
            assert!((solution.condition * singular.min() / singular.max() - 1.0).abs() < 1e-9);
        }
    }

    /// A line through n points at x = +-1 with residuals of +-1: sigma 1 / sqrt(n) of both
    /// coefficients, but for the two degrees of freedom.
    #[test]
    fn sigmas_are_those_of_a_line() {
        let mut factor = RFactor::new(2, 1);
        for i in 0..400 {
            let (x, residual) = (f64::from(i % 2 * 2 - 1), f64::from(i / 2 % 2 * 2 - 1));
            factor.push([1.0, x, 5.0 + 2.0 * x + 0.1 * residual]);
        }
        let solution = factor.solve(2).unwrap();
        assert!((solution.coefficients[0][1] - 2.0).abs() < 1e-12);
        for sigma in &solution.sigmas[0] {
            assert!((sigma - 0.1 / 398.0_f64.sqrt()).abs() < 1e-12, "{sigma}");
        }
    }

    #[test]
    fn merged_parts_equal_the_whole() {
        let whole = factor(rows(1000)).solve(3).unwrap();
        let mut merged = factor(rows(1000).take(300));
        merged.merge(factor(rows(1000).skip(300)));
        assert_eq!(merged.rows(), 1000);
        let merged = merged.solve(3).unwrap();
        for (a, b) in whole.coefficients.iter().zip(&merged.coefficients) {
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() < 1e-12);
            }
        }
        assert!((whole.rms[0] - merged.rms[0]).abs() < 1e-13);
    }

    #[test]
    fn means_of_rows_with_the_same_regressors_equal_the_rows() {
        let all: Vec<[f64; 5]> = rows(900).collect();
        let (mut by_rows, mut by_means) = (RFactor::new(3, 2), RFactor::new(3, 2));
        for part in all.chunks(9) {
            let regressors = &part[0][..3];
            let mut mean = [0.0; 2];
            let mut squares = [0.0; 2];
            for row in part {
                by_rows.push(regressors.iter().chain(&row[3..]).copied());
                for (mean, value) in mean.iter_mut().zip(&row[3..]) {
                    *mean += value / 9.0;
                }
            }
            for row in part {
                for ((sum, mean), value) in squares.iter_mut().zip(&mean).zip(&row[3..]) {
                    *sum += (value - mean).powi(2);
                }
            }
            by_means.push_mean(9, regressors.iter().chain(&mean).copied(), squares);
        }
        let (by_rows, by_means) = (by_rows.solve(3).unwrap(), by_means.solve(3).unwrap());
        for observation in 0..2 {
            for term in 0..3 {
                let pairs = [
                    (&by_rows.coefficients, &by_means.coefficients),
                    (&by_rows.sigmas, &by_means.sigmas),
                ];
                for (a, b) in pairs {
                    assert!((a[observation][term] - b[observation][term]).abs() < 1e-12);
                }
            }
            assert!((by_rows.rms[observation] - by_means.rms[observation]).abs() < 1e-12);
        }
    }

    #[test]
    fn dependent_regressors_are_seen_and_not_solved() {
        let mut factor = RFactor::new(3, 1);
        for i in 0..100 {
            let z = f64::from(i) / 50.0 - 1.0;
            factor.push([1.0, z, 0.25 + 2.0 * z, z]);
        }
        let independence = factor.independence();
        assert!(independence[1].independent > 0.99 * independence[1].whole);
        assert!(independence[2].whole > 1.0);
        assert!(independence[2].independent < 1e-12);
        assert!(factor.solve(3).is_none());
        assert!(factor.solve(2).is_some());
    }

    /// A column of zeros is what a segment without data gives.
    #[test]
    fn zeros_and_what_is_not_finite_are_not_solved() {
        let solved = |regressor: f64, observation: f64| {
            let mut factor = RFactor::new(4, 1);
            for i in 0..100 {
                let z = f64::from(i) / 50.0 - 1.0;
                let (regressor, observation) = match i {
                    40.. => (regressor, observation),
                    _ => (0.0, z),
                };
                factor.push([1.0, z, z * z, regressor, observation]);
            }
            factor.solve(4).is_some()
        };
        assert!(solved(1.0, 2.0));
        for regressor in [0.0, f64::NAN, f64::INFINITY, 1e300] {
            assert!(!solved(regressor, 2.0), "{regressor}");
        }
        for observation in [f64::NAN, f64::NEG_INFINITY, 1e300] {
            assert!(!solved(1.0, observation), "{observation}");
        }
    }
}
