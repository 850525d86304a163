//! `tempco faults`: the fault log of a unit.

use anyhow::Result;
use tempco_link::{Fault, FaultEntry};

use crate::Exit;
use crate::output::{print, print_lines, table};
use crate::unit::port_args::PortArgs;

/// Show the fault log of a unit
///
/// Prints each fault, how often and when last it occurred, what was lost since power-on, and how often
/// the flash was erased.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco faults --port /dev/ttyUSB0")]
pub(crate) struct Args {
    #[command(flatten)]
    port: PortArgs,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let mut unit = args.port.connect()?;
    let faults = unit.faults()?;
    if faults.is_empty() {
        print("no fault has occurred")?;
    } else {
        show(&faults)?;
    }
    let losses = unit.losses()?;
    print(format_args!(
        "lost since power-on: {} gyro samples, {} outcomes for telemetry, {} of replays",
        losses.missed_samples, losses.moments, losses.replies
    ))?;
    let wear = unit.wear()?;
    print(format_args!(
        "erased so far, each half: fault log {} times, offsets {}",
        wear.faults, wear.offsets
    ))?;
    Ok(Exit::Acceptable)
}

fn show(faults: &[FaultEntry]) -> Result<()> {
    let rows = faults.iter().map(|entry| {
        let name = Fault::from_code(entry.code).map_or("(of newer firmware)", Fault::name);
        vec![
            name.to_owned(),
            entry.code.to_string(),
            entry.count.to_string(),
            entry.boot.to_string(),
            entry.uptime_s.to_string(),
            format!("{:#x}", entry.detail),
        ]
    });
    let header = ["fault", "code", "times", "last in boot", "at [s]", "detail"];
    print_lines(table(&header, rows))
}
