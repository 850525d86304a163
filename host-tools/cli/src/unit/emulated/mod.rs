//! `tempco unit`: an emulated unit, for every command that takes a port.

mod line;
mod world;

use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::thread;

use anyhow::{Context, Result};
use tempco_qemu::{Board, Machine, MachineOptions, MachineTime, Variant};
use tempco_set::files::ScratchFolder;
use tempco_set::load_set;
use tempco_twin::Simulation;

use self::line::{listen, relay};
use self::world::World;
use super::firmware::build;
use crate::Exit;
use crate::output::print;
use crate::simulate::{profile, unit};

/// As fast as the host's time: an instruction takes 64 ns, so that a busy host slows the unit down
/// and takes no time from it.
const AT_PACE: MachineTime = MachineTime::Counted { shift: 6 };

/// As fast as it goes: an instruction takes 512 ns. The unit needs 0.8 million of them per second.
const FAST: MachineTime = MachineTime::Unbound { shift: 9 };

/// Run an emulated unit in a simulated chamber
///
/// Builds the firmware, and runs it in QEMU until Ctrl-C, with empty flash. A simulation plays the
/// thermometer and the gyros. Every command with --port takes the socket as its port.
///
/// This needs the sources of tempco; the compiler target and the emulator are installed if they are
/// missing.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco unit --qemu --socket /tmp/unit --profile short --fast")]
pub(crate) struct Args {
    /// In QEMU, the one emulator there is
    #[arg(long, required = true)]
    qemu: bool,
    /// Where the socket of the unit's serial line is to be
    #[arg(long, value_name = "PATH")]
    socket: PathBuf,
    /// Build the firmware for the serial number and axes of this coefficients.json. Without, it is
    /// unit EXAMPLE of three axes in pulses/s
    #[arg(long, value_name = "SET")]
    table: Option<PathBuf>,
    /// The simulated gyros: a name from `tempco simulate --list`, or a TOML file
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "paper")]
    unit: String,
    /// The chamber profile: a name from `tempco simulate --list`, or a TOML file. After its end,
    /// everything stays as it is
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "rest")]
    profile: String,
    /// Seed of all noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Let the unit's time pass as fast as this machine can, and only while a command talks to it.
    /// Without, it passes as here
    #[arg(long)]
    fast: bool,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let (unit, profile) = (unit(&args.unit)?, profile(&args.profile)?);
    let run = Simulation::new(&unit, &profile, args.seed, world::RATE_HZ)?;
    let world = World::new(run).context("--profile: expected at least one sample")?;
    let listener = listen(&args.socket)?;
    let set = args.table.as_deref().map(load_set).transpose()?;
    let elf = build(set.as_ref(), Board::Mps2An386, "unit", &Variant::WORLD)?;
    let time = if args.fast { FAST } else { AT_PACE };
    let mut machine = start(&elf, time, world)?;
    if args.fast {
        machine.pause()?;
    }
    print(format_args!(
        "unit {} at {}: gyros {}, chamber {}; Ctrl-C ends it",
        set.as_ref().map_or("EXAMPLE", |set| &set.serial),
        args.socket.display(),
        args.unit,
        args.profile
    ))?;
    loop {
        let (client, _) = listener.accept()?;
        let unit = UnixStream::connect(machine.link()).context("the emulator has ended")?;
        if args.fast {
            machine.go_on()?;
        }
        relay(&client, &unit);
        if args.fast {
            machine.pause()?;
        }
    }
}

/// The unit, in its world.
fn start(elf: &Path, time: MachineTime, mut world: World) -> Result<Machine> {
    let folder = ScratchFolder::new()?;
    let socket = folder.path().join("world");
    let chardev = format!(
        "socket,id=world,path={},server=on,wait=off",
        socket.display()
    );
    let options = MachineOptions {
        time,
        extra: ["-chardev", &chardev, "-serial", "chardev:world"]
            .map(str::to_owned)
            .to_vec(),
        ..MachineOptions::default()
    };
    let machine = Machine::start(elf, Board::Mps2An386, &options)?;
    let line = UnixStream::connect(&socket).with_context(|| socket.display().to_string())?;
    // It ends with the emulator.
    thread::spawn(move || world.serve(line));
    Ok(machine)
}
