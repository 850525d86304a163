//! `tempco flash-set`: writes a coefficient set into a unit.

use std::path::{Path, PathBuf};

use anyhow::{Context, Error, Result, ensure};
use tempco_hil::flash_set;
use tempco_set::{check_folder, load_set, table_bin};

use crate::Exit;
use crate::image::{Placed, is_image};
use crate::output::print;
use crate::progress::Progress;
use crate::shared_args::scale_factor;
use crate::unit::port_args::{PortArgs, bank_name};

/// Write a coefficient set into a unit over its serial port
///
/// The set goes into the bank that is not in use. The unit checks it, resets itself and runs on it.
/// A set of another serial number, shape, unit or scale factor, or of larger biases than the unit
/// takes, is refused before anything is written. If a step fails, the unit keeps its table.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco flash-set RLG-7/coefficients.json --port /dev/ttyUSB0")]
pub(crate) struct Args {
    /// Coefficient set (coefficients.json) or flash image (table.bin)
    #[arg(value_name = "SET")]
    set: PathBuf,
    /// Angle per pulse, in arcsec, for a coefficients.json in deg/h, deg/s or rad/s that does not
    /// state it
    #[arg(long, value_name = "ARCSEC", value_parser = scale_factor, allow_negative_numbers = true)]
    scale_factor: Option<f64>,
    #[command(flatten)]
    port: PortArgs,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let image = image_of(&args.set, args.scale_factor)?;
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
    Ok(Exit::Acceptable)
}

/// The image of a set: read from a file, or made from `coefficients.json`. A scale factor is given
/// where the set does not state its own \[arcsec/pulse\].
fn image_of(path: &Path, scale_factor_arcsec: Option<f64>) -> Result<Placed> {
    if is_image(path) {
        ensure!(
            scale_factor_arcsec.is_none(),
            "--scale-factor: {}: expected coefficients.json; an image holds its own",
            path.display()
        );
        check_folder(path)?;
        return Placed::read(path);
    }
    let mut set = load_set(path)?;
    if let Some(given) = scale_factor_arcsec {
        let of_set = *set.settings.scale_factor_arcsec.get_or_insert(given);
        ensure!(
            given == of_set,
            "--scale-factor {given}: the set was fitted with {of_set} arcsec per pulse"
        );
    }
    let image = table_bin(&set).map_err(Error::msg)?;
    Ok(Placed::of(&image))
}
