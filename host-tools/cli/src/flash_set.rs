//! `tempco flash-set`: a coefficient set into a unit.

use std::path::PathBuf;

use anyhow::{Context, Result};
use tempco_hil::flash_set;

use crate::Verdict;
use crate::image;
use crate::output::print;
use crate::port_args::{PortArgs, bank_name};
use crate::progress::Progress;

/// Write a coefficient set into a unit over its serial port
///
/// The set goes into the bank that is not in use; the unit checks it, resets itself and runs on
/// it. Refuses a set of another serial number or shape before anything is written. Whatever fails,
/// the unit keeps the table it has.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Coefficient set (coefficients.json) or flash image (table.bin)
    #[arg(value_name = "SET")]
    set: PathBuf,
    #[command(flatten)]
    port: PortArgs,
}

pub(crate) fn run(args: &Args) -> Result<Verdict> {
    let image = image::of_set(&args.set)?;
    let mut unit = args.port.connect()?;
    let progress = Progress::over_upload(image.bytes().len() as u64);
    let written = flash_set(&mut unit, image.bytes(), |bytes| progress.at(bytes as u64));
    drop(progress);
    let now = written.with_context(|| args.set.display().to_string())?;
    print(format_args!(
        "unit {}, {}: runs on table {:08x}{}",
        now.serial,
        now.firmware,
        now.table_crc,
        now.bank.map(bank_name).unwrap_or_default()
    ))?;
    Ok(Verdict::Acceptable)
}
