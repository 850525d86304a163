//! Corrections in whole pulses, without losing the parts.
//!
//! A gyro that puts out pulses takes corrections in pulses. Rounding each on its own would lose
//! up to half a pulse per sample, a drift as large as the bias that is to go. A carry keeps what
//! was not put out for the next sample.

use core::hint::select_unpredictable;

/// Fractional bits of the carry.
const FRACTION_BITS: u32 = 62;

/// Turns corrections in pulses per sample into whole pulses.
///
/// With `c` the correction of a sample \[pulses\] and `r` what is carried \[pulses\], 1/2 at the
/// start so that the first sample is already rounded to the nearest:
///
/// ```text
/// n = floor(r + c)        whole pulses to put out
/// r = r + c - n           carried to the next sample, 0 to below 1
/// ```
///
/// The sum of the pulses stays within half a pulse of the sum of the corrections, after any number
/// of samples. The carry has 62 fractional bits and is exact for every f32 from 2^-38 pulses on; of
/// smaller ones less than 2^-62 pulses per sample is lost. A correction that is not a number counts
/// as none, and one beyond 2^30 pulses as 2^30: the carry itself can become neither.
///
/// The correction of a sample is its bias \[pulses/s\] times the sample interval \[s\]; the counts
/// less the pulses are the compensated counts.
///
/// ```
/// let mut carry = tempco::PulseCarry::new();
/// let pulses: [i32; 8] = core::array::from_fn(|_| carry.pulses(0.25));
/// assert_eq!(pulses, [0, 1, 0, 0, 0, 1, 0, 0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PulseCarry {
    /// `r` \[2^-62 pulses\], 0 to below 1 pulse.
    remainder: i64,
}

impl Default for PulseCarry {
    fn default() -> Self {
        Self::new()
    }
}

impl PulseCarry {
    /// A carry before its first sample.
    pub const fn new() -> Self {
        Self {
            remainder: 1 << (FRACTION_BITS - 1),
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
        let correction = select_unpredictable(correction > LARGEST, LARGEST, correction);
        let correction = select_unpredictable(correction < -LARGEST, -LARGEST, correction);
        // Conversions round towards zero and make 0 of NaN; differences and scalings by powers of
        // two are exact, so the three parts are the whole number.
        let whole = correction as i32;
        let rest = (correction - whole as f32) * SCALE;
        let upper = rest as i32;
        let lower = ((rest - upper as f32) * SCALE) as i32;
        let fraction = (i64::from(upper) << 31).wrapping_add(i64::from(lower));
        // Between -1 and 2 pulses, in 2^-62: below 2^63. Nothing here wraps, but the compiler
        // does not know.
        let sum = self.remainder.wrapping_add(fraction);
        let carried = (sum >> FRACTION_BITS) as i32;
        self.remainder = sum.wrapping_sub(i64::from(carried) << FRACTION_BITS);
        whole.wrapping_add(carried)
    }
}
