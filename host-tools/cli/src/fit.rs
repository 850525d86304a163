//! `tempco fit`: logs in, coefficient set out.

use std::collections::BTreeSet;
use std::path::PathBuf;

use anyhow::{Result, bail, ensure};
use serde_json::json;
use tempco::ThermalSettings;
use tempco_fit::summary::LogSummary;
use tempco_fit::{FitOptions, fit_summaries};
use tempco_log::ReadOptions;
use tempco_set::{CoefficientSet, Stretch, file_names};

use crate::Exit;
use crate::answer::{Answer, channel_notes};
use crate::batch;
use crate::method_args::MethodArgs;
use crate::output::{figure, percent, print, print_lines, say, table};
use crate::report::{ensure_rereadable, write_figures};
use crate::set_files::{report_on, write};
use crate::set_tables::{show_choice, show_states};
use crate::shared_args::{LogArgs, PrintArgs, Summaries, averaging_time};

/// Fit a coefficient set to the chamber logs of a unit
///
/// Writes five files into DIR, all or none: coefficients.json (the set), report.html, and the table
/// for firmware as table.bin (flash image), table.rs and table.h.
///
/// A log of PX4 or ArduPilot may hold several sensors. Each then gets a set of its own: DIR/imu0 with
/// the serial number SN-0, and so on. --instance fits one of them.
///
/// With --batch, fits every unit of a folder. Each gets its own folder DIR/SERIAL. DIR/summary.html
/// and DIR/summary.csv compare the units. A unit that fails is listed there with its error; the
/// others are fitted, and the exit code is 1.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco fit chamber.csv --serial RLG-7 --out RLG-7")]
pub(crate) struct Args {
    /// Chamber logs of the unit: CSV (plain, gzip or zstd), Parquet, ULog of PX4 (.ulg) or DataFlash of
    /// ArduPilot (.bin)
    #[arg(required_unless_present = "batch", value_name = "LOG.csv")]
    logs: Vec<PathBuf>,
    /// Serial number of the unit
    #[arg(long, required_unless_present = "batch")]
    serial: Option<String>,
    /// Fit all units of this folder. It holds a folder per serial number with the logs of the unit,
    /// or logs named SERIAL.csv or SERIAL_*.csv (also .csv.gz, .csv.zst, .parquet, .ulg, .bin)
    #[arg(
        long,
        value_name = "FOLDER",
        conflicts_with_all = ["logs", "serial", "json", "verbose"]
    )]
    batch: Option<PathBuf>,
    /// Folder for the set; made if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    method: MethodArgs,
    /// Leave a stretch of time out of the fit, in s, in every log. May be repeated
    #[arg(long, value_name = "T1:T2", value_parser = stretch, allow_hyphen_values = true)]
    exclude: Vec<Stretch>,
    /// Keep spikes and disturbances in the fit
    #[arg(long)]
    keep_outliers: bool,
    /// Fastest change of temperature that a unit can have, in degC/min
    #[arg(long, value_name = "RATE", default_value_t = ThermalSettings::DEFAULT.max_slew_c_per_min, allow_negative_numbers = true)]
    max_slew: f32,
    /// Averaging time of the bias stability, in s
    #[arg(
        long,
        value_name = "S",
        default_value_t = 100.0,
        value_parser = averaging_time,
        allow_negative_numbers = true
    )]
    tau: f64,
    /// Also write the figures of the report into this folder, as SVG files
    #[arg(long, value_name = "DIR", conflicts_with_all = ["batch", "no_report"])]
    figures: Option<PathBuf>,
    /// Write no report.html. For the report, every log is read a second time
    #[arg(long)]
    no_report: bool,
    #[command(flatten)]
    print: PrintArgs,
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
    let reading = args.reading.options(None)?;
    if let Some(folder) = &args.batch {
        return batch::run(folder, &args.out, &reading, &options, !args.no_report);
    }
    if !args.no_report {
        ensure_rereadable(&args.logs)?;
    }
    match LogArgs::summarise_all(&args.logs, &reading, &options.plan()?)? {
        Summaries::Of(logs) => {
            let place = Place {
                out: args.out.clone(),
                figures: args.figures.clone(),
            };
            write_set(args, &place, &reading, &options, &logs)
        }
        Summaries::OfInstances(instances) => fit_each(args, &reading, &options, &instances),
    }
}

