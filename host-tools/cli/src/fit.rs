//! `tempco fit`: logs in, coefficient set out.

use std::path::PathBuf;

use anyhow::Result;
use serde_json::json;
use tempco::ThermalSettings;
use tempco_fit::{FitOptions, fit_summaries};
use tempco_set::{CoefficientSet, Stretch, file_names};

use crate::Exit;
use crate::batch;
use crate::judgement::{print_as_json, say_rejections, show};
use crate::method_args::MethodArgs;
use crate::output::{figure, percent, print, print_lines, table};
use crate::report::{ensure_rereadable, write_figures};
use crate::set_files::{report_on, write};
use crate::set_tables::{show_choice, show_states};
use crate::shared_args::{LogArgs, averaging_time};

/// Fit a coefficient set to one or more chamber logs of a unit
///
/// Writes DIR/coefficients.json, DIR/report.html, and the table for firmware as DIR/table.bin (flash
/// image), DIR/table.rs and DIR/table.h: all of them or none. With --batch, every unit found in a
/// folder: DIR/SERIAL/ for each, DIR/summary.csv and DIR/summary.html; a unit that fails is in the
/// summary with its error and makes the exit code 1, the others are fitted all the same.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Chamber logs of the unit: CSV, as it is or packed by gzip or zstd, or Parquet
    #[arg(required_unless_present = "batch", value_name = "LOG.csv")]
    logs: Vec<PathBuf>,
    /// Serial number of the unit
    #[arg(long, required_unless_present = "batch")]
    serial: Option<String>,
    /// Fit all units in this folder: a sub-folder per serial number with its logs, or logs named
    /// SERIAL.csv or SERIAL_*.csv (also .csv.gz, .csv.zst, .parquet)
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["logs", "serial"])]
    batch: Option<PathBuf>,
    /// Folder for the set; made if need be
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    method: MethodArgs,
    /// Leave a stretch of log time out of the fit, in s, in every log (repeat)
    #[arg(long, value_name = "T1:T2", value_parser = stretch, allow_hyphen_values = true)]
    exclude: Vec<Stretch>,
    /// Fit spikes and disturbances like everything else
    #[arg(long)]
    keep_outliers: bool,
    /// Fastest believable change of temperature, in degC/min
    #[arg(long, value_name = "RATE", default_value_t = ThermalSettings::DEFAULT.max_slew_c_per_min, allow_negative_numbers = true)]
    max_slew: f32,
    /// Averaging time of the printed figures, in s
    #[arg(
        long,
        value_name = "S",
        default_value_t = 100.0,
        value_parser = averaging_time,
        allow_negative_numbers = true
    )]
    tau: f64,
    /// Write the figures of the report into a folder as well, as SVG files
    #[arg(long, value_name = "DIR", conflicts_with_all = ["batch", "no_report"])]
    figures: Option<PathBuf>,
    /// Write no report.html, for which every log is read once more
    #[arg(long)]
    no_report: bool,
    /// Print one JSON object instead of tables: the set, the verdict and why, the files
    #[arg(long, conflicts_with = "batch")]
    json: bool,
    #[command(flatten)]
    reading: LogArgs,
}

fn stretch(text: &str) -> Result<Stretch, String> {
    let ends = text.split_once(':').and_then(|(from, to)| {
        let (from_s, to_s) = (from.trim().parse().ok()?, to.trim().parse().ok()?);
        (from_s < to_s).then_some(Stretch { from_s, to_s })
    });
    ends.ok_or_else(|| "expected T1:T2 in s, T1 before T2".to_owned())
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let options = options(args)?;
    let reading = args.reading.options(None);
    if let Some(folder) = &args.batch {
        return batch::run(folder, &args.out, &reading, &options, !args.no_report);
    }
    if !args.no_report {
        ensure_rereadable(&args.logs)?;
    }
    let logs = args.reading.summarise_all(&args.logs, &options.plan()?)?;
    let fit = fit_summaries(&logs, &options)?;
    let (set, judgement) = (&fit.set, fit.judge());
    let report = if args.no_report {
        None
    } else {
        Some(report_on(set, &judgement, &args.logs, &reading, args.tau)?)
    };
    if let (Some(report), Some(folder)) = (&report, &args.figures) {
        write_figures(report, folder)?;
    }
    write(&args.out, set, report.as_ref())?;

    let files = files(args);
    if args.json {
        let found = json!({"set": set, "files": files});
        print_as_json(found, &judgement)?;
    } else {
        summarise(set, args.tau)?;
        print(format_args!("wrote {}", files.join(", ")))?;
        set.channels.iter().try_for_each(show_states)?;
        set.channels.iter().try_for_each(show_choice)?;
        show(&judgement)?;
    }
    say_rejections(args.out.display(), &judgement);
    Ok(Exit::of(judgement.is_accepted()))
}

fn options(args: &Args) -> Result<FitOptions> {
    Ok(FitOptions {
        serial: args.serial.clone().unwrap_or_default(),
        method: args.method.method()?,
        thermal: args.method.thermal(args.max_slew),
        exclude: args.exclude.clone(),
        robust: !args.keep_outliers,
        scale_factor_arcsec: args.reading.scale_factor,
        tau_s: args.tau,
    })
}

/// Paths of what was written into the folder of the set.
fn files(args: &Args) -> Vec<String> {
    let names = file_names(!args.no_report);
    let paths = names.map(|name| args.out.join(name).display().to_string());
    paths.collect()
}

fn summarise(set: &CoefficientSet, tau_s: f64) -> Result<()> {
    for channel in &set.channels {
        let data = &channel.table;
        print(format_args!(
            "{} of unit {}: {} segments, {} cells, {} to {} degC, {} to {} degC/min, rate \
             tau {} s, kappa {}",
            channel.temperature,
            set.serial,
            channel.segments.len(),
            data.cells.len(),
            figure(data.t_min_c.into()),
            figure(data.t_max_c.into()),
            figure(data.thermal.rate_min_c_per_min.into()),
            figure(data.thermal.rate_max_c_per_min.into()),
            figure(data.thermal.tau_s.into()),
            figure(data.thermal.kappa.into()),
        ))?;
    }
    let rows = set.axes().filter_map(|(_, axis)| {
        let s = axis.statistics?;
        let sigma = |value| {
            if s.n > 1 {
                figure(value)
            } else {
                "-".to_owned()
            }
        };
        Some(vec![
            axis.name.clone(),
            axis.unit.to_string(),
            figure(s.rmse_raw),
            figure(s.rmse_cubic),
            figure(s.rmse_compensated),
            s.n.to_string(),
            sigma(s.sigma_raw),
            sigma(s.sigma_cubic),
            sigma(s.sigma_compensated),
            if s.n > 1 {
                percent(1.0 - s.sigma_compensated / s.sigma_raw)
            } else {
                "-".to_owned()
            },
        ])
    });
    let header = [
        "axis",
        "unit",
        "RMSE raw",
        "cubic",
        "comp.",
        "n",
        "sigma raw",
        "cubic",
        "comp.",
        "improvement",
    ];
    print_lines(table(&header, rows))?;
    let mut statistics = set.axes().filter_map(|(_, axis)| axis.statistics);
    let tau_s = statistics.next().map_or(tau_s, |of_axis| of_axis.tau_s);
    print(format_args!(
        "on the fitted logs: RMSE of single rows, sigma of {tau_s} s means; cubic: one cubic in T on the \
         same rows"
    ))
}
