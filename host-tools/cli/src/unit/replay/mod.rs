//! `tempco replay`: the same log through the firmware and through the host, bit by bit.

// QEMU is driven over unix-domain sockets.
#[cfg_attr(not(unix), path = "no_emulator.rs")]
mod emulator;
mod hardware;
#[cfg(unix)]
mod semihosting;

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Error, Result};
use tempco_log::Log;
use tempco_replay::Sample;
use tempco_set::run::{ChannelInputs, Updates, inputs};
use tempco_set::{CoefficientSet, table_bin};

use self::emulator::EmulatorArgs;
use crate::Exit;
use crate::image::Placed;
use crate::output::{print, say};
use crate::shared_args::SetAndLog;
use crate::unit::port_args::BAUD;

/// Run a log through the firmware and compare it with the host
///
/// Every result must be the same, bit for bit. In the emulator, builds the firmware with the table
/// of the set. This needs the sources of tempco; the compiler target and the emulator are installed
/// if they are missing. A unit at a serial port must have the set already (tempco flash-set).
///
/// Exit code 1: a result differs.
#[derive(clap::Args)]
#[command(
    after_help = "Example: tempco replay RLG-7/coefficients.json verification.csv --target qemu"
)]
pub(crate) struct Args {
    /// Where the firmware runs: qemu for the emulator, or the serial port of a unit
    #[arg(long, value_name = "qemu|PORT")]
    target: Target,
    #[command(flatten)]
    emulator: EmulatorArgs,
    /// Baud rate of a serial port
    #[arg(long, value_name = "N", default_value_t = BAUD)]
    baud: u32,
    /// Replay at the unit's sample rate, which must be the rate of the log. Without, as fast as
    /// possible
    #[arg(long)]
    real_time: bool,
    // Last: later options would stand under its heading.
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
    if let Target::Qemu = args.target {
        args.emulator.check(args.real_time)?;
    }
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
        Target::Qemu => args.emulator.run(&replay, args.real_time)?,
    };
    if let Some(row) = differences.first_block {
        say!(
            "blocks in which a bias or a flag differs: {}, the first one from row {} at {} s on",
            differences.blocks,
            row + 1,
            log.time_s[row]
        );
    }
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
    Ok(Exit::of(differences.count == 0 && differences.blocks == 0))
}

/// What is replayed.
struct Replay<'a> {
    set: &'a CoefficientSet,
    log: &'a Log,
    inputs: &'a [ChannelInputs<'a>],
    /// The image of the set.
    image: &'a Placed,
}

/// Rows for which firmware and host differ.
struct Differences {
    count: usize,
    first: Option<usize>,
    /// Blocks whose CRC of biases and flags differs, and the first row of the first one.
    blocks: usize,
    first_block: Option<usize>,
}

impl Replay<'_> {
    /// The rows of the log as the firmware takes them, with thermal updates where `apply` has them.
    fn samples<const C: usize, const A: usize>(&self) -> impl Iterator<Item = Sample<C, A>> {
        let (inputs, log) = (self.inputs, self.log);
        let mut updates = Updates::of_log(log, self.set.thermal_period_s(log.interval_s));
        log.time_s
            .iter()
            .enumerate()
            .map(move |(row, &time_s)| Sample {
                update_s: updates.due(time_s),
                temps_c: std::array::from_fn(|channel| inputs[channel].temp_c[row]),
                raw: std::array::from_fn(|channel| inputs[channel].row(row)),
            })
    }
}
