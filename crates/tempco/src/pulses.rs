//! The sample half for gyros that put out pulses: whole pulses in, whole pulses out.
//!
//! Rounding the bias of each sample on its own would lose up to half a pulse per sample, a drift as
//! large as the bias that is to go. What a sample does not put out is carried to the next one.

use crate::ramp::{Ramp, RampBuffer, not_negative};
use crate::{BiasRamp, Status};

/// Fractional bits of a bias in pulses per sample, and of the carry.
const FRACTION_BITS: u32 = 26;
const PULSE: f32 = (1_u32 << FRACTION_BITS) as f32;
/// The largest bias \[pulses per sample\]: so that the difference of two of them fits.
const LARGEST: f32 = 15.0;

/// A ramp of biases in pulses per sample, in fixed point \[2^-26 pulses per sample\].
pub type PulseRamp<const AXES: usize> = Ramp<i32, AXES>;

impl<const AXES: usize> PulseRamp<AXES> {
    /// Turns a ramp into pulses. `pulses_per_unit` is what one unit of each axis is in pulses per
    /// gyro sample: for deg/h it is 1 / (scale factor \[arcsec/pulse\] * sample rate \[Hz\]).
    ///
    /// The resolution is 2^-26 pulses per sample, both of the bias and of its slope. So the
    /// beginning of a ramp is off by 2^-26 of a pulse for each of its samples at most. A bias beyond
    /// 15 pulses per sample counts as 15, and one that is not a number as none.
    pub fn new(ramp: &BiasRamp<AXES>, pulses_per_unit: [f32; AXES]) -> Self {
        let fixed = |bias: f32, axis: usize| {
            let pulses = bias * pulses_per_unit[axis];
            // The conversion makes 0 of NaN.
            (pulses.clamp(-LARGEST, LARGEST) * PULSE) as i32
        };
        let samples = i32::from(ramp.samples.max(1));
        let end = core::array::from_fn(|axis| fixed(ramp.end[axis], axis));
        let slope = core::array::from_fn(|axis| {
            let before = ramp.end[axis] - ramp.slope[axis] * samples as f32;
            // Rounded towards zero: no bias of the ramp lies beyond its ends.
            end[axis].wrapping_sub(fixed(before, axis)) / samples
        });
        Self {
            end,
            slope,
            samples: ramp.samples,
            status: ramp.status,
        }
    }
}

/// Takes the bias out of whole pulses.
///
/// With `b` the bias of a sample along its ramp \[pulses\] and `r` what is carried \[pulses\], 1/2 at
/// the start so that the first sample is already rounded to the nearest:
///
/// ```text
/// n   = floor(r + b)        whole pulses of the bias
/// out = raw - n
/// r   = r + b - n           carried to the next sample, 0 to below 1
/// ```
///
/// The sum of what comes out stays within half a pulse of the sum of `raw - b`, after any number of
/// samples. All of it is integer arithmetic of 32 bits, without a division or a conversion. A
/// difference beyond 32 bits wraps, as a position counter does: its sum modulo 2^32 stays right.
///
/// It takes over ramps and marks late ones as a [`Corrector`](crate::Corrector) does.
///
/// # Timing
/// No branch depends on the data, nor on a take-over, on any Cortex-M.
///
/// ```
/// use tempco::{BiasRamp, PulseCorrector, PulseRamp, RampBuffer, Status};
///
/// static RAMPS: RampBuffer<1, i32> = RampBuffer::new();
/// let ramp = BiasRamp { end: [0.25], slope: [0.0], samples: 100, status: Status::OK };
/// RAMPS.publish(&PulseRamp::new(&ramp, [1.0]));
/// let mut corrector = PulseCorrector::new(&RAMPS);
/// let out: [i32; 8] = core::array::from_fn(|_| corrector.correct([7])[0]);
/// assert_eq!(out, [7, 6, 7, 7, 7, 6, 7, 7]);
/// ```
#[derive(Clone, Debug)]
pub struct PulseCorrector<'r, const AXES: usize> {
    ramps: &'r RampBuffer<AXES, i32>,
    /// `r` \[2^-26 pulses\].
    carried: [i32; AXES],
}

impl<'r, const AXES: usize> PulseCorrector<'r, AXES> {
    /// The one reader of a buffer.
    pub const fn new(ramps: &'r RampBuffer<AXES, i32>) -> Self {
        Self {
            ramps,
            carried: [1 << (FRACTION_BITS - 1); AXES],
        }
    }

    /// Takes the pulses of one gyro sample and returns them without the bias.
    #[inline(always)]
    pub fn correct(&mut self, raw: [i32; AXES]) -> [i32; AXES] {
        // Counts on until a late ramp is beyond doubt. A selection would be a branch on a Cortex-M0.
        let ramps = self.ramps;
        let passed = ramps.advance(|left| {
            let is_far_beyond = left.wrapping_add(1 << 17).cast_unsigned() >> 31;
            left.wrapping_add(is_far_beyond.cast_signed())
                .wrapping_sub(1)
        });
        let to_end = not_negative(passed.left);
        core::array::from_fn(|axis| {
            let way = ramps.slope(&passed, axis).wrapping_mul(to_end);
            let end = ramps.end(&passed, axis);
            let sum = self.carried[axis].wrapping_add(end).wrapping_sub(way);
            self.carried[axis] = sum & ((1 << FRACTION_BITS) - 1);
            raw[axis].wrapping_sub(sum >> FRACTION_BITS)
        })
    }

    /// Flags of the temperature, the range, and early or late ramps, as of the last gyro sample.
    pub fn status(&self) -> Status {
        self.ramps.status()
    }
}
