//! The least squares of the spline model are those of scipy and numpy on the same rows.
//!
//! `tests/spline/reference.py` wrote `tests/spline/reference.csv`.

use crate::least_squares::{Basis, RFactor, RateForm, SparseRow};

/// Largest relative deviation.
const ALLOWED: f64 = 1e-9;

#[test]
fn coefficients_and_sigmas_are_those_of_scipy() {
    let breakpoints = vec![-15.0, 2.0, 20.0, 31.5, 55.0, 80.0];
    let basis = Basis::new(breakpoints, RateForm::Hats, 2);
    let mut factor = RFactor::new(basis.columns(), 1);
    let mut row = SparseRow::new();
    for i in 0..2000_u32 {
        let x = f64::from(i);
        let temp_c = 32.5 + 47.5 * (0.0173 * x).sin();
        let rate = 1.3 * (0.0173 * x).cos() + 0.4 * (0.31 * x).sin();
        let log = i as usize * 2 / 2000;
        let value = 0.01 * (0.05 * temp_c).cos()
            + 2e-4 * temp_c
            + rate * (0.003 + 4e-5 * temp_c)
            + [0.002, -0.001][log]
            + 0.005 * (12.9898 * x).sin();
        basis.row(log, temp_c, rate, &mut row);
        let mut dense = vec![0.0; basis.columns() + 1];
        for &(column, entry) in &row {
            dense[column] += entry;
        }
        dense[basis.columns()] = value;
        factor.push(dense);
    }
    let solution = factor.solve(basis.columns()).unwrap();
    let text = include_str!("../../tests/spline/reference.csv");
    let lines: Vec<&str> = text.lines().skip(1).collect();
    assert_eq!(lines.len(), basis.columns());
    for (i, line) in lines.into_iter().enumerate() {
        let (value, sigma) = line.split_once(',').unwrap();
        let (value, sigma): (f64, f64) = (value.parse().unwrap(), sigma.parse().unwrap());
        let (found, found_sigma) = (solution.coefficients[0][i], solution.sigmas[0][i]);
        assert!((found / value - 1.0).abs() < ALLOWED, "{found} {value}");
        assert!(
            (found_sigma / sigma - 1.0).abs() < ALLOWED,
            "{found_sigma} {sigma}"
        );
    }
}
