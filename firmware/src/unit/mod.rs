//! The application of gyro electronics: compensates every sample, and looks after itself.
//!
//! ```text
//! sampling interrupt, 2 kHz   counts -> subtract the bias -> output    Sampling
//!        ^ ramps of the bias | moments v     (one writer and one reader each)
//! main loop   thermometers -> thermal half; link, store, health        Unit
//! ```
//!
//! - [`devices`]: what it needs of a board
//! - [`Sampling`]: all that the interrupt does
//! - [`exchange`]: what goes between interrupt and main loop
//! - [`Unit`]: the main loop, one pass at a time; its work is in `service`, with `requests` of the
//!   link, `replays` of logs, `self_test` and `boots` apart
//! - [`fit`]: which tables fit the board
//! - [`storage`]: tables, fault log and offsets in the flash
//! - [`in_use`]: the tables in use, in RAM, and the check of them by their [`sums`]
//! - [`thermometry`]: temperatures on schedule, and what is wrong with the sensors
//! - [`offsets`]: the constant biases, which a [`rezero`] finds at rest
//! - [`health`]: faults that are present, the watchdog's rule
//! - [`known_answer`]: whether this processor computes what it should
//!
//! Nothing here knows a processor: the host runs the same code in tests.
//!
//! # Why neither RTIC nor Embassy
//! There is one interrupt with a deadline, and everything else has the time of a main loop; the
//! two share nothing but ramps and queues. An executor would add its own code between the timer and the
//! sample, and RTIC's resources would tie this code to the interrupts of one chip.

mod boots;
pub mod devices;
pub mod exchange;
pub mod fit;
pub mod health;
pub mod in_use;
pub mod known_answer;
mod load;
mod main_loop;
mod mean;
pub mod offsets;
mod parts;
mod recent;
mod replays;
mod requests;
pub mod rezero;
mod sampling;
mod self_test;
mod service;
pub mod storage;
pub mod sums;
pub mod thermometry;
mod time;
mod wire;

pub use main_loop::{Next, Unit};
pub use parts::Parts;
pub use sampling::Sampling;

use tempco::{Schedule, Table, ThermalChannels};
use tempco_image::MAX_LEN;

use crate::table;

/// Temperature channels, as of the table the image was built with.
pub const CHANNELS: usize = table::CHANNELS;
/// Axes of each channel, as of the table the image was built with.
pub const AXES: usize = table::AXES;
/// Serial number of the unit: only tables of this one are taken.
pub const SERIAL: &str = table::SERIAL;

/// Gyro samples at 2 kHz, or 8 kHz with the feature `rate-8khz`; temperatures at 10 Hz.
pub const SCHEDULE: Schedule = if cfg!(feature = "rate-8khz") {
    Schedule {
        sample_rate_hz: 8000.0,
        samples_per_update: 800,
    }
} else {
    Schedule {
        sample_rate_hz: 2000.0,
        samples_per_update: 200,
    }
};

/// Time without a sign of life after which the watchdog resets the unit \[ms\].
pub const WATCHDOG_MS: u32 = 4000;

/// Room for the image of a table \[bytes\]: the longest one of this layout, and what a newer minor
/// version may add to it. The application has it twice in RAM.
pub const IMAGE_LEN: usize = 26 * 1024;

const _: () = assert!(MAX_LEN <= IMAGE_LEN);

/// The tables of all channels.
pub type UnitTables<'t, const C: usize, const A: usize> = [Table<'t, A>; C];

/// The thermal halves of all channels.
pub type UnitThermal<'t, const C: usize, const A: usize> = ThermalChannels<'t, C, A>;
