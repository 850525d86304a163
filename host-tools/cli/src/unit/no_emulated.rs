//! In place of the emulated unit, on systems without unix-domain sockets.

use anyhow::{Result, bail};

use crate::Exit;

/// Run an emulated unit (Linux and macOS only)
#[derive(clap::Args)]
#[command(after_help = "Example: tempco unit")]
pub(crate) struct Args {}

pub(crate) fn run(_: &Args) -> Result<Exit> {
    bail!("unit needs Linux or macOS: expected a unit at a serial port, such as COM3")
}
