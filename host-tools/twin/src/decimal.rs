//! Numbers as text, written straight into a row.
//!
//! `itoa` and `zmij` in place of the general formatting, which takes most of the time of writing a
//! log.

/// Appends an integer.
pub(crate) fn push_integer(row: &mut Vec<u8>, value: i64) {
    row.extend_from_slice(itoa::Buffer::new().format(value).as_bytes());
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
    let scale = 10_u64.pow(DECIMALS);
    let scaled = (value * scale as f64).round() as i64;
    if scaled < 0 {
        row.push(b'-');
    }
    let (whole, part) = (scaled.unsigned_abs() / scale, scaled.unsigned_abs() % scale);
    let mut buffer = itoa::Buffer::new();
    row.extend_from_slice(buffer.format(whole).as_bytes());
    row.push(b'.');
    // A one before the part keeps its leading zeros.
    row.extend_from_slice(&buffer.format(scale + part).as_bytes()[1..]);
}

/// Appends the shortest number that reads back as the same `f64`; without exponent for magnitudes
/// from 1e-5 to 1e16, as times have.
pub(crate) fn push_shortest(row: &mut Vec<u8>, value: f64) {
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format(value);
    row.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
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
        for rate_hz in [
            0.01, 0.3, 1.0, 2.0, 7.0, 60.0, 64.0, 100.0, 999.0, 1024.0, 10_000.0,
        ] {
            for i in (0..3_000_000).step_by(97) {
                let value = f64::from(i) / rate_hz;
                assert_eq!(text(|row| push_shortest(row, value)), value.to_string());
            }
        }
        for value in [0.0, -0.0, -2.5, 1e15, 1e-5, 123_456_789_012.5] {
            assert_eq!(text(|row| push_shortest(row, value)), value.to_string());
        }
    }
}
