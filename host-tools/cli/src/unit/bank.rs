//! `tempco bank`: the two tables in a unit.

use anyhow::Result;
use tempco_hil::{Unit, activate, download};
use tempco_link::Bank;

use crate::Exit;
use crate::image::Placed;
use crate::output::{print, print_lines, table};
use crate::unit::port_args::{PortArgs, bank_name};

/// Show the two tables in a unit, or go back to the other one
///
/// With a bank, the unit resets itself and runs on the table in it. `flash-set` writes into the
/// bank that is not in use, so the other bank holds the table before.
///
/// Exit code 1: there is no good table in a bank.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco bank --port /dev/ttyUSB0 --use A")]
pub(crate) struct Args {
    #[command(flatten)]
    port: PortArgs,
    /// Bank with the table to run on from now on
    #[arg(long = "use", value_name = "A|B", value_parser = bank)]
    chosen: Option<Bank>,
}

fn bank(text: &str) -> Result<Bank, &'static str> {
    match text {
        "A" | "a" => Ok(Bank::A),
        "B" | "b" => Ok(Bank::B),
        _ => Err("expected A or B"),
    }
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let mut unit = args.port.connect()?;
    if let Some(bank) = args.chosen {
        let now = activate(&mut unit, bank)?;
        print(format_args!(
            "unit {}: runs on table {:08x}{}",
            now.serial,
            now.table_crc,
            bank_name(bank)
        ))?;
        return Ok(Exit::Acceptable);
    }
    let identity = unit.identify()?;
    print(format_args!(
        "unit {}, {}",
        identity.serial, identity.firmware
    ))?;
    let mut rows = Vec::new();
    let mut are_good = true;
    for (bank, name) in [(Bank::A, "A"), (Bank::B, "B")] {
        let (contents, is_good) = contents(&mut unit, bank)?;
        are_good &= is_good;
        let is_used = identity.bank == Some(bank);
        let mut row = vec![name.to_owned(), if is_used { "yes" } else { "" }.to_owned()];
        row.extend(contents);
        rows.push(row);
    }
    print_lines(table(
        &["bank", "in use", "serial", "table", "bytes", "state"],
        rows,
    ))?;
    Ok(Exit::of(are_good))
}

/// Serial number, CRC of the table, length and state of what is in a bank, and whether it is good.
fn contents(unit: &mut Unit, bank: Bank) -> Result<([String; 4], bool)> {
    let bytes = download(unit, bank)?;
    let placed = Placed::of(&bytes);
    Ok(match placed.image() {
        Ok(image) => {
            let info = image.info();
            let crc = format!("{:08x}", info.table_crc);
            let len = bytes.len().to_string();
            ([info.serial.to_owned(), crc, len, "good".to_owned()], true)
        }
        Err(_) if bytes.is_empty() => {
            let [serial, crc, len] = <[String; 3]>::default();
            ([serial, crc, len, "empty".to_owned()], false)
        }
        Err(error) => {
            let len = bytes.len().to_string();
            let [serial, crc] = <[String; 2]>::default();
            ([serial, crc, len, error.to_string()], false)
        }
    })
}
