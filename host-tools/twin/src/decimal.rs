//! Numbers with a fixed count of decimals.
//!
//! A truth file has six such numbers in a row, and the general formatting of `f64`, which is
//! right at any magnitude, takes most of the time of writing it. Temperatures and biases are small
//! enough to be scaled to an integer.

use core::fmt;

/// Displays a number rounded to `DECIMALS` decimals, never as minus zero.
///
/// The magnitude times `10^DECIMALS` must stay below 2^53. Where the next decimals are within
/// rounding error of one half, the last digit may come out either way.
pub(crate) struct Decimal<const DECIMALS: usize>(pub(crate) f64);

impl<const DECIMALS: usize> Decimal<DECIMALS> {
    const SCALE: f64 = 10_u64.pow(DECIMALS as u32) as f64;
}

impl<const DECIMALS: usize> fmt::Display for Decimal<DECIMALS> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scaled = (self.0 * Self::SCALE).round() as i64;
        // Filled from the right: 19 digits at most, a point and a sign.
        let mut text = [b'0'; 21];
        let mut begin = text.len();
        let mut rest = scaled.unsigned_abs();
        let mut digits = 0;
        while rest > 0 || digits <= DECIMALS {
            if digits == DECIMALS {
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
        f.write_str(str::from_utf8(&text[begin..]).map_err(|_| fmt::Error)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_standard_formatting() {
        for i in -20_000..20_000 {
            // Steps of an odd fraction, far from halves of the last digit.
            let value = f64::from(i) * 0.012_345_67;
            assert_eq!(Decimal::<9>(value).to_string(), format!("{value:.9}"));
            // Multiples of a sensor's step are exact.
            let value = f64::from(i) * 0.0625;
            assert_eq!(Decimal::<4>(value).to_string(), format!("{value:.4}"));
        }
    }

    #[test]
    fn small_and_large_numbers_have_all_their_digits() {
        assert_eq!(Decimal::<4>(0.0).to_string(), "0.0000");
        assert_eq!(Decimal::<4>(-0.000_01).to_string(), "0.0000");
        assert_eq!(Decimal::<4>(-0.000_1).to_string(), "-0.0001");
        assert_eq!(Decimal::<6>(9.999_999_9).to_string(), "10.000000");
        assert_eq!(Decimal::<6>(-123_456.789).to_string(), "-123456.789000");
        assert_eq!(Decimal::<6>(f64::MIN).to_string(), "-9223372036854.775808");
    }
}