/// Fits a set to each source in the logs, in a folder of its own; the exit code is the worst.
///
/// # Errors
/// That sets could not be made, after all of them were tried.
fn fit_each(
    args: &Args,
    reading: &ReadOptions,
    options: &FitOptions,
    instances: &BTreeSet<u32>,
) -> Result<Exit> {
    ensure_rereadable(&args.logs)?;
    let (mut exit, mut failed) = (Exit::Acceptable, Vec::new());
    for (number, instance) in instances.iter().enumerate() {
        if number > 0 && !args.print.json {
            print("")?;
        }
        let name = format!("imu{instance}");
        let mut reading = reading.clone();
        reading.mapping.instance = Some(*instance);
        let options = FitOptions {
            serial: format!("{}-{instance}", options.serial),
            ..options.clone()
        };
        let place = Place {
            out: args.out.join(&name),
            figures: args.figures.as_ref().map(|folder| folder.join(&name)),
        };
        let fitted = LogArgs::summarise_all(&args.logs, &reading, &options.plan()?);
        let fitted = fitted.and_then(|logs| match logs {
            Summaries::Of(logs) => write_set(args, &place, &reading, &options, &logs),
            Summaries::OfInstances(_) => bail!("the logs were changed while they were read"),
        });
        match fitted {
            Ok(Exit::Acceptable) => {}
            Ok(Exit::NotAcceptable) => exit = Exit::NotAcceptable,
            Err(error) => {
                say!("{name}: {error:#}");
                failed.push(name);
            }
        }
    }
    ensure!(
        failed.is_empty(),
        "no set was made of {}",
        failed.join(", ")
    );
    Ok(exit)
}

/// Where a set is written.
struct Place {
    out: PathBuf,
    figures: Option<PathBuf>,
}

/// Fits a set to logs, writes it and says how it does.
fn write_set(
    args: &Args,
    place: &Place,
    reading: &ReadOptions,
    options: &FitOptions,
    logs: &[LogSummary],
) -> Result<Exit> {
    let fit = fit_summaries(logs, options)?;
    let (set, judgement, out) = (&fit.set, fit.judge(), &place.out);
    let report = if args.no_report {
        None
    } else {
        Some(report_on(set, &judgement, &args.logs, reading, args.tau)?)
    };
    if let (Some(report), Some(folder)) = (&report, &place.figures) {
        write_figures(report, folder)?;
    }
    write(out, set, report.as_ref())?;

    let names: Vec<&str> = file_names(!args.no_report).collect();
    let answer = Answer {
        set,
        judgement: &judgement,
        evaluation: None,
        is_against: false,
        notes: set.channels.iter().flat_map(channel_notes).collect(),
        written: vec![format!("wrote {}: {}", out.display(), names.join(", "))],
    };
    let json = || {
        let files = names
            .iter()
            .map(|name| out.join(name).display().to_string());
        json!({"set": set, "files": files.collect::<Vec<_>>()})
    };
    answer.print(&args.print, out, json, || show(set))?;
    Ok(Exit::of(judgement.is_accepted()))
}

fn options(args: &Args) -> Result<FitOptions> {
    Ok(FitOptions {
        serial: args.serial.clone().unwrap_or_default(),
        method: args.method.method(),
        thermal: args.method.thermal(args.max_slew),
        exclude: args.exclude.clone(),
        robust: !args.keep_outliers,
        scale_factor_arcsec: args.reading.scale_factor,
        tau_s: args.tau,
    })
}

/// All that a fit says of itself.
fn show(set: &CoefficientSet) -> Result<()> {
    show_statistics(set)?;
    set.channels.iter().try_for_each(show_states)?;
    set.channels.iter().try_for_each(show_choice)
}

fn show_statistics(set: &CoefficientSet) -> Result<()> {
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
    // Per axis, errors of rows and sigmas of means; of a single mean there is no sigma.
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
    let tau_s = set.axes().find_map(|(_, axis)| axis.statistics);
    let tau_s = tau_s.map_or(f64::NAN, |of| of.tau_s);
    print(format_args!(
        "on the fitted logs: RMSE of single rows, sigma of {tau_s} s means; cubic: one cubic in T on \
         the same rows"
    ))
}
