//! How figures are written.

use tempco_set::Candidate;

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

/// A time in seconds, with the decimals it needs, at most two.
pub(crate) fn seconds(value: f64) -> String {
    let text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    format!("{short} s")
}

/// A share in per cent; nothing where it could not be formed.
pub fn percent(share: f64) -> String {
    if share.is_finite() {
        format!("{:+.1} %", 100.0 * share)
    } else {
        "-".to_owned()
    }
}

/// Half widths and time constant of the states, such as `3 degC + 4500 s`.
pub fn states(of: &Candidate) -> String {
    let plays = of
        .half_widths_c
        .iter()
        .map(|&width| format!("{} degC", figure(width)));
    let slow = of.slow_tau_s.map(|tau_s| format!("{tau_s:.0} s"));
    let all: Vec<String> = plays.chain(slow).collect();
    if all.is_empty() {
        "-".to_owned()
    } else {
        all.join(" + ")
    }
}

#[cfg(test)]
mod tests {
    use super::figure;

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
}
