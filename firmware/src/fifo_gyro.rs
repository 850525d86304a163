//! An ICM-42688-P between its data-ready interrupt and the sampling interrupt.
//!
//! ```text
//! data-ready interrupt, low priority              sampling interrupt, high priority
//!   Reader: a burst over SPI      -- queue -->      Samples: one by one
//!     ^                                                  |
//!     +--- look: no sample has come for long ------------+
//! ```
//!
//! The bus is waited for in the interrupt of low priority, so that the sampling waits for nothing.
//! The reader also starts the chip, and starts it again when it was away: a step at each look.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiDevice;
use tempco_sensors::icm42688::{ChipFault, INVALID, Icm42688, Settings};

use crate::queue::{Consumer, Producer, Queue};
use crate::unit::devices::{Clock, Lost};
use crate::unit::exchange::add;

/// Samples that may wait for the sampling interrupt, and one place that a queue cannot use. It comes
/// at once.
const WAITING: usize = 64;

/// Torn reads in a row, or looks without a sample, after which the chip is started again.
const PATIENCE: u8 = 4;

/// Reads from one check of a register to the next.
const READS_PER_CHECK: u8 = 64;

/// Time without a sample from which on the gyro is silent \[ms\].
const SILENT_MS: u16 = 10;

/// The count that marks an axis of a sample as not valid.
pub const INVALID_COUNT: i32 = INVALID as i32;

/// How the sampling watches a chip of these settings: it looks 1.5 ms after a block was due, which is
/// more than a reset takes.
pub const fn clock(settings: &Settings) -> Clock {
    let rate_hz = settings.rate.hz();
    let look_after = settings.block as u16 + rate_hz.div_ceil(1000) * 3 / 2;
    let silent_after = rate_hz / 1000 * SILENT_MS;
    assert!(
        settings.block > 0 && look_after < silent_after,
        "a block takes longer than its absence is borne"
    );
    Clock::Own {
        look_after,
        silent_after,
    }
}

/// What goes from the reader to the sampling.
pub struct Channel {
    queue: Queue<[i16; 3], WAITING>,
    shared: Shared,
}

/// What both sides see.
struct Shared {
    /// The sampling has begun. Samples from before are nobody's loss.
    is_sampling: AtomicBool,
    /// Counted by the reader since then.
    lost: AtomicU32,
    data_ready: AtomicU32,
}

impl Channel {
    /// Nothing has been read.
    pub const fn new() -> Self {
        Self {
            queue: Queue::new(),
            shared: Shared {
                is_sampling: AtomicBool::new(false),
                lost: AtomicU32::new(0),
                data_ready: AtomicU32::new(0),
            },
        }
    }

    /// The two sides, for a chip of these settings.
    pub fn split<SPI>(&mut self, spi: SPI, settings: Settings) -> (Reader<'_, SPI>, Samples<'_>)
    where
        SPI: SpiDevice,
    {
        let (producer, consumer) = self.queue.split();
        let reader = Reader {
            chip: Icm42688::new(spi, settings),
            block: settings.block.into(),
            queue: producer,
            shared: &self.shared,
            state: State::Off,
            failures: 0,
            unchecked: 0,
        };
        let samples = Samples {
            queue: consumer,
            shared: &self.shared,
            known: Lost::default(),
        };
        (reader, samples)
    }
}

impl Default for Channel {
    fn default() -> Self {
        Self::new()
    }
}

/// The chip, in its data-ready interrupt.
pub struct Reader<'q, SPI> {
    chip: Icm42688<SPI>,
    block: u16,
    queue: Producer<'q, [i16; 3], WAITING>,
    shared: &'q Shared,
    state: State,
    /// Torn reads, or looks without a sample, in a row.
    failures: u8,
    /// Reads since the last check of a register.
    unchecked: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// To be reset.
    Off,
    /// Reset, to be configured.
    Reset,
    /// It measures.
    On,
}

