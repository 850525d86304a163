//! Normal equations of sparse rows, which add and subtract: what the search among models is made
//! of. The final coefficients come from [`RFactor`](crate::least_squares::RFactor) instead.

use nalgebra::{DMatrix, DVector};

/// Added to the diagonal as a share of its mean, so that a column without rows gets 0.
const RIDGE: f64 = 1e-10;

/// Weighted sums of products of rows and observations.
#[derive(Clone, Debug)]
pub(crate) struct Gram {
    columns: usize,
    /// Products of columns, row by row, the upper triangle alone.
    products: Vec<f64>,
    /// Products of columns with each observation.
    targets: Vec<Vec<f64>>,
    /// Sum of squares of each observation.
    squares: Vec<f64>,
    weight: f64,
}

impl Gram {
    pub(crate) fn new(columns: usize, observations: usize) -> Self {
        Self {
            columns,
            products: vec![0.0; columns * columns],
            targets: vec![vec![0.0; columns]; observations],
            squares: vec![0.0; observations],
            weight: 0.0,
        }
    }

    /// Takes in a row whose entries are in ascending order of column.
    pub(crate) fn push(
        &mut self,
        row: &[(usize, f64)],
        observations: impl Iterator<Item = f64>,
        weight: f64,
    ) {
        for (first, &(i, a)) in row.iter().enumerate() {
            let weighted = weight * a;
            for &(j, b) in &row[first..] {
                self.products[i * self.columns + j] += weighted * b;
            }
        }
        for ((y, target), squares) in observations.zip(&mut self.targets).zip(&mut self.squares) {
            let weighted = weight * y;
            for &(i, a) in row {
                target[i] += weighted * a;
            }
            *squares += weighted * y;
        }
        self.weight += weight;
    }

    /// Adds `sign` times the sums of `other`.
    fn combine(&mut self, other: &Self, sign: f64) {
        let add = |to: &mut [f64], from: &[f64]| {
            for (to, from) in to.iter_mut().zip(from) {
                *to += sign * from;
            }
        };
        add(&mut self.products, &other.products);
        for (to, from) in self.targets.iter_mut().zip(&other.targets) {
            add(to, from);
        }
        add(&mut self.squares, &other.squares);
        self.weight += sign * other.weight;
    }

