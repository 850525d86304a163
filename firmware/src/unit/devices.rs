//! What the application needs of a board.

use embedded_io::{Read, ReadReady, Write};
use embedded_storage::nor_flash::NorFlash;
use tempco::Status;
use tempco_link::FaultSet;
use tempco_sensors::SensorFault;
use tempco_store::Region;

/// The gyro's electronics; used by the sampling interrupt alone, and must not wait for anything.
///
/// A gyro whose pulses are counted has a sample at every interrupt of the timer. A gyro with a clock
/// of its own has none, one or several at any interrupt, and may ask for an interrupt when it has
/// one; the timer then watches it ([`Clock::Own`]).
pub trait Gyro<const C: usize, const A: usize> {
    /// What lets it take samples.
    const CLOCK: Clock = Clock::Timer;

    /// What a count of each axis is.
    const COUNTS: [[Count; A]; C];

    /// The count that marks an axis of a sample as not valid, where the part has one.
    const INVALID: Option<i32> = None;

    /// Scale factor of the gyro: a table of angles must be of this one; 0 where the counts are rates
    /// \[arcsec/pulse\].
    const SCALE_FACTOR_ARCSEC: f32 = 0.0;

    /// What it shows at rest; re-zero gives up beyond.
    const AT_REST: AtRest;

    /// The largest bias that a table may have, by the bound of
    /// [`Channel::max_bias`](tempco_image::Channel::max_bias) \[counts/s, of rates counts\].
    const MAX_TABLE_BIAS: f32;

    /// The next sample in counts, channel by channel. With [`Clock::Timer`] the counts since the last
    /// call, once per period. With [`Clock::Own`] the oldest sample that has not been handed out, if
    /// there is one: it is called until there is none.
    fn sample(&mut self) -> Option<[[i32; A]; C]>;

    /// What went wrong since the last call; with [`Clock::Own`] only.
    fn lost(&mut self) -> Lost {
        Lost::default()
    }

    /// No sample has come for long: starts another look at the part, whose samples then come with a
    /// later interrupt. With [`Clock::Own`] only.
    fn look(&mut self) {}

    /// Sends a sample to where the unit's output goes: without its bias \[unit of the axis\], and the
    /// flags of each channel. A sample that is not valid is NaN.
    fn put(&mut self, compensated: &[[f32; A]; C], status: &[Status; C]);
}

/// What lets a gyro take samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// The timer of the sampling interrupt, at every period.
    Timer,
    /// A clock of the part, nominally as fast as the timer. Samples may come in blocks.
    Own {
        /// Periods of the timer without a sample from which on [`Gyro::look`] is called, at least 1;
        /// more than a block takes.
        look_after: u16,
        /// Periods without a sample from which on the gyro is silent: the output is marked invalid.
        silent_after: u16,
    },
}

/// What a count of an axis is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Count {
    /// An increment of angle \[pulses\]: a quarter where every edge of two waves in quadrature counts.
    Pulses(f32),
    /// A rate \[deg/s\].
    Rate(f32),
}

/// What went wrong with the samples of a gyro that has a clock of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lost {
    /// Samples that were lost, as far as the part lets it be known; at least 1 if any was.
    pub samples: u32,
    /// Samples that were ready without word from the data-ready line.
    pub data_ready: u32,
}

/// What a gyro shows at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtRest {
    /// Standard deviation of means over the time between two temperatures \[counts/s, of rates
    /// counts\].
    pub sigma: f32,
    /// The largest constant bias that re-zero may take out \[counts/s, of rates counts\].
    pub max_bias: f32,
}

/// The temperature sensors; may wait for a bus, but not for a conversion.
pub trait Thermometers<const C: usize> {
    /// The number of equal readings in a row that the noise of a good sensor rules out; none for
    /// sensors of coarse resolution, of which a constant code is no evidence.
    const STUCK_AFTER: Option<u32>;

    /// The last conversion of each sensor \[degC\].
    fn read(&mut self) -> [Result<f32, SensorFault>; C];
}

/// Resets the unit unless it is fed.
pub trait Watchdog {
    /// Starts it; it then cannot be stopped.
    fn start(&mut self, timeout_ms: u32);

    /// Puts the reset off by the timeout.
    fn feed(&mut self);
}

/// Time in counts of the sampling timer, which begins a new period with every interrupt.
pub trait SampleClock {
    /// Counts since the timer's last interrupt was due.
    fn since_interrupt(&self) -> u32;

    /// Counts of a period.
    fn period(&self) -> u32;

    /// Sleeps until the next interrupt, and returns the counts asleep. Interrupts are carried out
    /// after the time was taken.
    fn sleep(&self) -> u32;

    /// Counts per period of [`free_running`](Self::free_running), at least 5.
    const FREE_PER_PERIOD: u32;

    /// The largest value of [`free_running`](Self::free_running), all ones. It comes round later
    /// than the longest time without interrupts ends.
    const FREE_MAX: u32;

    /// A counter that runs on while interrupts are held back, by which the timer's periods are
    /// counted.
    fn free_running(&self) -> u32;

    /// Duration of a count \[ns\].
    const COUNT_NS: u32;

    /// Lets the sampling interrupt come now, besides its timer, and returns after it.
    fn interrupt_now(&self);
}

/// Why the unit started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum ResetCause {
    /// The supply came, or nothing is known.
    PowerOn,
    /// The supply was too low.
    BrownOut,
    /// The watchdog was not fed.
    Watchdog,
    /// The program or the reset pin.
    Commanded,
}

/// Where the store is in the flash.
#[derive(Clone, Copy, Debug)]
pub struct Regions {
    /// The two copies of the table.
    pub slots: [Region; 2],
    /// The fault log.
    pub faults: Region,
    /// The constant biases of re-zero, and the numbers of boots and sessions.
    pub offsets: Region,
}

/// What a board's module hands over, with everything set up.
pub struct Devices<L, T, W> {
    /// Bytes to and from the host. Reading takes what has come and does not wait.
    pub link: L,
    /// The temperature sensors.
    pub thermometers: T,
    /// The watchdog, not yet started.
    pub watchdog: W,
    /// Why the unit started.
    pub reset_cause: ResetCause,
    /// What the board found wrong with itself; it stays present until the next reset.
    pub faults: FaultSet,
}

/// What the link is made of.
pub trait Link: Read + ReadReady + Write {}
impl<L: Read + ReadReady + Write> Link for L {}

/// What the store is kept in.
pub trait Flash: NorFlash {}
impl<F: NorFlash> Flash for F {}
