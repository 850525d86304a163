//! placeholder
#![no_std]
#![forbid(unsafe_code)]

mod compensator;
mod conditioner;
mod error;
mod estimator;
mod format;
mod interval;
mod mask;
mod pulse;
mod settings;
mod table;
mod thermal;
mod two_rate;

#[cfg(test)]
extern crate std;

pub use compensator::{FixedCompensator, FixedOutput};
pub use error::FixedError;
pub use format::{FRACTION_BITS, INVALID, from_binary_c, from_f32, from_milli_c, to_f32};
pub use interval::FixedInterval;
pub use pulse::{PulseCarry, PulseCarryF32};
pub use settings::FixedThermal;
pub use table::{FixedTable, FixedTerms};
pub use thermal::{FixedPoint, FixedThermalState};
pub use two_rate::FixedTwoRate;
