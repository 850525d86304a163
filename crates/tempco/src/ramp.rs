//! The way of the bias from one thermal update to the next, and its hand-over to the sample half.

use core::marker::PhantomData;
use core::sync::atomic::Ordering::{Acquire, Relaxed, Release};
use core::sync::atomic::{AtomicU32, compiler_fence};

use crate::Status;
use crate::sign::Sign;

/// A straight line of the bias over the gyro samples until the next thermal update. `T` is the
/// number type of a bias.
///
/// The bias of the `n`-th gyro sample after the take-over, counted from 1, is
///
/// ```text
/// B = end - slope * max(samples - n, 0)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ramp<T, const AXES: usize> {
    /// The bias at the end of the ramp, and from there on \[unit of each axis\].
    pub end: [T; AXES],
    /// Change of the bias per gyro sample \[unit of each axis\].
    pub slope: [T; AXES],
    /// Gyro samples of the ramp, 1 to 65535; 0 is a level bias that no other one is due after.
    pub samples: u16,
    /// Flags of the thermal update.
    pub status: Status,
}

/// A ramp of biases in the units of the axes.
pub type BiasRamp<const AXES: usize> = Ramp<f32, AXES>;

/// A number type of ramps: f32, or i32 in fixed point.
pub trait Number: Copy + sealed::Number {}

pub(crate) mod sealed {
    /// How a number is handed over.
    pub trait Number {
        /// Steps per gyro sample in which the way to the end of a ramp is counted. Two, where the
        /// middle of a block of an even number of samples lies between two of them.
        const STEPS: i32;
        /// The change per step that is worth this change per sample. Exact but for subnormals.
        fn per_step(self) -> Self;
        fn to_word(self) -> u32;
        fn from_word(word: u32) -> Self;
    }
}

impl Number for f32 {}
impl Number for i32 {}

impl sealed::Number for f32 {
    const STEPS: i32 = 2;

    #[inline(always)]
    fn per_step(self) -> Self {
        0.5 * self
    }

    #[inline(always)]
    fn to_word(self) -> u32 {
        self.to_bits()
    }

    #[inline(always)]
    fn from_word(word: u32) -> Self {
        Self::from_bits(word)
    }
}

impl sealed::Number for i32 {
    const STEPS: i32 = 1;

    #[inline(always)]
    fn per_step(self) -> Self {
        self
    }

    #[inline(always)]
    fn to_word(self) -> u32 {
        self.cast_unsigned()
    }

    #[inline(always)]
    fn from_word(word: u32) -> Self {
        word.cast_signed()
    }
}

/// Hands ramps from the thermal half to the sample half, without locks and without a copy.
///
/// There is room for two ramps, and a sequence number whose lowest bit says which one is valid.
///
/// # One writer, and one reader that interrupts it
/// [`publish`](Self::publish) belongs to one place of the program, in the main loop. The corrector
/// that reads belongs to one interrupt of the same core: the main loop stands still while it runs.
/// So it sees all of a ramp, or nothing of it. The writer fills the room that is not valid, and makes
/// it valid by a single store; the interrupt may come between any two stores before. Two writers,
/// two readers, or a reader on another core are not provided for.
///
/// Everything is loaded and stored in words. Each Cortex-M can do that, also those without
/// compare-and-swap.
#[derive(Debug)]
pub struct RampBuffer<const AXES: usize, T = f32> {
    sequence: AtomicU32,
    /// Steps until the end of either ramp; below zero, since then. The reader counts them down.
    left: [AtomicU32; 2],
    /// Samples in the lower half, flags in the upper half.
    heads: [AtomicU32; 2],
    ends: [[AtomicU32; 2]; AXES],
    /// Per step.
    slopes: [[AtomicU32; 2]; AXES],
    numbers: PhantomData<T>,
}

