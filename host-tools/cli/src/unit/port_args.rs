//! Arguments of the commands that talk to a unit.

use std::path::PathBuf;

use anyhow::{Context, Result};
use tempco_hil::{Patience, Unit, open};
use tempco_link::Bank;

/// Baud rate of the boards in `firmware`.
pub(crate) const BAUD: u32 = 921_600;

/// Where a unit is.
#[derive(clap::Args)]
pub(crate) struct PortArgs {
    /// Serial port of the unit, such as /dev/ttyUSB0 or COM3, or the socket of an emulator
    #[arg(long, value_name = "PORT")]
    pub(crate) port: PathBuf,
    /// Baud rate of the serial port
    #[arg(long, value_name = "N", default_value_t = BAUD)]
    baud: u32,
}

impl PortArgs {
    /// Opens a session with the unit.
    pub(crate) fn connect(&self) -> Result<Unit> {
        // An error of opening names the port itself.
        let port = open(&self.port, self.baud)?;
        Unit::connect(port, Patience::default()).with_context(|| self.port.display().to_string())
    }
}

/// A bank in words, to stand after its contents.
pub(crate) const fn bank_name(bank: Bank) -> &'static str {
    match bank {
        Bank::A => " in bank A",
        Bank::B => " in bank B",
    }
}
