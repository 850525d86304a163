//! The sample half: the bias along its ramp, and a subtraction.

use crate::Status;
use crate::ramp::{Passed, RampBuffer, not_negative};

/// Takes the bias out of gyro samples, along the ramps of a [`ThermalHalf`](crate::ThermalHalf).
///
/// It is made for the sampling interrupt: it waits for nothing and copies nothing. The first sample
/// after a publication takes the new ramp over. Where the next ramp is late the bias stays, and
/// once it is late by more than the length of a ramp, [`Status::INTERVAL_INVALID`] says so. The same
/// flag marks a ramp that came early ([`RampBuffer::publish`]), until the next one is taken over.
///
/// # Timing
/// No branch depends on the data, nor on a take-over.
///
/// ```
/// use tempco::{BiasRamp, Corrector, RampBuffer, Status};
///
/// static RAMPS: RampBuffer<1> = RampBuffer::new();
/// // In the main loop, as a thermal half makes it:
/// RAMPS.publish(&BiasRamp { end: [2.0], slope: [0.25], samples: 2, status: Status::OK });
/// // In the interrupt:
/// let mut corrector = Corrector::new(&RAMPS);
/// assert_eq!(corrector.correct([10.0]), [8.25]);
/// assert_eq!(corrector.correct([10.0]), [8.0]);
/// assert_eq!(corrector.correct([10.0]), [8.0]);
/// assert_eq!(corrector.status(), Status::OK);
/// ```
#[derive(Clone, Debug)]
pub struct Corrector<'r, const AXES: usize> {
    ramps: &'r RampBuffer<AXES>,
}

impl<'r, const AXES: usize> Corrector<'r, AXES> {
    /// The one reader of a buffer.
    pub const fn new(ramps: &'r RampBuffer<AXES>) -> Self {
        Self { ramps }
    }

    /// Takes one gyro sample per axis and returns it without its bias \[unit of each axis\].
    #[inline(always)]
    pub fn correct(&mut self, raw: [f32; AXES]) -> [f32; AXES] {
        let mut block = [raw];
        self.correct_block(&mut block);
        let [corrected] = block;
        corrected
    }

    /// Takes the bias out of `N` gyro samples at once, as a FIFO holds them \[unit of each axis\].
    ///
    /// The ramp advances once by `N` samples, and all of them get one bias: that in the middle of the
    /// block, which is the mean of what the samples would get one by one. It differs from each of
    /// those by `(N - 1) / 2` times the slope at most.
    #[inline(always)]
    pub fn correct_block<const N: usize>(&mut self, block: &mut [[f32; AXES]; N]) {
        let (bias, _) = self.pass(|| const { samples_of(N) });
        for sample in block {
            subtract(sample, &bias);
        }
    }

    /// As [`correct_block`](Self::correct_block), of as many gyro samples as a FIFO holds at the
    /// time, 65535 at most; more count as 65535. Without a sample nothing is done.
    #[inline(always)]
    pub fn correct_slice(&mut self, block: &mut [[f32; AXES]]) {
        let samples = u16::try_from(block.len()).unwrap_or(u16::MAX);
        let (bias, _) = self.pass(|| samples.into());
        // Eights have no loop in them.
        let mut rest = block;
        while rest.len() >= 8 {
            let (eight, others) = core::mem::take(&mut rest).split_at_mut(8);
            for sample in eight {
                subtract(sample, &bias);
            }
            rest = others;
        }
        for sample in rest {
            subtract(sample, &bias);
        }
    }

    /// The bias of the next `N` gyro samples and their flags, for those who subtract it themselves.
    /// It is always finite \[unit of each axis\].
    #[inline(always)]
    pub fn advance<const N: usize>(&mut self) -> ([f32; AXES], Status) {
        let (bias, passed) = self.pass(|| const { samples_of(N) });
        (bias, self.ramps.status_of(&passed))
    }

    /// Flags of the temperature, the range, and early or late ramps, as of the last gyro sample.
    /// Gyro samples are checked apart, by [`Status::of_raw`].
    pub fn status(&self) -> Status {
        self.ramps.status()
    }

    #[inline(always)]
    fn pass(&mut self, samples: impl FnOnce() -> i32) -> ([f32; AXES], Passed) {
        // A function, so that a constant is one from the beginning: it saves two instructions.
        let samples = samples();
        // In steps of half a sample, the last of n samples is 2 n further, their middle n + 1.
        let half = |left: i32| left.saturating_sub(samples);
        let passed = self.ramps.advance(|left| half(half(left)));
        let to_end = not_negative(half(passed.before).saturating_sub(1)) as f32;
        let bias = core::array::from_fn(|axis| {
            self.ramps.end(&passed, axis) - self.ramps.slope(&passed, axis) * to_end
        });
        (bias, passed)
    }
}

/// Gyro samples of a block.
const fn samples_of(length: usize) -> i32 {
    assert!(length > 0 && length < 1 << 16, "1 to 65535 samples");
    length as i32
}

#[inline(always)]
fn subtract<const AXES: usize>(sample: &mut [f32; AXES], bias: &[f32; AXES]) {
    for (value, bias) in sample.iter_mut().zip(bias) {
        *value -= bias;
    }
}