    /// The sums over the rows of both.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.combine(other, 1.0);
    }

    /// The sums over the rows that are not in `part`.
    pub(crate) fn without(&self, part: &Self) -> Self {
        let mut rest = self.clone();
        rest.combine(part, -1.0);
        rest
    }

    /// The sums of some of the columns, in ascending order.
    pub(crate) fn only(&self, columns: &[usize]) -> Self {
        let mut part = Self::new(columns.len(), self.targets.len());
        for (i, &from_i) in columns.iter().enumerate() {
            for (j, &from_j) in columns.iter().enumerate().skip(i) {
                part.products[i * columns.len() + j] =
                    self.products[from_i * self.columns + from_j];
            }
        }
        for (to, from) in part.targets.iter_mut().zip(&self.targets) {
            for (to, &column) in to.iter_mut().zip(columns) {
                *to = from[column];
            }
        }
        part.squares.clone_from(&self.squares);
        part.weight = self.weight;
        part
    }

    /// The sums of the columns from `first` on after least squares on those before: least squares
    /// on what is left gives their coefficients and the residual of all. `None` where the rows are
    /// too few.
    pub(crate) fn reduced(&self, first: usize) -> Option<Self> {
        let n = self.columns;
        let factor = self.ridged(first).cholesky()?;
        let cross = DMatrix::from_fn(first, n - first, |i, j| self.products[i * n + first + j]);
        let solved = factor.solve(&cross);
        let mut rest = self.only(&(first..n).collect::<Vec<_>>());
        let taken = cross.transpose() * &solved;
        // Where nothing is left there is no row either, and no width of one.
        let width = (n - first).max(1);
        for (i, row) in rest.products.chunks_exact_mut(width).enumerate() {
            for (j, product) in row.iter_mut().enumerate().skip(i) {
                *product -= taken[(i, j)];
            }
        }
        for ((target, squares), whole) in rest
            .targets
            .iter_mut()
            .zip(&mut rest.squares)
            .zip(&self.targets)
        {
            let before = DVector::from_column_slice(&whole[..first]);
            let taken = solved.transpose() * &before;
            for (value, taken) in target.iter_mut().zip(taken.iter()) {
                *value -= taken;
            }
            *squares -= before.dot(&factor.solve(&before));
        }
        Some(rest)
    }

    /// The products of the leading columns.
    fn ridged(&self, columns: usize) -> DMatrix<f64> {
        let n = self.columns;
        let mean = (0..columns).map(|i| self.products[i * n + i]).sum::<f64>() / columns as f64;
        DMatrix::from_fn(columns, columns, |i, j| {
            let product = self.products[i.min(j) * n + i.max(j)];
            product + if i == j { RIDGE * mean } else { 0.0 }
        })
    }

    pub(crate) fn observations(&self) -> usize {
        self.targets.len()
    }

    pub(crate) fn weight(&self) -> f64 {
        self.weight
    }

    /// Coefficients for each observation; `None` where the rows are too few.
    pub(crate) fn solve(&self) -> Option<Vec<Vec<f64>>> {
        let factor = self.ridged(self.columns).cholesky()?;
        let solve = |target: &Vec<f64>| {
            let solution = factor.solve(&DVector::from_column_slice(target));
            solution.as_slice().to_vec()
        };
        Some(self.targets.iter().map(solve).collect())
    }

    /// Sum of squared residuals of an observation with given coefficients.
    pub(crate) fn residual(&self, observation: usize, coefficients: &[f64]) -> f64 {
        let n = self.columns;
        let mut total = self.squares[observation];
        for (i, &a) in coefficients.iter().enumerate() {
            let row = &self.products[i * n..(i + 1) * n];
            let cross: f64 = row[i + 1..]
                .iter()
                .zip(&coefficients[i + 1..])
                .map(|(product, b)| product * b)
                .sum();
            total += a * (2.0 * (cross - self.targets[observation][i]) + row[i] * a);
        }
        total.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns taken out first or kept: the same coefficients and the same residual.
    #[test]
    fn least_squares_may_be_done_in_two_steps() {
        let whole = rows(0..500);
        let reduced = whole.reduced(2).unwrap();
        let (all, rest) = (whole.solve().unwrap(), reduced.solve().unwrap());
        assert!((all[0][2] - rest[0][0]).abs() < 1e-7, "{all:?} {rest:?}");
        let (a, b) = (whole.residual(0, &all[0]), reduced.residual(0, &rest[0]));
        assert!((a - b).abs() < 1e-4 * a, "{a} {b}");
        let two = whole.only(&[0, 2]);
        assert_eq!(two.solve().unwrap()[0].len(), 2);
        assert!(two.residual(0, &two.solve().unwrap()[0]) > 2.0 * a);
    }

    #[test]
    fn all_columns_may_be_taken_out() {
        let whole = rows(0..500);
        let rest = whole.reduced(3).unwrap();
        let (all, none) = (whole.solve().unwrap(), rest.solve().unwrap());
        assert!(none[0].is_empty());
        let (a, b) = (whole.residual(0, &all[0]), rest.residual(0, &[]));
        assert!((a - b).abs() < 1e-4 * a, "{a} {b}");
    }

    fn rows(range: std::ops::Range<usize>) -> Gram {
        let mut gram = Gram::new(3, 1);
        for i in range {
            let x = (i as f64 * 0.7).sin();
            let y = 1.0 - 2.0 * x + 0.5 * x * x + 0.01 * (i as f64 * 12.9898).sin();
            gram.push(&[(0, 1.0), (1, x), (2, x * x)], [y].into_iter(), 2.0);
        }
        gram
    }

    #[test]
    fn parts_add_up_and_come_off_again() {
        let (whole, mut merged) = (rows(0..500), rows(0..200));
        merged.merge(&rows(200..500));
        let expected = whole.solve().unwrap();
        let difference = |gram: &Gram, expected: &[f64]| {
            let found = &gram.solve().unwrap()[0];
            let pairs = found.iter().zip(expected);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        assert!(difference(&merged, &expected[0]) < 1e-12);
        let part = rows(200..500).solve().unwrap();
        assert!(difference(&whole.without(&rows(0..200)), &part[0]) < 1e-12);
        assert_eq!(whole.weight(), 1000.0);
    }

    #[test]
    fn residuals_are_those_of_the_rows() {
        let gram = rows(0..500);
        let coefficients = [1.1, -2.0, 0.4];
        let expected: f64 = (0..500)
            .map(|i| {
                let x = (i as f64 * 0.7).sin();
                let noise = 0.01 * (i as f64 * 12.9898).sin();
                2.0 * (-0.1 + 0.1 * x * x + noise).powi(2)
            })
            .sum();
        assert!((gram.residual(0, &coefficients) / expected - 1.0).abs() < 1e-9);
    }
}
