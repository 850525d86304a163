//! Through the firmware in QEMU: the compensators alone, or the whole application.

use std::path::Path;

use anyhow::{Error, Result, ensure};
use tempco_hil::{Patience, Unit, flash_set, open};
use tempco_qemu::{Board, Machine, MachineOptions, MachineTime, Variant};
use tempco_set::table_bin;

use super::{Differences, Replay, hardware, semihosting};
use crate::output::print;
use crate::unit::firmware::build;

/// An instruction takes 32 ns of emulated time, about as on the board with its 25 MHz: load and
/// latency do not depend on this machine.
const TIME: MachineTime = MachineTime::Unbound { shift: 5 };

#[derive(clap::Args)]
pub(super) struct EmulatorArgs {
    /// Board of the emulator: mps2-an386, stm32f405, mps2-an500 or mps2-an505
    #[arg(long, default_value = "mps2-an386")]
    board: Board,
    /// In the emulator, run the whole application, with set and log over its serial link. Without,
    /// only the compensators run, about 20 times as fast
    #[arg(long)]
    application: bool,
}

impl EmulatorArgs {
    /// Refuses what the emulator cannot do, before anything is read.
    pub(super) fn check(&self, real_time: bool) -> Result<()> {
        ensure!(
            !self.application || self.board.has_application(),
            "--board {}: expected mps2-an386 or mps2-an500, whose devices the emulator has",
            self.board
        );
        ensure!(
            self.application || !real_time,
            "--real-time: expected with --application or a serial port"
        );
        Ok(())
    }

    /// Replays the log and says where.
    pub(super) fn run(&self, put: &Replay, real_time: bool) -> Result<(Differences, String)> {
        let differences = if self.application {
            in_machine(put, self.board, real_time)?
        } else {
            semihosting::in_qemu(put, self.board)?
        };
        Ok((differences, self.board.to_string()))
    }
}

/// On an emulated unit, into which the set is written first.
fn in_machine(put: &Replay, board: Board, real_time: bool) -> Result<Differences> {
    let elf = build(Some(put.set), board, "unit", &Variant::APPLICATION)?;
    let options = MachineOptions {
        time: TIME,
        ..MachineOptions::default()
    };
    let machine = Machine::start(&elf, board, &options)?;
    let replayed = over_link(put, &machine.link(), real_time);
    for line in machine.log() {
        print(format_args!("{board}: {line}"))?;
    }
    replayed
}

fn over_link(put: &Replay, link: &Path, real_time: bool) -> Result<Differences> {
    let mut unit = Unit::connect(open(link, 0)?, Patience::default())?;
    // The replayed values are in the unit of the table: the emulated gyro is not read, and its scale
    // factor may be any.
    let mut set = put.set.clone();
    set.settings.scale_factor_arcsec = Some(unit.identify()?.scale_factor_arcsec.into());
    let image = table_bin(&set).map_err(Error::msg)?;
    let identity = flash_set(&mut unit, &image, |_| {})?;
    hardware::through(put, &mut unit, &identity, real_time)
}
