//! How figures are written in messages, tables and pages.

/// A figure in four significant digits.
pub fn figure(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-4..1e5).contains(&magnitude) {
        let decimals = (3 - magnitude.log10().floor() as i32).max(0);
        format!("{value:.*}", decimals as usize)
    } else {
        format!("{value:.3e}")
    }
}

/// A share in per cent; nothing where it could not be formed.
pub fn percent(share: f64) -> String {
    if share.is_finite() {
        format!("{:+.1} %", 100.0 * share)
    } else {
        "-".to_owned()
    }
}

/// A difference of this share of the values is rounding.
const DUST: f64 = 1e-9;

/// A difference, or 0 where it is within the rounding of values as large as `scale`.
pub fn without_dust(difference: f64, scale: f64) -> f64 {
    if difference.abs() <= DUST * scale {
        0.0
    } else {
        difference
    }
}

#[cfg(test)]
mod tests {
    use super::{figure, without_dust};

    #[test]
    fn figures_have_four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.012345, "0.01235"),
            (-1.5, "-1.500"),
            (98765.4, "98765"),
            (1.23456e-7, "1.235e-7"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(figure(value), text);
        }
    }

    #[test]
    fn only_rounding_is_dust() {
        assert_eq!(without_dust(1.4e-17, 0.05), 0.0);
        assert_eq!(without_dust(-3e-4, 0.05), -3e-4);
        assert!(without_dust(f64::NAN, 0.05).is_nan());
    }
}
