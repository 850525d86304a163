//! Commands that talk to a unit: they need a serial port, or an emulator.

mod bank;
mod bit;
// QEMU is driven over unix-domain sockets.
#[cfg_attr(not(unix), path = "no_emulated.rs")]
mod emulated;
mod faults;
#[cfg(unix)]
mod firmware;
mod flash_set;
mod monitor;
mod port_args;
mod record;
mod replay;
mod rezero;

use anyhow::Result;
use clap::Subcommand;

use crate::Exit;

#[derive(Subcommand)]
pub(crate) enum Command {
    Replay(Box<replay::Args>),
    FlashSet(flash_set::Args),
    Monitor(monitor::Args),
    Record(record::Args),
    Rezero(rezero::Args),
    Bit(bit::Args),
    Bank(bank::Args),
    Faults(faults::Args),
    Unit(emulated::Args),
}

impl Command {
    pub(crate) fn run(&self) -> Result<Exit> {
        match self {
            Self::Replay(args) => replay::run(args),
            Self::FlashSet(args) => flash_set::run(args),
            Self::Monitor(args) => monitor::run(args),
            Self::Record(args) => record::run(args),
            Self::Rezero(args) => rezero::run(args),
            Self::Bit(args) => bit::run(args),
            Self::Bank(args) => bank::run(args),
            Self::Faults(args) => faults::run(args),
            Self::Unit(args) => emulated::run(args),
        }
    }
}
