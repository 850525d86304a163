//! `tempco replay`: the same log through the firmware and through the host, bit by bit.

mod hardware;
mod semihosting;

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Error, Result, ensure};
use tempco_log::Log;
use tempco_qemu::{Board, Variant, Workspace, build_variant, ensure_qemu, ensure_target_of};
use tempco_replay::Sample;
use tempco_set::files::ScratchFolder;
use tempco_set::run::{ChannelInputs, inputs};
use tempco_set::{CoefficientSet, table_bin, table_rs};

use crate::Exit;
use crate::image::Placed;
use crate::output::{print, say};
use crate::port_args::BAUD;
use crate::shared_args::SetAndLog;

/// Run a log through the firmware and compare every result with the host, bit for bit
///
/// On the emulator, builds the firmware with the table of the set; for that it needs the sources
/// of tempco. What is missing (compiler target, emulator) is installed. A unit at a serial port
/// must have the set already (tempco flash-set). Exits with 1 where a result differs.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Where the firmware runs: `qemu` for the emulator, or the serial port of a unit
    #[arg(long, value_name = "qemu|PORT")]
    target: Target,
    /// Of the emulator, the board to build for: mps2-an386, stm32f405, mps2-an500 or mps2-an505
    #[arg(long, default_value = "mps2-an386")]
    board: Board,
    /// Of the emulator, run the whole application, as on a unit: write the set into it over its
    /// serial link, and send the log the same way; without, the compensators alone, on files,
    /// which is some 20 times faster
    #[arg(long)]
    application: bool,
    /// Baud rate of a serial port
    #[arg(long, value_name = "N", default_value_t = BAUD)]
    baud: u32,
    /// At the pace of the unit's sampling interrupt, for a log of its sample rate; without, as
    /// fast as it goes
    #[arg(long)]
    real_time: bool,
    // Last, since what follows would stand under its heading.
    #[command(flatten)]
    put: SetAndLog,
}

#[derive(Clone)]
enum Target {
    Qemu,
    Port(PathBuf),
}

impl FromStr for Target {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "qemu" => Self::Qemu,
            port => Self::Port(port.into()),
        })
    }
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let (set, log) = args.put.read()?;
    let inputs = inputs(&set, &log)?;
    let image = Placed::of(&table_bin(&set).map_err(Error::msg)?);
    let replay = Replay {
        set: &set,
        log: &log,
        inputs: &inputs,
        image: &image,
    };
    let (differences, place) = match &args.target {
        Target::Port(port) => hardware::at_port(&replay, port, args.baud, args.real_time)?,
        Target::Qemu if args.application => {
            ensure!(
                args.board.has_application(),
                "--board {}: expected mps2-an386 or mps2-an500, whose devices the emulator has",
                args.board
            );
            hardware::in_qemu(&replay, args.board, args.real_time)?
        }
        Target::Qemu => {
            ensure!(
                !args.real_time,
                "--real-time: expected with --application or a serial port"
            );
            let differences = semihosting::in_qemu(&replay, args.board)?;
            (differences, args.board.to_string())
        }
    };
    print(format_args!(
        "{} of {} samples differ between host and {place}",
        differences.count,
        log.rows()
    ))?;
    if let Some(row) = differences.first {
        say!(
            "the first one that differs is row {} at {} s",
            row + 1,
            log.time_s[row]
        );
    }
    Ok(Exit::of(differences.count == 0))
}

/// What is replayed.
struct Replay<'a> {
    set: &'a CoefficientSet,
    log: &'a Log,
    inputs: &'a [ChannelInputs<'a>],
    /// That of the set.
    image: &'a Placed,
}

/// Rows of which the firmware made something else than the host.
struct Differences {
    count: usize,
    first: Option<usize>,
}

impl Replay<'_> {
    /// The rows of the log as the firmware takes them.
    fn samples<const C: usize, const A: usize>(&self) -> impl Iterator<Item = Sample<C, A>> {
        let inputs = self.inputs;
        let intervals_s = self.log.intervals_s().enumerate();
        intervals_s.map(move |(row, dt_s)| Sample {
            dt_s,
            temps_c: std::array::from_fn(|channel| inputs[channel].temp_c[row]),
            raw: std::array::from_fn(|channel| inputs[channel].row(row)),
        })
    }

    /// Builds an image of the firmware for the set.
    fn build(&self, board: Board, bin: &str, variant: &Variant) -> Result<PathBuf> {
        let workspace = Workspace::find()?;
        ensure_target_of(&workspace, board)?;
        ensure_qemu(&workspace)?;
        let folder = ScratchFolder::new()?;
        let table = folder.path().join("table.rs");
        std::fs::write(&table, table_rs(self.set))?;
        Ok(build_variant(
            &workspace,
            board,
            bin,
            Some(&table),
            variant,
        )?)
    }
}
