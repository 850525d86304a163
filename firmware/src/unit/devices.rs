//! What the application needs of a board.

use embedded_io::{Read, ReadReady, Write};
use embedded_storage::nor_flash::NorFlash;
use tempco::Status;
use tempco_link::FaultSet;
use tempco_sensors::SensorFault;
use tempco_store::Region;

/// The gyro's electronics; used by the sampling interrupt alone, and must not wait for anything.
pub trait Gyro<const C: usize, const A: usize> {
    /// Pulses of the gyro per count; a quarter where every edge of two waves in quadrature counts.
    const PULSES_PER_COUNT: f32;

    /// Scale factor of the gyro: a table of angles must be of this one \[arcsec/pulse\].
    const SCALE_FACTOR_ARCSEC: f32;

    /// What it shows at rest; re-zero gives up beyond.
    const AT_REST: AtRest;

    /// The largest bias that a table may have, by the bound of
    /// [`Channel::max_bias`](tempco_image::Channel::max_bias) \[counts/s\].
    const MAX_TABLE_BIAS: f32;

    /// Counts since the last call, channel by channel.
    fn counts(&mut self) -> [[i32; A]; C];

    /// Sends a sample to where the unit's output goes: without its bias \[unit of the axis\], and the
    /// flags of each channel.
    fn put(&mut self, compensated: &[[f32; A]; C], status: &[Status; C]);
}

/// What a gyro shows at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtRest {
    /// Standard deviation of means over the time between two temperatures \[counts/s\].
    pub sigma: f32,
    /// The largest constant bias that re-zero may take out \[counts/s\].
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
    /// The constant biases of re-zero.
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
