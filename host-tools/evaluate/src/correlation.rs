//! Whether what remains still follows the temperature.

use serde::Serialize;

/// Pearson's correlation coefficient of an axis with the temperature and its rate.
///
/// Of the means over `tau`, so that the noise of single rows does not hide a trend.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Correlation {
    /// With the lag-compensated temperature, -1 to 1.
    pub temperature: f64,
    /// With the rate of temperature, -1 to 1.
    pub rate: f64,
}

/// Pearson's r; `None` where there are fewer than three pairs or one of the series stands still.
pub(super) fn pearson(a: &[f64], b: &[f64]) -> Option<f64> {
    let n = a.len().min(b.len());
    if n < 3 {
        return None;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        aa += a * a;
        bb += b * b;
        ab += a * b;
    }
    let r = ab / (aa.sqrt() * bb.sqrt());
    r.is_finite().then(|| r.clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::pearson;

    #[test]
    fn r_is_that_of_the_definition() {
        let a = [1.0, 2.0, 3.0, 4.0];
        for (b, expected) in [
            ([3.0, 5.0, 7.0, 9.0], 1.0),
            ([9.0, 7.0, 5.0, 3.0], -1.0),
            ([1.0, -1.0, -1.0, 1.0], 0.0),
            ([1.0, 3.0, 2.0, 4.0], 0.8),
        ] {
            let r = pearson(&a, &b).unwrap();
            assert!((r - expected).abs() < 1e-15, "{r} {expected}");
        }
    }

    #[test]
    fn nothing_is_said_of_a_series_that_stands_still_or_is_too_short() {
        assert_eq!(pearson(&[1.0, 1.0, 1.0], &[1.0, 2.0, 3.0]), None);
        assert_eq!(pearson(&[1.0, 2.0], &[1.0, 2.0]), None);
    }
}
