//! The history terms of a channel: plays (hysteresis) and second thermal lags.

use core::array::from_fn;
use core::iter::once;

use tempco::{MAX_AXES, Play, SlowPart};
use zerocopy::little_endian::F32;

use crate::{ImageError, MAX_PLAYS, MAX_SLOW_PARTS};

/// The history terms of a channel; not validated.
///
/// Gains behind the last axis of the channel are 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelHistory {
    plays: [Option<Play<MAX_AXES>>; MAX_PLAYS],
    slow_parts: [Option<SlowPart<MAX_AXES>>; MAX_SLOW_PARTS],
}

impl ChannelHistory {
    /// No terms.
    pub const NONE: Self = Self {
        plays: [None; MAX_PLAYS],
        slow_parts: [None; MAX_SLOW_PARTS],
    };

    /// Some terms of `AXES` axes.
    ///
    /// # Errors
    /// More than [`MAX_PLAYS`] or [`MAX_SLOW_PARTS`].
    pub fn new<const AXES: usize>(
        plays: &[Play<AXES>],
        slow_parts: &[SlowPart<AXES>],
    ) -> Result<Self, ImageError> {
        if plays.len() > MAX_PLAYS {
            return Err(ImageError::Field("plays"));
        }
        if slow_parts.len() > MAX_SLOW_PARTS {
            return Err(ImageError::Field("slow_parts"));
        }
        Ok(Self {
            plays: from_fn(|i| plays.get(i).map(resized_play)),
            slow_parts: from_fn(|i| slow_parts.get(i).map(resized_part)),
        })
    }

    /// The plays.
    pub fn plays(&self) -> impl Iterator<Item = &Play<MAX_AXES>> {
        self.plays.iter().flatten()
    }

    /// The second thermal lags.
    pub fn slow_parts(&self) -> impl Iterator<Item = &SlowPart<MAX_AXES>> {
        self.slow_parts.iter().flatten()
    }

    /// Number of plays and of second thermal lags.
    pub fn counts(&self) -> (usize, usize) {
        let count = |count: usize| count.saturating_add(1);
        (
            self.plays().fold(0, |plays, _| count(plays)),
            self.slow_parts().fold(0, |parts, _| count(parts)),
        )
    }

    /// The terms of so many axes as numbers, in the order of the image.
    pub(crate) fn numbers(&self, axes: usize) -> impl Iterator<Item = f32> {
        let plays = self.plays().flat_map(move |play| {
            let gains = play.gain.iter().copied().take(axes);
            once(play.half_width_c).chain(gains)
        });
        let slow_parts = self.slow_parts().flat_map(move |part| {
            let gains = part.gain.iter().copied().take(axes);
            [part.tau_s, part.limit_c].into_iter().chain(gains)
        });
        plays.chain(slow_parts)
    }

    /// The inverse of [`numbers`](Self::numbers).
    pub(crate) fn from_numbers(
        numbers: &[F32],
        axes: usize,
        plays: usize,
        slow_parts: usize,
    ) -> Self {
        let mut numbers = numbers.iter();
        // There are as many numbers as it takes; were there not, no table would accept a NaN.
        let mut next = || numbers.next().map_or(f32::NAN, |number| number.get());
        let mut play = || Play {
            half_width_c: next(),
            gain: from_fn(|axis| if axis < axes { next() } else { 0.0 }),
        };
        let plays = from_fn(|i| (i < plays).then(&mut play));
        let mut part = || SlowPart {
            tau_s: next(),
            limit_c: next(),
            gain: from_fn(|axis| if axis < axes { next() } else { 0.0 }),
        };
        let slow_parts = from_fn(|i| (i < slow_parts).then(&mut part));
        Self { plays, slow_parts }
    }

    /// The core's plays: those there are, then ones without gain.
    pub(crate) fn core_plays<const AXES: usize, const PLAYS: usize>(&self) -> [Play<AXES>; PLAYS] {
        from_fn(|i| {
            let play = self.plays.get(i).and_then(Option::as_ref);
            play.map_or(
                Play {
                    half_width_c: 0.0,
                    gain: [0.0; AXES],
                },
                resized_play,
            )
        })
    }

    /// The core's second thermal lags: those there are, then ones without gain and with the time constant of
    /// the rate estimator, which the core takes for every estimator.
    pub(crate) fn core_slow_parts<const AXES: usize, const SLOW: usize>(
        &self,
        tau_s: f32,
    ) -> [SlowPart<AXES>; SLOW] {
        from_fn(|i| {
            let part = self.slow_parts.get(i).and_then(Option::as_ref);
            part.map_or(
                SlowPart {
                    tau_s,
                    limit_c: 0.0,
                    gain: [0.0; AXES],
                },
                resized_part,
            )
        })
    }
}

fn resized_play<const FROM: usize, const TO: usize>(play: &Play<FROM>) -> Play<TO> {
    Play {
        half_width_c: play.half_width_c,
        gain: resized_gains(&play.gain),
    }
}

fn resized_part<const FROM: usize, const TO: usize>(part: &SlowPart<FROM>) -> SlowPart<TO> {
    SlowPart {
        tau_s: part.tau_s,
        limit_c: part.limit_c,
        gain: resized_gains(&part.gain),
    }
}

fn resized_gains<const FROM: usize, const TO: usize>(gain: &[f32; FROM]) -> [f32; TO] {
    from_fn(|axis| gain.get(axis).copied().unwrap_or(0.0))
}