impl<SPI: SpiDevice> Reader<'_, SPI> {
    /// Starts the chip while a board is set up, and waits until it gives good samples, 60 ms at most.
    /// A chip that does not answer is started by later looks.
    pub fn start(&mut self, delay: &mut impl DelayNs) {
        for _ in 0..2 {
            self.look();
            delay.delay_ms(2);
        }
        // The first samples are left out.
        for _ in 0..56 {
            if self.state == State::On && self.chip.is_settled() {
                return;
            }
            self.ready();
            delay.delay_ms(1);
        }
    }

    /// The line says that data are ready: takes a burst from the chip.
    pub fn ready(&mut self) {
        if self.state == State::On {
            self.read(true);
        }
    }

    /// The line has been silent for long: takes what there is, or does the next step of a start. At
    /// least 1 ms after the last look.
    pub fn look(&mut self) {
        let next = match self.state {
            State::Off => self.chip.reset().map(|()| State::Reset),
            State::Reset => self.chip.configure().map(|()| State::On),
            State::On => return self.read(false),
        };
        self.state = next.unwrap_or(State::Off);
        self.failures = 0;
    }

    fn read(&mut self, by_line: bool) {
        let is_sampling = self.shared.is_sampling.load(Ordering::Relaxed);
        let queue = &mut self.queue;
        let mut lost = 0;
        let burst = self.chip.read(|counts| {
            if is_sampling && queue.enqueue(counts).is_err() {
                lost += 1;
            }
        });
        let burst = burst.and_then(|burst| self.check().map(|()| burst));
        let has_failed = match burst {
            Ok(burst) => {
                lost += u32::from(burst.lost);
                // One more than a block: the line had the time of a sample to say so.
                let was_missed = is_sampling && !by_line && burst.waiting > self.block;
                add(&self.shared.data_ready, was_missed.into());
                burst.waiting == 0 && !by_line
            }
            // How many it were is seen at the next sample.
            Err(ChipFault::Torn) => true,
            Err(_) => {
                self.failures = PATIENCE;
                true
            }
        };
        self.failures = if has_failed {
            self.failures.saturating_add(1)
        } else {
            0
        };
        if self.failures >= PATIENCE {
            // Nobody knows how many samples this takes.
            lost += 1;
            self.state = State::Off;
        }
        if is_sampling {
            add(&self.shared.lost, lost);
        }
    }

    /// Now and then, whether the chip still holds one of its settings.
    fn check(&mut self) -> Result<(), ChipFault> {
        self.unchecked += 1;
        if self.unchecked < READS_PER_CHECK {
            return Ok(());
        }
        self.unchecked = 0;
        self.chip.check()
    }
}

/// What was read, for the sampling.
pub struct Samples<'q> {
    queue: Consumer<'q, [i16; 3], WAITING>,
    shared: &'q Shared,
    known: Lost,
}

impl Samples<'_> {
    /// The oldest sample that was not handed out, in counts: the first axis of the unit is x. An axis
    /// that is [`INVALID_COUNT`] has no value.
    pub fn take<const C: usize, const A: usize>(&mut self) -> Option<[[i32; A]; C]> {
        const { assert!(C * A <= 3, "the chip has three axes") };
        self.shared.is_sampling.store(true, Ordering::Relaxed);
        let mut counts = self.queue.dequeue()?.into_iter();
        let each = |_| core::array::from_fn(|_| counts.next().map_or(0, i32::from));
        Some(core::array::from_fn(each))
    }

    /// What went wrong since the last call.
    pub fn lost(&mut self) -> Lost {
        let now = Lost {
            samples: self.shared.lost.load(Ordering::Relaxed),
            data_ready: self.shared.data_ready.load(Ordering::Relaxed),
        };
        let before = core::mem::replace(&mut self.known, now);
        Lost {
            samples: now.samples.wrapping_sub(before.samples),
            data_ready: now.data_ready.wrapping_sub(before.data_ready),
        }
    }
}
