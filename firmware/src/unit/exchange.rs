//! What the sampling interrupt and the main loop pass to each other.

use core::sync::atomic::{AtomicU32, Ordering};

use heapless::spsc::{Consumer, Producer, Queue};
use tempco_link::Losses;
use tempco_replay::Outcome;

/// Moments that may wait for the main loop: 63 ms at 2 kHz, more than a pass ever takes but for
/// one that erases flash.
const MOMENTS: usize = 128;
/// Samples of a block, its temperatures, and one place that a queue cannot use.
const INJECTED: usize = 256;

/// What the interrupt made of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment<const C: usize, const A: usize> {
    /// The gyro sample \[unit of the axis\].
    pub raw: [[f32; A]; C],
    /// The outcome of the compensators.
    pub outcome: Outcome<C, A>,
}

/// What is replayed through the interrupt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Injected<const C: usize, const A: usize> {
    /// The next sample is the first one after power-on.
    Restart,
    /// Temperatures; NaN where there is none \[degC\].
    Temperatures([f32; C]),
    /// A gyro sample \[unit of the axis\].
    Sample([[f32; A]; C]),
}

/// Counts of the sampling interrupt, for all to read.
#[derive(Debug, Default)]
pub struct Counts {
    /// Gyro samples that were taken since power-on.
    pub samples: AtomicU32,
    /// Periods of the sampling timer in which no sample was taken.
    pub missed: AtomicU32,
    /// Moments that found no place.
    pub lost_moments: AtomicU32,
    /// Outcomes of replayed samples that found no place.
    pub lost_replies: AtomicU32,
    /// Longest time from the interrupt to the output \[counts of the timer\].
    pub latency: AtomicU32,
    /// Temperatures that the compensators rejected, of all channels.
    pub rejected: AtomicU32,
}

impl Counts {
    /// Nothing counted yet.
    pub const fn new() -> Self {
        Self {
            samples: AtomicU32::new(0),
            missed: AtomicU32::new(0),
            lost_moments: AtomicU32::new(0),
            lost_replies: AtomicU32::new(0),
            latency: AtomicU32::new(0),
            rejected: AtomicU32::new(0),
        }
    }

    /// Gyro samples that were taken since power-on.
    pub fn samples(&self) -> u32 {
        self.samples.load(Ordering::Relaxed)
    }

    /// Periods of the sampling timer since power-on: the time of the unit.
    pub fn periods(&self) -> u32 {
        self.samples()
            .wrapping_add(self.missed.load(Ordering::Relaxed))
    }

    /// What was lost since power-on.
    pub fn losses(&self) -> Losses {
        Losses {
            missed_samples: self.missed.load(Ordering::Relaxed),
            moments: self.lost_moments.load(Ordering::Relaxed),
            replies: self.lost_replies.load(Ordering::Relaxed),
        }
    }
}

/// The queues, before they are taken apart.
pub struct Queues<const C: usize, const A: usize> {
    temperatures: Queue<[f32; C], 4>,
    offsets: Queue<[[f32; A]; C], 2>,
    moments: Queue<Moment<C, A>, MOMENTS>,
    injected: Queue<Injected<C, A>, INJECTED>,
    replies: Queue<Outcome<C, A>, INJECTED>,
}

/// The interrupt's ends.
pub struct InterruptEnds<'q, const C: usize, const A: usize> {
    pub(super) temperatures: Consumer<'q, [f32; C]>,
    pub(super) offsets: Consumer<'q, [[f32; A]; C]>,
    pub(super) moments: Producer<'q, Moment<C, A>>,
    pub(super) injected: Consumer<'q, Injected<C, A>>,
    pub(super) replies: Producer<'q, Outcome<C, A>>,
    pub(super) counts: &'q Counts,
}

/// The main loop's ends.
pub struct MainEnds<'q, const C: usize, const A: usize> {
    pub(super) temperatures: Producer<'q, [f32; C]>,
    pub(super) offsets: Producer<'q, [[f32; A]; C]>,
    pub(super) moments: Consumer<'q, Moment<C, A>>,
    pub(super) injected: Producer<'q, Injected<C, A>>,
    pub(super) replies: Consumer<'q, Outcome<C, A>>,
    pub(super) counts: &'q Counts,
}

impl<const C: usize, const A: usize> Queues<C, A> {
    /// Empty queues.
    pub const fn new() -> Self {
        Self {
            temperatures: Queue::new(),
            offsets: Queue::new(),
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
        let temperatures = self.temperatures.split();
        let offsets = self.offsets.split();
        let moments = self.moments.split();
        let injected = self.injected.split();
        let replies = self.replies.split();
        let interrupt = InterruptEnds {
            temperatures: temperatures.1,
            offsets: offsets.1,
            moments: moments.0,
            injected: injected.1,
            replies: replies.0,
            counts,
        };
        let main = MainEnds {
            temperatures: temperatures.0,
            offsets: offsets.0,
            moments: moments.1,
            injected: injected.0,
            replies: replies.1,
            counts,
        };
        (interrupt, main)
    }
}

impl<const C: usize, const A: usize> Default for Queues<C, A> {
    fn default() -> Self {
        Self::new()
    }
}