impl<const AXES: usize, T> Default for RampBuffer<AXES, T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const AXES: usize, T> RampBuffer<AXES, T> {
    /// A buffer before the first ramp: no bias, and [`Status::TEMPERATURE_LOST`].
    pub const fn new() -> Self {
        const fn both(word: u32) -> [AtomicU32; 2] {
            [AtomicU32::new(word), AtomicU32::new(word)]
        }
        Self {
            sequence: AtomicU32::new(0),
            left: both(0),
            heads: both(head(0, Status::TEMPERATURE_LOST)),
            ends: [const { both(0) }; AXES],
            slopes: [const { both(0) }; AXES],
            numbers: PhantomData,
        }
    }
}

impl<const AXES: usize, T: Number> RampBuffer<AXES, T> {
    /// Makes a ramp the valid one, from the next gyro sample on.
    ///
    /// A ramp begins where the former one ends. If that has more than half of its samples left, or
    /// no sample took it over, the bias begins with a step: [`Status::INTERVAL_INVALID`] then goes
    /// with the ramp. A level bias may come at any time.
    pub fn publish(&self, ramp: &Ramp<T, AXES>) {
        let former = self.sequence.load(Relaxed);
        let left = self.left[place(former)].load(Relaxed).cast_signed();
        let all = T::STEPS * samples(self.heads[place(former)].load(Relaxed));
        let is_early = ramp.samples > 0 && left > all / 2;
        let status = ramp.status | Status::INTERVAL_INVALID.when(is_early);

        let sequence = former.wrapping_add(1);
        let place = place(sequence);
        let steps = T::STEPS * i32::from(ramp.samples);
        self.left[place].store(steps.cast_unsigned(), Relaxed);
        self.heads[place].store(head(ramp.samples, status), Relaxed);
        for axis in 0..AXES {
            self.ends[axis][place].store(ramp.end[axis].to_word(), Relaxed);
            let slope = ramp.slope[axis].per_step();
            self.slopes[axis][place].store(slope.to_word(), Relaxed);
        }
        // An interrupt of the same core sees stores in the order of the program. This keeps the
        // compiler from changing it.
        compiler_fence(Release);
        self.sequence.store(sequence, Relaxed);
    }

    /// Goes along the valid ramp: `pass` turns the steps that were left into those that are.
    #[inline(always)]
    pub(crate) fn advance(&self, pass: impl FnOnce(i32) -> i32) -> Passed {
        let place = place(self.sequence.load(Relaxed));
        compiler_fence(Acquire);
        let before = self.left[place].load(Relaxed).cast_signed();
        let left = pass(before);
        self.left[place].store(left.cast_unsigned(), Relaxed);
        Passed {
            place,
            before,
            left,
        }
    }

    /// Where the ramp ends, for one axis.
    #[inline(always)]
    pub(crate) fn end(&self, passed: &Passed, axis: usize) -> T {
        of_axis(&self.ends, passed, axis)
    }

    /// The slope per step, for one axis.
    #[inline(always)]
    pub(crate) fn slope(&self, passed: &Passed, axis: usize) -> T {
        of_axis(&self.slopes, passed, axis)
    }

    /// The flags of the ramp, and whether the next one is late by more than its length.
    #[inline(always)]
    pub(crate) fn status_of(&self, passed: &Passed) -> Status {
        let head = self.heads[passed.place].load(Relaxed);
        let steps = T::STEPS * samples(head);
        let is_late = Sign(passed.left.saturating_add(steps)) & Sign(steps.wrapping_neg());
        // The flag's bit, where the sign says so.
        let late = is_late.keep(Status::INTERVAL_INVALID.bits().into());
        Status::from_bits((head >> 16) as u16 | late as u16)
    }

    /// The flags as of the last gyro sample.
    pub(crate) fn status(&self) -> Status {
        self.status_of(&self.advance(|left| left))
    }
}

/// A part of a ramp that gyro samples have passed.
pub(crate) struct Passed {
    place: usize,
    /// Steps to the end before.
    pub(crate) before: i32,
    /// Steps to the end after.
    pub(crate) left: i32,
}

