//! The exponential of a matrix of heat flow.

/// `exp(a h)` for a matrix whose entries off the diagonal are not negative, `h >= 0`.
///
/// With `a = b - r I` and `b` without negative entries, `exp(a h) = exp(b h) exp(-r h)`, and both the
/// Taylor series of the first factor at `h / 2^n` and its n squarings add and multiply numbers of one
/// sign only: nothing cancels, so that every entry, however small, has a relative error of some
/// `2^n` roundings.
pub(crate) fn exp_of_flow<const N: usize>(a: &[[f64; N]; N], h: f64) -> [[f64; N]; N] {
    const TERMS: u32 = 14;
    let rate = (0..N).map(|i| -a[i][i]).fold(0.0, f64::max);
    let mut squarings = 0;
    let mut part_s = h;
    // With the largest product at most 1/2, fourteen terms leave less than a rounding.
    while rate * part_s > 0.5 {
        part_s *= 0.5;
        squarings += 1;
    }
    let decay = libm::exp(-rate * part_s);
    let mut term = identity::<N>();
    let mut sum = identity::<N>();
    for order in 1..=TERMS {
        let mut flow = *a;
        for (i, row) in flow.iter_mut().enumerate() {
            row[i] += rate;
            for entry in row.iter_mut() {
                *entry *= part_s / f64::from(order);
            }
        }
        term = product(&term, &flow);
        for (row, term) in sum.iter_mut().zip(&term) {
            for (entry, term) in row.iter_mut().zip(term) {
                *entry += term;
            }
        }
    }
    for entry in sum.iter_mut().flatten() {
        *entry *= decay;
    }
    for _ in 0..squarings {
        sum = product(&sum, &sum);
    }
    sum
}

fn identity<const N: usize>() -> [[f64; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))
}

fn product<const N: usize>(a: &[[f64; N]; N], b: &[[f64; N]; N]) -> [[f64; N]; N] {
    core::array::from_fn(|i| {
        core::array::from_fn(|j| (0..N).fold(0.0, |sum, k| sum + a[i][k] * b[k][j]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_lags_in_a_row_have_the_closed_form() {
        // e = exp(-h/s), f = (exp(-h/c) - exp(-h/s)) / (c (1/s - 1/c)), worked out for each pair.
        for (s, c, h) in [
            (360.0_f64, 300.0_f64, 0.5_f64),
            (360.0, 300.0, 500.0),
            (20.0, 5000.0, 3000.0),
            (5.0, 0.01, 1.0),
        ] {
            let a = [[-1.0 / s, 0.0], [1.0 / c, -1.0 / c]];
            let m = exp_of_flow(&a, h);
            let (es, ec) = ((-h / s).exp(), (-h / c).exp());
            let across = (es - ec) / (1.0 - s.recip() * c) * 1.0;
            for (found, expected) in [(m[0][0], es), (m[1][1], ec), (m[1][0], across)] {
                let error = (found - expected).abs();
                assert!(
                    error <= 1e-10 * expected + 1e-16,
                    "{s} {c} {h}: {found} {expected}"
                );
            }
            assert_eq!(m[0][1], 0.0);
        }
    }

    #[test]
    fn equal_lags_are_no_exception() {
        let a = [[-0.01, 0.0], [0.01, -0.01]];
        let m = exp_of_flow(&a, 100.0);
        assert!((m[1][0] - (-1.0_f64).exp()).abs() < 1e-14);
    }

    #[test]
    fn no_time_changes_nothing() {
        assert_eq!(exp_of_flow(&[[-3.0]], 0.0), [[1.0]]);
    }
}
