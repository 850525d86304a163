//! `tempco summarise`: a log in, all that a fit needs of it out.

use std::fs;
use std::path::PathBuf;

use anyhow::{Result, ensure};
use tempco_fit::Plan;
use tempco_fit::summary::{is_summary, summarise_file};

use crate::Exit;
use crate::output::{print, write_file};
use crate::plan_args::PlanArgs;
use crate::progress::Progress;
use crate::shared_args::{LogArgs, say_reading};

/// Reduce a chamber log to all that a fit needs of it
///
/// A summary has a few MB, however long the log is. `tempco fit` takes summaries in place of logs and
/// makes the same set, in less than a second. Only the figures of rows are then missing in the report.
/// What is left out, and how rows are averaged, is decided here and kept in the summary.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco summarise chamber.csv --out chamber.summary")]
pub(crate) struct Args {
    /// Chamber log of a unit: CSV (plain, gzip or zstd), Parquet, ULog of PX4 (.ulg) or DataFlash of
    /// ArduPilot (.bin)
    #[arg(value_name = "LOG.csv")]
    log: PathBuf,
    /// Where to write the summary
    #[arg(long, value_name = "LOG.summary")]
    out: PathBuf,
    #[command(flatten)]
    plan: PlanArgs,
    #[command(flatten)]
    reading: LogArgs,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let (log, out) = (&args.log, &args.out);
    ensure!(
        !is_summary(log),
        "{}: is a summary: expected the log it was made of",
        log.display()
    );
    // Two names may be of one file.
    let is_log =
        fs::canonicalize(out).is_ok_and(|out| fs::canonicalize(log).is_ok_and(|log| log == out));
    ensure!(
        !is_log,
        "{}: is the log: expected another name",
        out.display()
    );
    let reading = args.reading.options(None)?;
    let plan = Plan::new(args.plan.options(reading.scale_factor_arcsec))?;
    let progress = Progress::over([log]);
    let summary = summarise_file(log, &reading, &plan, |bytes| progress.add(bytes))?;
    drop(progress);
    say_reading(
        summary.file(),
        summary.reading(),
        summary.ignored_columns(),
        summary.skipped_rows(),
    );
    let bytes = summary.to_bytes();
    write_file(out, &bytes)?;
    print(format_args!(
        "{} rows; wrote {}: {:.1} MB",
        summary.rows(),
        out.display(),
        bytes.len() as f64 / 1e6
    ))?;
    Ok(Exit::Acceptable)
}
