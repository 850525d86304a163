//! How far a unit is from the others, undisturbed by those that are far.

use tempco_log::median::mean_median;

use crate::outliers::SIGMA_PER_MAD;

/// Units whose |z| is above this are outliers (Iglewicz and Hoaglin, 1993).
pub const OUTLIER_Z: f64 = 3.5;

/// Fewer units than this say nothing about what is usual.
pub const LEAST_UNITS: usize = 5;

/// Standard deviation of a normal distribution over its mean absolute deviation.
const SIGMA_PER_MEAN_DEVIATION: f64 = 1.2533;

/// Robust z-scores: `(x - median) / (1.4826 MAD)`, where MAD is the median absolute deviation.
///
/// Where more than half of the values are equal, MAD is 0 and the mean absolute deviation takes its
/// place. `None` for fewer than [`LEAST_UNITS`] values; 0 where all are equal. Values must be finite.
pub fn robust_z(values: &[f64]) -> Option<Vec<f64>> {
    if values.len() < LEAST_UNITS {
        return None;
    }
    let centre = mean_median(&mut values.to_vec());
    let mut deviations: Vec<f64> = values.iter().map(|value| (value - centre).abs()).collect();
    let mean_deviation = deviations.iter().sum::<f64>() / deviations.len() as f64;
    let sigma = match mean_median(&mut deviations) {
        0.0 => SIGMA_PER_MEAN_DEVIATION * mean_deviation,
        mad => SIGMA_PER_MAD * mad,
    };
    let z = |value: &f64| match sigma {
        0.0 => 0.0,
        sigma => (value - centre) / sigma,
    };
    Some(values.iter().map(z).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_far_unit_does_not_hide_itself() {
        let z = robust_z(&[1.0, 1.1, 0.9, 1.05, 0.95, 50.0]).unwrap();
        assert!(
            z[5] > 100.0 && z[..5].iter().all(|z| z.abs() < 2.0),
            "{z:?}"
        );
        // By hand: median 3, deviations 2 1 0 1 97, MAD 1.
        let z = robust_z(&[1.0, 2.0, 3.0, 4.0, 100.0]).unwrap();
        assert!((z[4] - 97.0 / 1.4826).abs() < 1e-12);
    }

    #[test]
    fn equal_values_have_a_scale_too() {
        assert_eq!(robust_z(&[2.0; 5]), Some(vec![0.0; 5]));
        let z = robust_z(&[2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 9.0]).unwrap();
        assert!(z[0] == 0.0 && z[7] > OUTLIER_Z, "{z:?}");
        assert_eq!(robust_z(&[1.0, 2.0, 3.0, 4.0]), None);
    }
}
