//! Numbers as text, written straight into a row.
//!
//! The general formatting of `f64` and of integers, which is right at any magnitude and width, takes
//! most of the time of writing a log. The numbers of a log are small enough to be scaled to integers.

use std::io::Write;

/// Appends an integer.
pub(crate) fn push_integer(row: &mut Vec<u8>, value: i64) {
    push_scaled(row, value, 0);
}

/// Appends a number rounded to `DECIMALS` decimals, never as minus zero; what is no number as `NaN`.
///
/// The magnitude times `10^DECIMALS` must stay below 2^53. Where the next decimals are within
/// rounding error of one half, the last digit may come out either way.
pub(crate) fn push_decimal<const DECIMALS: u32>(row: &mut Vec<u8>, value: f64) {
    if value.is_nan() {
        row.extend_from_slice(b"NaN");
        return;
    }
    let scaled = (value * 10_u64.pow(DECIMALS) as f64).round() as i64;
    push_scaled(row, scaled, DECIMALS as usize);
}

/// Appends the shortest number that reads back as the same `f64`.
pub(crate) fn push_shortest(row: &mut Vec<u8>, value: f64) {
    const DECIMALS: usize = 6;
    const SCALE: f64 = 1e6;
    let scaled = (value * SCALE).round();
    // Two decimals of up to 15 digits never read as the same number, so that one of them that reads
    // as the value is the shortest once its zeros are gone.
    if scaled.abs() < 1e15 && scaled / SCALE == value && value != 0.0 {
        push_scaled(row, scaled as i64, DECIMALS);
        while row.last() == Some(&b'0') {
            row.pop();
        }
        if row.last() == Some(&b'.') {
            row.pop();
        }
    } else {
        write!(row, "{value}").expect("a vector takes everything");
    }
}

/// Appends `scaled / 10^decimals`.
fn push_scaled(row: &mut Vec<u8>, scaled: i64, decimals: usize) {
    // Filled from the right: 19 digits at most, a point and a sign.
    let mut text = [b'0'; 21];
    let mut begin = text.len();
    let mut rest = scaled.unsigned_abs();
    let mut digits = 0;
    while rest > 0 || digits <= decimals {
        if digits == decimals && decimals > 0 {
            begin -= 1;
            text[begin] = b'.';
        }
        begin -= 1;
        text[begin] = b'0' + (rest % 10) as u8;
        rest /= 10;
        digits += 1;
    }
    if scaled < 0 {
        begin -= 1;
        text[begin] = b'-';
    }
    row.extend_from_slice(&text[begin..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(push: impl FnOnce(&mut Vec<u8>)) -> String {
        let mut row = Vec::new();
        push(&mut row);
        String::from_utf8(row).unwrap()
    }

    fn decimal<const DECIMALS: u32>(value: f64) -> String {
        text(|row| push_decimal::<DECIMALS>(row, value))
    }

    #[test]
    fn decimals_agree_with_the_standard_formatting() {
        for i in -20_000..20_000 {
            // Steps of an odd fraction, far from halves of the last digit.
            let value = f64::from(i) * 0.012_345_67;
            assert_eq!(decimal::<9>(value), format!("{value:.9}"));
            // Multiples of a sensor's step are exact.
            let value = f64::from(i) * 0.0625;
            assert_eq!(decimal::<4>(value), format!("{value:.4}"));
        }
    }

    #[test]
    fn small_and_large_numbers_have_all_their_digits() {
        assert_eq!(decimal::<4>(f64::NAN), "NaN");
        assert_eq!(decimal::<4>(0.0), "0.0000");
        assert_eq!(decimal::<4>(-0.000_01), "0.0000");
        assert_eq!(decimal::<4>(-0.000_1), "-0.0001");
        assert_eq!(decimal::<6>(9.999_999_9), "10.000000");
        assert_eq!(decimal::<6>(-123_456.789), "-123456.789000");
        assert_eq!(decimal::<6>(f64::MIN), "-9223372036854.775808");
        for value in [0, 7, -7, 10, -120, i64::MAX, i64::MIN] {
            assert_eq!(text(|row| push_integer(row, value)), value.to_string());
        }
    }

    #[test]
    fn the_shortest_number_is_that_of_the_standard_formatting() {
        for rate_hz in [0.01, 0.3, 1.0, 2.0, 7.0, 60.0, 64.0, 100.0, 999.0, 1024.0] {
            for i in (0..3_000_000).step_by(97) {
                let value = f64::from(i) / rate_hz;
                assert_eq!(text(|row| push_shortest(row, value)), value.to_string());
            }
        }
        for value in [0.0, -0.0, -2.5, 1e15, 1e-7, 123_456_789_012.5, f64::MAX] {
            assert_eq!(text(|row| push_shortest(row, value)), value.to_string());
        }
    }
}
