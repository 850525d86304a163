//! Commands that talk to a unit: they need a serial port, or an emulator.

mod faults;
mod flash_set;
mod monitor;
mod port_args;
mod replay;

use anyhow::Result;
use clap::Subcommand;

use crate::Exit;

#[derive(Subcommand)]
pub(crate) enum Command {
    Replay(Box<replay::Args>),
    FlashSet(flash_set::Args),
    Monitor(monitor::Args),
    Faults(faults::Args),
}

impl Command {
    pub(crate) fn run(&self) -> Result<Exit> {
        match self {
            Self::Replay(args) => replay::run(args),
            Self::FlashSet(args) => flash_set::run(args),
            Self::Monitor(args) => monitor::run(args),
            Self::Faults(args) => faults::run(args),
        }
    }
}
