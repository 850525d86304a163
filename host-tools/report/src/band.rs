//! The uncertainty of the static part of a fit.

use tempco_set::AxisSet;

/// 1 sigma of the static bias at a temperature \[unit of the axis\]; where segments overlap, the
/// larger one. None outside of all segments or where no uncertainty is known.
pub(crate) fn sigma_at(axis: &AxisSet, temp_c: f64) -> Option<f64> {
    let of_segments = axis.polynomials.iter().zip(&axis.sigmas);
    of_segments
        .filter(|(polynomial, _)| polynomial.z(temp_c).abs() <= 1.0 + 1e-6)
        .map(|(polynomial, sigmas)| {
            let z = polynomial.z(temp_c);
            let mut power = 1.0;
            let parts = sigmas.a.map(|sigma| {
                let part = power * sigma;
                power *= z;
                part
            });
            let mut variance = 0.0;
            for (i, first) in parts.iter().enumerate() {
                variance += first * first;
                for (j, second) in parts.iter().enumerate().skip(i + 1) {
                    variance += 2.0 * sigmas.correlation[i][j] * first * second;
                }
            }
            variance.max(0.0).sqrt()
        })
        .reduce(f64::max)
}
