//! `tempco bit`: the built-in test of a unit.

use anyhow::Result;

use crate::Exit;
use crate::output::{print, print_lines, table};
use crate::unit::port_args::PortArgs;

/// Run the built-in test of a unit
///
/// The unit computes a known answer, reads its flash as a whole, and names every fault that is
/// present. docs/unit.md says what each one means.
///
/// Exit code 1: a fault is present.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco bit --port /dev/ttyUSB0")]
pub(crate) struct Args {
    #[command(flatten)]
    port: PortArgs,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let mut unit = args.port.connect()?;
    let serial = unit.identify()?.serial;
    let faults = unit.built_in_test()?;
    let found: Vec<_> = faults.iter().collect();
    if found.is_empty() {
        print(format_args!("unit {serial}: built-in test passed"))?;
        return Ok(Exit::Acceptable);
    }
    print(format_args!("unit {serial}: built-in test failed"))?;
    let rows = found.into_iter().map(|fault| {
        let output = if fault.is_invalidating() {
            "invalid"
        } else {
            "degraded"
        };
        vec![fault.name().to_owned(), output.to_owned()]
    });
    print_lines(table(&["fault", "output"], rows))?;
    Ok(Exit::NotAcceptable)
}