/// A number of the ramp. Every axis has its words, so the alternative is never taken; it is there so
/// that the compiler need not provide for a panic.
#[inline(always)]
fn of_axis<T: Number>(words: &[[AtomicU32; 2]], passed: &Passed, axis: usize) -> T {
    let words = words.get(axis);
    T::from_word(words.map_or(0, |words| words[passed.place].load(Relaxed)))
}

#[inline(always)]
const fn place(sequence: u32) -> usize {
    (sequence & 1) as usize
}

const fn head(samples: u16, status: Status) -> u32 {
    (status.bits() as u32) << 16 | samples as u32
}

#[inline(always)]
const fn samples(head: u32) -> i32 {
    (head & 0xffff) as i32
}

/// `value`, but 0 where it is negative.
#[inline(always)]
pub(crate) fn not_negative(value: i32) -> i32 {
    (!Sign(value)).keep(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BiasRamp, Corrector};

    fn ramp(end: f32, samples: u16) -> BiasRamp<1> {
        BiasRamp {
            end: [end],
            slope: [0.5],
            samples,
            status: Status::OK,
        }
    }

    #[test]
    fn ramps_are_taken_over_when_the_sequence_wraps() {
        let ramps = RampBuffer::<1>::new();
        ramps.sequence.store(u32::MAX - 3, Relaxed);
        let mut corrector = Corrector::new(&ramps);
        for number in 0..8_u8 {
            let end = f32::from(number);
            ramps.publish(&ramp(end, 2));
            assert_eq!(corrector.correct([0.0]), [0.5 - end]);
            assert_eq!(corrector.correct([0.0]), [-end]);
            assert_eq!(corrector.status(), Status::OK);
        }
    }

    /// The interrupt may come between any two stores: until the last one it sees the former ramp.
    #[test]
    fn a_ramp_that_is_being_written_is_not_seen() {
        let ramps = RampBuffer::<1>::new();
        ramps.publish(&ramp(3.0, 2));
        let before = ramps.sequence.load(Relaxed);
        ramps.publish(&ramp(7.0, 2));
        ramps.sequence.store(before, Relaxed);
        assert_eq!(Corrector::new(&ramps).correct([0.0]), [0.5 - 3.0]);
        ramps.sequence.store(before + 1, Relaxed);
        assert_eq!(Corrector::new(&ramps).correct([0.0]), [0.5 - 7.0]);
    }

    #[test]
    fn a_ramp_of_whole_numbers_is_handed_over_as_it_is() {
        let ramps = RampBuffer::<1, i32>::new();
        ramps.publish(&Ramp {
            end: [-7],
            slope: [3],
            samples: 2,
            status: Status::OK,
        });
        let passed = ramps.advance(|left| left - 1);
        assert_eq!((passed.before, passed.left), (2, 1));
        assert_eq!((ramps.end(&passed, 0), ramps.slope(&passed, 0)), (-7, 3));
    }

    #[test]
    fn an_early_ramp_is_flagged_also_once_the_next_one_is_late() {
        let ramps = RampBuffer::<1>::new();
        ramps.publish(&ramp(3.0, 10));
        ramps.publish(&ramp(3.0, 10));
        let mut corrector = Corrector::new(&ramps);
        for _ in 0..30 {
            corrector.correct([0.0]);
            assert_eq!(corrector.status(), Status::INTERVAL_INVALID);
        }
    }

    /// The counters stop where they say all they have to.
    #[test]
    fn a_ramp_that_is_late_for_ever_stays_late() {
        let ramps = RampBuffer::<1>::new();
        ramps.publish(&ramp(3.0, u16::MAX));
        for left in [i32::MIN, i32::MIN + 1, -(1 << 17) - 1] {
            ramps.left[1].store(left.cast_unsigned(), Relaxed);
            let mut corrector = Corrector::new(&ramps);
            for _ in 0..10 {
                let mut block = [[0.0]; 8];
                corrector.correct_block(&mut block);
                assert_eq!(block, [[-3.0]; 8]);
                assert_eq!(corrector.status(), Status::INTERVAL_INVALID);
            }
        }
    }
}
