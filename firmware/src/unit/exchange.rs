//! What the sampling interrupt and the main loop pass to each other.

use core::sync::atomic::{AtomicU32, Ordering};

use tempco::{BiasRamp, RampBuffer, Status};
use tempco_link::Losses;

use crate::queue::{Consumer, Producer, Queue};

/// Moments that may wait for the main loop: 63 ms at 2 kHz, more than a pass ever takes but for
/// one that erases flash.
const MOMENTS: usize = 128;
/// Samples of a block, and one place that a queue cannot use.
const INJECTED: usize = 256;

/// What of one sample only the interrupt can know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment<const C: usize, const A: usize> {
    /// The gyro sample \[unit of the axis\].
    pub raw: [[f32; A]; C],
    /// The bias that was taken out, with that of re-zero \[unit of the axis\].
    pub bias: [[f32; A]; C],
    /// Flags of the bias.
    pub status: [Status; C],
}

/// What the interrupt made of a sample that was replayed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reply<const C: usize, const A: usize> {
    /// The sample without its bias \[unit of the axis\].
    pub compensated: [[f32; A]; C],
    /// The bias that was taken out \[unit of the axis\].
    pub bias: [[f32; A]; C],
    /// Flags of the bias.
    pub status: [Status; C],
}

/// Counts of the sampling interrupt since power-on, for all to read.
#[derive(Debug, Default)]
pub struct Counts {
    /// Periods of the sampling timer with an interrupt.
    pub ticks: AtomicU32,
    /// Periods of the sampling timer without one.
    pub missed: AtomicU32,
    /// Gyro samples that were taken.
    pub samples: AtomicU32,
    /// Gyro samples that were lost.
    pub lost: AtomicU32,
    /// Samples that a gyro with a clock of its own had ready without a word.
    pub data_ready: AtomicU32,
    /// Interrupts of the timer at which a gyro with a clock of its own was silent.
    pub silent: AtomicU32,
    /// Moments that found no place.
    pub lost_moments: AtomicU32,
    /// Replies to replayed samples that found no place.
    pub lost_replies: AtomicU32,
    /// Longest time to the output of a sample: from when it was due, or with a clock of its own from
    /// the interrupt that took it \[counts of the timer\].
    pub latency: AtomicU32,
}

/// Adds to a count of one writer, for which load and store suffice.
pub fn add(count: &AtomicU32, more: u32) {
    let sum = count.load(Ordering::Relaxed).wrapping_add(more);
    count.store(sum, Ordering::Relaxed);
}

/// Counts at the last self-test, by which new faults are seen.
#[derive(Clone, Copy, Default)]
pub(super) struct Known {
    pub(super) overruns: u32,
    pub(super) data_ready: u32,
    pub(super) silent: u32,
}

impl Counts {
    /// Nothing counted yet.
    pub const fn new() -> Self {
        Self {
            ticks: AtomicU32::new(0),
            missed: AtomicU32::new(0),
            samples: AtomicU32::new(0),
            lost: AtomicU32::new(0),
            data_ready: AtomicU32::new(0),
            silent: AtomicU32::new(0),
            lost_moments: AtomicU32::new(0),
            lost_replies: AtomicU32::new(0),
            latency: AtomicU32::new(0),
        }
    }

    /// Interrupts of the sampling timer.
    pub fn ticks(&self) -> u32 {
        self.ticks.load(Ordering::Relaxed)
    }

    /// Periods of the sampling timer: the time of the unit.
    pub fn periods(&self) -> u32 {
        let missed = self.missed.load(Ordering::Relaxed);
        self.ticks().wrapping_add(missed)
    }

    /// Gyro samples that were taken.
    pub fn samples(&self) -> u32 {
        self.samples.load(Ordering::Relaxed)
    }

    /// What was lost.
    pub fn losses(&self) -> Losses {
        Losses {
            missed_samples: self.lost.load(Ordering::Relaxed),
            moments: self.lost_moments.load(Ordering::Relaxed),
            replies: self.lost_replies.load(Ordering::Relaxed),
        }
    }
}

/// All that goes from one to the other: biases of the gyro and of a replay as ramps, the rest in
/// queues.
pub struct Exchange<const C: usize, const A: usize> {
    ramps: [RampBuffer<A>; C],
    replay_ramps: [RampBuffer<A>; C],
    moments: Queue<Moment<C, A>, MOMENTS>,
    injected: Queue<[[f32; A]; C], INJECTED>,
    replies: Queue<Reply<C, A>, INJECTED>,
}

/// The interrupt's ends.
pub struct InterruptEnds<'q, const C: usize, const A: usize> {
    pub(super) ramps: &'q [RampBuffer<A>; C],
    pub(super) replay_ramps: &'q [RampBuffer<A>; C],
    pub(super) moments: Producer<'q, Moment<C, A>, MOMENTS>,
    pub(super) injected: Consumer<'q, [[f32; A]; C], INJECTED>,
    pub(super) replies: Producer<'q, Reply<C, A>, INJECTED>,
    pub(super) counts: &'q Counts,
}

/// The main loop's ends.
pub struct MainEnds<'q, const C: usize, const A: usize> {
    pub(super) ramps: &'q [RampBuffer<A>; C],
    pub(super) replay_ramps: &'q [RampBuffer<A>; C],
    pub(super) moments: Consumer<'q, Moment<C, A>, MOMENTS>,
    pub(super) injected: Producer<'q, [[f32; A]; C], INJECTED>,
    pub(super) replies: Consumer<'q, Reply<C, A>, INJECTED>,
    pub(super) counts: &'q Counts,
}

impl<const C: usize, const A: usize> Exchange<C, A> {
    /// Empty queues, and no biases.
    pub const fn new() -> Self {
        Self {
            ramps: [const { RampBuffer::new() }; C],
            replay_ramps: [const { RampBuffer::new() }; C],
            moments: Queue::new(),
            injected: Queue::new(),
            replies: Queue::new(),
        }
    }

    /// The two sides.
    pub fn split<'q>(
        &'q mut self,
        counts: &'q Counts,
    ) -> (InterruptEnds<'q, C, A>, MainEnds<'q, C, A>) {
        let (ramps, replay_ramps) = (&self.ramps, &self.replay_ramps);
        let moments = self.moments.split();
        let injected = self.injected.split();
        let replies = self.replies.split();
        let interrupt = InterruptEnds {
            ramps,
            replay_ramps,
            moments: moments.0,
            injected: injected.1,
            replies: replies.0,
            counts,
        };
        let main = MainEnds {
            ramps,
            replay_ramps,
            moments: moments.1,
            injected: injected.0,
            replies: replies.1,
            counts,
        };
        (interrupt, main)
    }
}

impl<const C: usize, const A: usize> Default for Exchange<C, A> {
    fn default() -> Self {
        Self::new()
    }
}

/// Publishes a ramp for each channel.
pub(super) fn publish<const C: usize, const A: usize>(
    buffers: &[RampBuffer<A>; C],
    ramps: &[BiasRamp<A>; C],
) {
    for (buffer, ramp) in buffers.iter().zip(ramps) {
        buffer.publish(ramp);
    }
}
