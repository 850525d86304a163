//! The arithmetic of the trials: means over time, rms about a mean, geometric mean.

/// A mean over a stretch of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mean {
    /// Begin of the stretch, from the first row on \[s\].
    pub(crate) begin_s: f64,
    /// Mean of its rows.
    pub(crate) value: f64,
}

/// Means of `values` over stretches of `tau_s`, from the first row on. The last stretch is left
/// out, since it may be cut short; so is a stretch without a row.
pub(crate) fn means(time_s: &[f64], values: &[f64], tau_s: f64) -> Vec<Mean> {
    let Some(first_s) = time_s.first() else {
        return Vec::new();
    };
    let stretch = |time_s: &f64| ((time_s - first_s) / tau_s).floor();
    let mut means = Vec::new();
    let mut begin = 0;
    for end in 1..time_s.len() {
        if stretch(&time_s[end]) != stretch(&time_s[begin]) {
            means.push(Mean {
                begin_s: tau_s * stretch(&time_s[begin]),
                value: mean(&values[begin..end]),
            });
            begin = end;
        }
    }
    means
}

/// Arithmetic mean; NaN of nothing.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Root mean square about `centre`.
pub(crate) fn rms_about(values: &[f64], centre: f64) -> f64 {
    let squares: Vec<f64> = values
        .iter()
        .map(|value| (value - centre).powi(2))
        .collect();
    mean(&squares).sqrt()
}

/// Geometric mean of positive numbers; NaN of nothing.
pub(crate) fn geometric_mean(values: &[f64]) -> f64 {
    let logarithms: Vec<f64> = values.iter().map(|value| value.ln()).collect();
    mean(&logarithms).exp()
}

/// The largest of positive numbers; 0 of nothing.
pub(crate) fn worst(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_of_whole_stretches_from_the_first_row_on() {
        let time_s: Vec<f64> = (0..25).map(|row| 7.0 + f64::from(row)).collect();
        let values: Vec<f64> = (0..25).map(f64::from).collect();
        let expected = [(0.0, 4.5), (10.0, 14.5)];
        let expected = expected.map(|(begin_s, value)| Mean { begin_s, value });
        assert_eq!(means(&time_s, &values, 10.0), expected);
        assert_eq!(means(&[], &[], 10.0), []);
    }

    #[test]
    fn a_stretch_without_rows_has_no_mean() {
        let found = means(&[0.0, 1.0, 35.0, 41.0], &[1.0, 3.0, 5.0, 7.0], 10.0);
        let begins: Vec<f64> = found.iter().map(|mean| mean.begin_s).collect();
        assert_eq!(begins, [0.0, 30.0]);
        assert_eq!(found[0].value, 2.0);
    }

    #[test]
    fn the_geometric_mean_is_of_ratios() {
        assert!((geometric_mean(&[0.5, 2.0]) - 1.0).abs() < 1e-15);
        assert!((geometric_mean(&[0.1, 0.1, 0.8]) - 0.2).abs() < 1e-15);
        assert_eq!(worst(&[0.5, 2.0, 1.0]), 2.0);
    }

    #[test]
    fn rms_is_about_the_given_centre() {
        assert_eq!(rms_about(&[3.0, 5.0], 4.0), 1.0);
        assert_eq!(rms_about(&[3.0, 5.0], 0.0), 17.0_f64.sqrt());
    }
}
