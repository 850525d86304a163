//! `tempco fit`: logs in, coefficient set out.

use std::collections::BTreeSet;
use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};
use serde_json::json;
use tempco_fit::summary::{LogSummary, is_summary, read_summary};
use tempco_fit::{FitOptions, Plan};
use tempco_log::ReadOptions;
use tempco_report::Calibration;
use tempco_set::{CoefficientSet, file_names};

use crate::Exit;
use crate::answer::{Answer, channel_notes};
use crate::batch;
use crate::method_args::MethodArgs;
use crate::output::{figure, percent, print, print_lines, say, table};
use crate::plan_args::PlanArgs;
use crate::report::{ensure_rereadable, reading_again, rows_of, write_figures};
use crate::set_tables::{show_choice, show_states};
use crate::shared_args::{LogArgs, PrintArgs, Summaries};

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
    /// ArduPilot (.bin); or summaries of them, by `tempco summarise`
    #[arg(required_unless_present = "batch", value_name = "LOG.csv")]
    logs: Vec<PathBuf>,
    /// Serial number of the unit
    #[arg(long, required_unless_present = "batch")]
    serial: Option<String>,
    /// Fit all units of this folder. It holds a folder per serial number with the logs of the unit,
    /// or logs named SERIAL.csv or SERIAL_*.csv (also .csv.gz, .csv.zst, .parquet, .ulg, .bin, .summary)
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
    #[command(flatten)]
    plan: PlanArgs,
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

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let plan = plan(args)?;
    let options = FitOptions {
        serial: args.serial.clone().unwrap_or_default(),
        method: args.method.method(),
        plan: plan.options().clone(),
    };
    let reading = ReadOptions {
        scale_factor_arcsec: options.plan.scale_factor_arcsec,
        ..args.reading.options(None)?
    };
    if let Some(folder) = &args.batch {
        return batch::run(folder, &args.out, &reading, &options, !args.no_report);
    }
    if !args.no_report {
        ensure_rereadable(&args.logs)?;
    }
    match LogArgs::summarise_all(&args.logs, &reading, &plan)? {
        Summaries::Of(logs) => {
            let place = Place {
                out: args.out.clone(),
                figures: args.figures.clone(),
            };
            write_set(args, &place, &reading, &options, &logs)
        }
        Summaries::OfInstances(instances) => fit_each(args, &reading, &options, &plan, &instances),
    }
}

/// The plan by which the logs are summarised: the summaries among them say it, or the options.
///
/// # Errors
/// Options that the core refuses, or that come too late for a summary.
fn plan(args: &Args) -> Result<Plan> {
    let mut summaries = args.logs.iter().filter(|path| is_summary(path));
    let Some(summary) = summaries.next() else {
        return Ok(Plan::new(args.plan.options(args.reading.scale_factor))?);
    };
    let scale_factor = args.reading.scale_factor.map(|_| "--scale-factor");
    let has_logs = summaries.count() + 1 < args.logs.len();
    let of_reading = args.reading.given().filter(|_| !has_logs);
    if let Some(option) = args.plan.given().or(scale_factor).or(of_reading) {
        bail!(
            "{}: is a summary, which was made with such options: expected {option} with \
             `tempco summarise`, not here",
            summary.display()
        );
    }
    Ok(read_summary(summary)?.plan().clone())
}

/// Fits a set to each source in the logs, in a folder of its own; the exit code is the worst.
///
/// # Errors
/// That sets could not be made, after all of them were tried.
fn fit_each(
    args: &Args,
    reading: &ReadOptions,
    options: &FitOptions,
    plan: &Plan,
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
        let fitted = LogArgs::summarise_all(&args.logs, &reading, plan);
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
    let rows = rows_of(&args.logs);
    let rows = Some(&rows[..]).filter(|_| !args.no_report);
    let observer = reading_again(&args.logs);
    let calibration = Calibration::new(logs, options, rows, reading, observer)?;
    let (set, judgement, out) = (&calibration.fit.set, &calibration.judgement, &place.out);
    if let (Some(report), Some(folder)) = (&calibration.report, &place.figures) {
        write_figures(report, folder)?;
    }
    calibration.write(out).context("nothing was written")?;

    let names: Vec<&str> = file_names(!args.no_report).collect();
    let answer = Answer {
        set,
        judgement,
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
