//! Corrections in whole pulses, without losing the parts.
//!
//! A gyro that puts out pulses takes corrections in pulses. Rounding each on its own would lose
//! up to half a pulse per sample, a drift as large as the bias that is to go. A carry keeps what
//! was not put out for the next sample: whatever the corrections, the sum of what was put out
//! stays within one pulse of their sum, for ever.

use crate::FixedError;
use crate::format::{power_of_two, round};
use crate::mask::saturating_difference;

/// Half a pulse, so that the first sample is already rounded to the nearest.
const fn half(fraction_bits: u32) -> i64 {
    1 << (fraction_bits - 1)
}

/// Turns a bias rate in fixed point into whole pulses per sample.
///
/// `bias 2^exponent` \[pulses/s\] over `sample_s` is `bias * multiplier / 2^fraction_bits` pulses.
/// That product is exact and so is the carry: the sum of the pulses differs from the sum of the
/// products by at most half a pulse after any number of samples. The multiplier has 31 bits, or as
/// many as 62 fractional bits leave: its rounding is worth half a pulse in 10^9 pulses, or 2^-33
/// pulses per sample of the largest bias, whichever is more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PulseCarry {
    multiplier: i32,
    /// Fractional bits of a pulse, beyond 32.
    shift: u32,
    /// What was not put out yet \[2^-fraction_bits pulses\], 0 to below 1 pulse.
    remainder: i64,
}

impl PulseCarry {
    /// A carry for biases of `2^exponent` pulses/s and gyro samples every `sample_s` \[s\].
    ///
    /// # Errors
    /// [`FixedError::Pulses`] if a bias of 2^30 would be less than 2^-30 or more than 2^28 pulses
    /// per sample, or `sample_s` is not a positive number.
    pub const fn new(exponent: i32, sample_s: f32) -> Result<Self, FixedError> {
        let positive = sample_s > 0.0 && sample_s < f32::INFINITY;
        if !positive || exponent < -100 || exponent > 100 {
            return Err(FixedError::Pulses);
        }
        let per_place = power_of_two(exponent) * sample_s as f64;
        let mut fraction_bits = 0;
        // The largest multiplier of 31 bits; in more than 62 fractional bits the remainder would
        // not fit.
        while fraction_bits <= 92 && per_place * power_of_two(fraction_bits + 1) < 2_147_483_647.0 {
            fraction_bits += 1;
        }
        if fraction_bits < 32 || fraction_bits > 90 {
            return Err(FixedError::Pulses);
        }
        let fraction_bits = if fraction_bits > 62 {
            62
        } else {
            fraction_bits
        };
        Ok(Self {
            multiplier: round(per_place * power_of_two(fraction_bits)),
            shift: fraction_bits as u32 - 32,
            remainder: half(fraction_bits as u32),
        })
    }

    /// The whole pulses that a sample's bias is worth, with what former samples left over.
    ///
    /// Any i32 is taken, and nothing saturates: a product is below 2^62.
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline]
    pub const fn pulses(&mut self, bias: i32) -> i32 {
        let sum = self.remainder + bias as i64 * self.multiplier as i64;
        let upper = (sum >> 32) as i32;
        let whole = upper >> self.shift;
        let fraction = upper - (whole << self.shift);
        self.remainder = ((fraction as i64) << 32) | (sum as u32 as i64);
        whole
    }

    /// A sample's counts less the pulses of its bias; saturates at the ends of an i32, which
    /// counts within 2^30 do not reach.
    #[inline]
    pub const fn compensate(&mut self, counts: i32, bias: i32) -> i32 {
        saturating_difference(counts, self.pulses(bias)).0
    }

    /// Pulses per sample for each last place of the bias, as the multiplier has them.
    pub const fn pulses_per_place(&self) -> f64 {
        self.multiplier as f64 * power_of_two(-32 - self.shift as i32)
    }
}

/// Turns corrections in pulses per sample, as f32, into whole pulses.
///
/// The carry has 62 fractional bits and is exact for every f32 from 2^-38 pulses on; of smaller
/// ones less than 2^-62 pulses per sample is lost. A correction that is not a number counts as
/// none, and one beyond 2^30 pulses as 2^30: the carry itself can become neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PulseCarryF32 {
    /// What was not put out yet \[2^-62 pulses\], 0 to below 1 pulse.
    remainder: i64,
}

impl Default for PulseCarryF32 {
    fn default() -> Self {
        Self::new()
    }
}

impl PulseCarryF32 {
    /// A carry with nothing to carry yet.
    pub const fn new() -> Self {
        Self {
            remainder: half(62),
        }
    }

    /// The whole pulses that a sample's correction \[pulses\] is worth, with what former samples
    /// left over.
    ///
    /// # Timing
    /// No branch depends on the data where the processor has an f32 unit: conversions to i32,
    /// multiplications and selections.
    #[inline]
    pub fn pulses(&mut self, correction: f32) -> i32 {
        const LARGEST: f32 = 1_073_741_824.0;
        const SCALE: f32 = 2_147_483_648.0;
        let correction = if correction > LARGEST {
            LARGEST
        } else {
            correction
        };
        let correction = if correction < -LARGEST {
            -LARGEST
        } else {
            correction
        };
        // Conversions round towards zero and make 0 of NaN; differences and scalings by powers of
        // two are exact, so the three parts are the whole number.
        let whole = correction as i32;
        let rest = (correction - whole as f32) * SCALE;
        let upper = rest as i32;
        let lower = ((rest - upper as f32) * SCALE) as i32;
        let fraction = (i64::from(upper) << 31) + i64::from(lower);
        // Between -1 and 2 pulses, in 2^-62: below 2^63.
        let sum = self.remainder + fraction;
        let carried = (sum >> 62) as i32;
        self.remainder = sum - (i64::from(carried) << 62);
        whole + carried
    }
}
