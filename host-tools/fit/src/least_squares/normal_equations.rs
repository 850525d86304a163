//! Normal equations of sparse rows, from which parts can be taken off again: reference fits of
//! outliers and the cubic of held-out errors. Coefficients of a set come from elsewhere.

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
}

impl Gram {
    pub(crate) fn new(columns: usize, observations: usize) -> Self {
        Self {
            columns,
            products: vec![0.0; columns * columns],
            targets: vec![vec![0.0; columns]; observations],
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
        for (y, target) in observations.zip(&mut self.targets) {
            let weighted = weight * y;
            for &(i, a) in row {
                target[i] += weighted * a;
            }
        }
    }

    /// The sums over the rows that are not in `part`.
    pub(crate) fn without(&self, part: &Self) -> Self {
        let mut rest = self.clone();
        let subtract = |from: &mut [f64], what: &[f64]| {
            for (from, what) in from.iter_mut().zip(what) {
                *from -= what;
            }
        };
        subtract(&mut rest.products, &part.products);
        for (from, what) in rest.targets.iter_mut().zip(&part.targets) {
            subtract(from, what);
        }
        rest
    }

    /// Coefficients for each observation; `None` where the rows are too few.
    pub(crate) fn solve(&self) -> Option<Vec<Vec<f64>>> {
        let n = self.columns;
        let mean = (0..n).map(|i| self.products[i * n + i]).sum::<f64>() / n as f64;
        let ridged = DMatrix::from_fn(n, n, |i, j| {
            let product = self.products[i.min(j) * n + i.max(j)];
            product + if i == j { RIDGE * mean } else { 0.0 }
        });
        let factor = ridged.cholesky()?;
        let solve = |target: &Vec<f64>| {
            let solution = factor.solve(&DVector::from_column_slice(target));
            solution.as_slice().to_vec()
        };
        Some(self.targets.iter().map(solve).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(range: std::ops::Range<usize>, weight: f64) -> Gram {
        let mut gram = Gram::new(3, 1);
        for i in range {
            let x = (i as f64 * 0.7).sin();
            let y = 1.0 - 2.0 * x + 0.5 * x * x + 0.01 * (i as f64 * 12.9898).sin();
            gram.push(&[(0, 1.0), (1, x), (2, x * x)], [y].into_iter(), weight);
        }
        gram
    }

    fn difference(a: &Gram, b: &Gram) -> f64 {
        let [a, b] = [a, b].map(|gram| gram.solve().unwrap().remove(0));
        let pairs = a.iter().zip(&b);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn parts_come_off_again() {
        let whole = rows(0..500, 2.0);
        let rest = whole.without(&rows(0..200, 2.0));
        assert!(difference(&rest, &rows(200..500, 2.0)) < 1e-12);
        assert!(difference(&whole, &rows(200..500, 2.0)) > 1e-6);
    }

    /// A row of weight 3 is three rows.
    #[test]
    fn a_weight_is_a_number_of_rows() {
        let mut once = rows(0..100, 1.0);
        let mut thrice = once.clone();
        let row = [(0, 1.0), (1, 0.3), (2, 0.1)];
        once.push(&row, [5.0].into_iter(), 3.0);
        for _ in 0..3 {
            thrice.push(&row, [5.0].into_iter(), 1.0);
        }
        assert!(difference(&once, &thrice) < 1e-12);
        assert!(difference(&once, &rows(0..100, 1.0)) > 1e-3);
    }
}
