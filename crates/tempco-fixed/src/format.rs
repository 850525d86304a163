//! Numbers of the real world in the formats of this crate.

/// Fractional bits of temperatures \[degC\] and rates \[degC/min\]: a last place of 9.5e-7.
pub const FRACTION_BITS: u32 = 20;

/// One degC, or one degC/min.
pub(crate) const ONE: f64 = (1_u32 << FRACTION_BITS) as f64;

/// In place of a temperature or a gyro sample: there is none.
///
/// No sensor can report -2048 degC, so an invalid temperature needs no case of its own.
pub const INVALID: i32 = i32::MIN;

/// A temperature in thousandths of a degC, to 1e-6 degC; beyond -2047..2047 degC, [`INVALID`].
///
/// ```
/// assert_eq!(tempco_fixed::from_milli_c(25_000), 25 << 20);
/// assert_eq!(tempco_fixed::from_milli_c(i32::MAX), tempco_fixed::INVALID);
/// ```
pub const fn from_milli_c(milli_c: i32) -> i32 {
    /// `2^20 / 1000` with 32 more bits.
    const PER_MILLI: i64 = ((1 << 52) + 500) / 1000;
    if milli_c < -2_047_000 || milli_c > 2_047_000 {
        return INVALID;
    }
    ((milli_c as i64 * PER_MILLI + (1 << 31)) >> 32) as i32
}

/// A temperature in `2^-bits` degC, as digital sensors have it (4 bits: steps of 0.0625 degC);
/// what does not fit, and more than 20 bits, is [`INVALID`].
///
/// ```
/// assert_eq!(tempco_fixed::from_binary_c(-401, 4), -((25 << 20) + (1 << 16)));
/// ```
pub const fn from_binary_c(temp: i32, bits: u32) -> i32 {
    if bits > FRACTION_BITS {
        return INVALID;
    }
    let wide = (temp as i64) << (FRACTION_BITS - bits);
    if wide < -(i32::MAX as i64) || wide > i32::MAX as i64 {
        return INVALID;
    }
    wide as i32
}

/// A temperature \[degC\] or rate \[degC/min\] from f32, for constants and hosts; NaN and what
/// does not fit is [`INVALID`].
pub const fn from_f32(value: f32) -> i32 {
    let scaled = value as f64 * ONE;
    // NaN fails the comparison.
    if scaled > -(i32::MAX as f64) && scaled < i32::MAX as f64 {
        round(scaled)
    } else {
        INVALID
    }
}

/// A temperature \[degC\] or rate \[degC/min\] as f32, for hosts.
pub const fn to_f32(value: i32) -> f32 {
    (value as f64 / ONE) as f32
}

/// To the nearest, ties away from zero; saturates.
pub(crate) const fn round(value: f64) -> i32 {
    let half = if value < 0.0 { -0.5 } else { 0.5 };
    (value + half) as i32
}

/// To the nearest; saturates.
pub(crate) const fn round_u64(value: f64) -> u64 {
    (value + 0.5) as u64
}

/// `2^exponent`, for exponents of -1022 to 1023.
pub(crate) const fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn temperatures_are_rounded_to_the_last_place() {
        for milli in (-60_000..150_000).chain([-2_047_000, 2_047_000]) {
            let exact = f64::from(milli) * 1e-3 * ONE;
            assert!((f64::from(from_milli_c(milli)) - exact).abs() < 0.501);
            let c = milli as f32 * 1e-3;
            assert!((f64::from(from_f32(c)) - f64::from(c) * ONE).abs() <= 0.5);
        }
        for (temp, bits) in [(1 << 30, 4), (0, 21), (i32::MIN, 20), (i32::MIN, 0)] {
            assert_eq!(from_binary_c(temp, bits), INVALID);
        }
        assert_eq!(from_binary_c(-3, 20), -3);
        for wrong in [f32::NAN, f32::INFINITY, -2048.0, 2048.0, 1e30] {
            assert_eq!(from_f32(wrong), INVALID);
        }
        assert_eq!(to_f32(from_f32(-273.15)), -273.15);
        assert_eq!(power_of_two(-3), 0.125);
    }
}
