//! Talks to tempco units over their serial link: what is in them, new tables, telemetry, and
//! replays of logs through the hardware.
//!
//! One module per concern, each usable alone:
//!
//! - [`open`]: a serial port, or the socket of an emulator
//! - [`Unit`]: a session with a unit
//! - [`flash_set`], [`activate`], [`download`]: its tables
//! - [`re_zero`]: its constant biases
//! - [`replay`]: a log through the unit and through the host, bit by bit
//!
//! The bytes on the wire are those of `tempco-link`, which firmware and host compile alike; what a
//! replay must give is computed by `tempco-replay`, which is what the unit runs.
//!
//! ```no_run
//! use std::path::Path;
//! use tempco_hil::{Patience, Unit, flash_set, open};
//!
//! let port = open(Path::new("/dev/ttyUSB0"), 921_600)?;
//! let mut unit = Unit::connect(port, Patience::default())?;
//! println!("unit {}", unit.identify()?.serial);
//! let image = std::fs::read("set/table.bin")?;
//! flash_set(&mut unit, &image, |bytes| println!("{bytes} bytes"))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

mod error;
mod flash;
mod port;
pub mod replay;
mod rezero;
mod unit;

pub use error::Error;
pub use flash::{Shape, activate, download, flash_set};
pub use port::{Port, open};
pub use rezero::{ReZeroed, re_zero};
pub use unit::{Identity, Patience, Unit};
