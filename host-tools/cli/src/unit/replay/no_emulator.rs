//! In place of the emulator, on systems without unix-domain sockets.

use anyhow::{Result, bail};

use super::{Differences, Replay};

const NEEDED: &str =
    "replay --target qemu needs Linux or macOS: expected a serial port, such as COM3";

#[derive(clap::Args)]
pub(super) struct EmulatorArgs {}

impl EmulatorArgs {
    pub(super) fn check(&self, _real_time: bool) -> Result<()> {
        bail!(NEEDED)
    }

    pub(super) fn run(&self, _: &Replay, _real_time: bool) -> Result<(Differences, String)> {
        bail!(NEEDED)
    }
}
