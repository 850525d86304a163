//! `tempco export` and `tempco import`: sets as parameters of autopilots.

use std::io::{self, Write};
use std::path::PathBuf;

use anyhow::{Context, Result, anyhow};
use clap::{ValueEnum, value_parser};
use tempco_evaluate::judge;
use tempco_log::AxisUnit;
use tempco_set::parameters::{Autopilot, Loss, export_parameters, import_parameters};
use tempco_set::{file_names, load_set, write_set};

use crate::Exit;
use crate::judgement::say_rejections;
use crate::output::{figure, print, print_lines, say, table, write_file};

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Parameters TC_G0_* of PX4
    Px4,
    /// Parameters INS_TCAL1_* of ArduPilot
    Ardupilot,
}

impl Format {
    const fn autopilot(self) -> Autopilot {
        match self {
            Self::Px4 => Autopilot::Px4,
            Self::Ardupilot => Autopilot::ArduPilot,
        }
    }

    /// The first gyro, unless another is given.
    fn instance(self, given: Option<u32>) -> u32 {
        given.unwrap_or(*self.autopilot().instances().start())
    }
}

/// Write a set as parameters of an autopilot, and say what they lose
///
/// Autopilots have one cubic in temperature for each axis. The bias at rest is fitted by it; rate and
/// history are lost. `tempco import` makes a set of the parameters again, which `tempco evaluate`
/// judges.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco export IMU-7/coefficients.json --to px4 --out imu.params")]
pub(crate) struct ExportArgs {
    /// Coefficient set (coefficients.json) of a gyro with the axes x, y and z
    #[arg(value_name = "SET")]
    set: PathBuf,
    /// Whose parameters
    #[arg(long)]
    to: Format,
    /// Where to write them. Default: they are printed
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Number of the gyro. Default: the first, 0 of PX4 and 1 of ArduPilot
    #[arg(long, value_name = "N")]
    instance: Option<u32>,
    /// Device id of the gyro, for PX4, which uses the parameters for this gyro alone
    #[arg(
        long,
        value_name = "ID",
        default_value_t = 0,
        value_parser = value_parser!(i32).range(0..),
        allow_negative_numbers = true
    )]
    device_id: i32,
}

pub(crate) fn export(args: &ExportArgs) -> Result<Exit> {
    let set = load_set(&args.set)?;
    let judgement = judge(&set, None);
    let instance = args.to.instance(args.instance);
    let exported = export_parameters(&set, args.to.autopilot(), instance, args.device_id)
        .map_err(|message| anyhow!("{}: {message}", args.set.display()))?;
    match &args.out {
        Some(path) => {
            write_file(path, exported.text.as_bytes())?;
            print_lines(losses(&exported.losses))?;
            print(format_args!("wrote {}", path.display()))?;
        }
        None => {
            // Names of ours and numbers alone: nothing in it needs an escape, and tabs must stay.
            io::stdout().lock().write_all(exported.text.as_bytes())?;
            let table = losses(&exported.losses).to_string();
            table.lines().for_each(|line| say!("{line}"));
        }
    }
    if args.to == Format::Px4 && args.device_id == 0 {
        say!(
            "TC_G{instance}_ID is 0: PX4 uses the parameters once it is the device id of the gyro, \
             which `listener sensor_gyro` shows (--device-id)"
        );
    }
    say_rejections(args.set.display(), &judgement);
    Ok(Exit::of(judgement.is_accepted()))
}

/// What is lost, axis by axis.
fn losses(losses: &[Loss]) -> comfy_table::Table {
    let header = [
        "axis",
        "unit",
        "bias range",
        "cubic off by",
        "RMS",
        "lost: rate, history",
    ];
    let rows = losses.iter().map(|of| {
        vec![
            of.axis.clone(),
            of.unit.to_string(),
            figure(of.static_range),
            format!(
                "{} ({} %)",
                figure(of.largest),
                figure(100.0 * of.largest / of.static_range)
            ),
            figure(of.rms),
            figure(of.rate_and_history),
        ]
    });
    table(&header, rows)
}

/// Make a set of parameters of an autopilot
///
/// A cubic becomes quadratic cells. Nothing is known of the fit behind it, so the set must be judged:
/// `tempco evaluate` does it on a log.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco import imu.params --from px4 --out IMU-7")]
pub(crate) struct ImportArgs {
    /// File of parameters
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Whose parameters
    #[arg(long)]
    from: Format,
    /// Folder for the set. Default: named as the file, without its extension
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of the gyro. Default: the first, 0 of PX4 and 1 of ArduPilot
    #[arg(long, value_name = "N")]
    instance: Option<u32>,
    /// Serial number of the unit
    #[arg(long, default_value = "imported")]
    serial: String,
    /// Unit of the axes, as in the logs: dph, dps or radps
    #[arg(long, default_value = "radps", value_parser = unit)]
    unit: AxisUnit,
}

fn unit(name: &str) -> Result<AxisUnit, String> {
    let units = [AxisUnit::Dph, AxisUnit::Dps, AxisUnit::Radps];
    let found = units.into_iter().find(|unit| unit.name() == name);
    found.ok_or_else(|| "expected dph, dps or radps".to_owned())
}

pub(crate) fn import(args: &ImportArgs) -> Result<Exit> {
    let instance = args.from.instance(args.instance);
    let imported = import_parameters(
        &args.file,
        args.from.autopilot(),
        instance,
        args.unit,
        &args.serial,
    )?;
    let out = args.out.clone();
    let out = out.unwrap_or_else(|| args.file.with_extension(""));
    write_set(&out, &imported.set, None).context("nothing was written")?;
    let table = &imported.set.channels[0].table;
    print(format_args!(
        "cubics as {} quadratic cells, off by {} % of the bias range at most, {} to {} degC",
        imported.cells,
        figure(100.0 * imported.deviation),
        figure(table.t_min_c.into()),
        figure(table.t_max_c.into())
    ))?;
    let names: Vec<&str> = file_names(false).collect();
    print(format_args!(
        "wrote {}: {}",
        out.display(),
        names.join(", ")
    ))?;
    Ok(Exit::Acceptable)
}
