//! Medians; the order of the values is lost.

/// The median, of an even number of values the greater of the two in the middle; 0 of nothing.
pub fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The median, of an even number of values the mean of the two in the middle; 0 of nothing.
pub fn mean_median(values: &mut [f64]) -> f64 {
    let upper = median(values);
    if values.len() % 2 == 1 {
        return upper;
    }
    // The smaller half stands before it.
    let lower = values[..values.len() / 2].iter().copied().reduce(f64::max);
    0.5 * (lower.unwrap_or(upper) + upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_medians_differ_for_even_numbers_only() {
        for (values, upper, mean) in [
            (&[][..], 0.0, 0.0),
            (&[3.0], 3.0, 3.0),
            (&[4.0, 1.0], 4.0, 2.5),
            (&[5.0, -1.0, 2.0], 2.0, 2.0),
            (&[8.0, 1.0, 2.0, 4.0], 4.0, 3.0),
        ] {
            assert_eq!(median(&mut values.to_vec()), upper);
            assert_eq!(mean_median(&mut values.to_vec()), mean);
        }
    }
}
