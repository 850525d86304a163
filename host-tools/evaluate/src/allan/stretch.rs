//! The part of a log that has rows at a constant interval.

use std::ops::Range;

/// The longest run of rows without a gap: each interval between half of and one and a half times
/// `interval_s`. The first of equally long ones; empty for an empty log.
pub fn longest_stretch(time_s: &[f64], interval_s: f64) -> Range<usize> {
    let regular = (0.5 * interval_s)..=(1.5 * interval_s);
    let mut longest = 0..0;
    let mut start = 0;
    for row in 0..time_s.len() {
        if row > 0 && !regular.contains(&(time_s[row] - time_s[row - 1])) {
            start = row;
        }
        if row + 1 - start > longest.len() {
            longest = start..row + 1;
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::longest_stretch;

    #[test]
    fn gaps_end_a_stretch_and_jitter_does_not() {
        assert_eq!(longest_stretch(&[], 1.0), 0..0);
        assert_eq!(longest_stretch(&[3.0], 1.0), 0..1);
        let time_s = [0.0, 1.0, 2.4, 3.0, 5.0, 6.0, 6.2, 7.0, 8.0, 9.0, 9.9, 11.0];
        assert_eq!(longest_stretch(&time_s, 1.0), 6..12);
        assert_eq!(longest_stretch(&time_s[..6], 1.0), 0..4);
    }
}
