//! `tempco evaluate`: how much better the compensated log is.

use std::path::PathBuf;

use anyhow::{Result, anyhow, ensure};
use tempco_fit::apply::apply;
use tempco_fit::load_set;
use tempco_fit::metrics::{Evaluation, evaluate};

use crate::Verdict;
use crate::output::{figure, percent, print, table};
use crate::shared_args::LogArgs;

/// Judge a coefficient set on a log
///
/// Exits with 1 where the compensation of an axis is no better than none.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Coefficient set (coefficients.json)
    #[arg(value_name = "SET")]
    set: PathBuf,
    /// Log to judge on, best one that the set was not fitted to (CSV)
    #[arg(value_name = "LOG.csv")]
    log: PathBuf,
    /// Averaging time, in s
    #[arg(
        long,
        value_name = "S",
        default_value_t = 100.0,
        allow_negative_numbers = true
    )]
    tau: f64,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: LogArgs,
}

pub(crate) fn run(args: &Args) -> Result<Verdict> {
    ensure!(
        args.tau.is_finite() && args.tau > 0.0,
        "--tau {}: expected seconds, above 0",
        args.tau
    );
    let set = load_set(&args.set)?;
    let log = args
        .reading
        .read(&args.log, set.settings.scale_factor_arcsec)?;
    let applied = apply(&set, &log)?;
    let evaluation = evaluate(&set, &log.time_s, log.interval_s, &applied, args.tau)
        .map_err(|message| anyhow!("{}: {message}", args.log.display()))?;
    if args.json {
        print(serde_json::to_string(&evaluation)?)?;
    } else {
        show(&evaluation)?;
    }
    let worse: Vec<&str> = evaluation
        .axes
        .iter()
        .filter(|axis| !axis.is_acceptable())
        .map(|axis| axis.axis.as_str())
        .collect();
    if !worse.is_empty() {
        eprintln!(
            "not acceptable: the compensation is no better than none on {}",
            worse.join(", ")
        );
    }
    Ok(Verdict::of(worse.is_empty()))
}

fn show(evaluation: &Evaluation) -> Result<()> {
    let rows = evaluation.axes.iter().zip(&evaluation.max_boundary_jump);
    let rows = rows.map(|(axis, jump)| {
        vec![
            axis.axis.clone(),
            axis.unit.to_owned(),
            axis.n.to_string(),
            figure(axis.sigma_raw),
            figure(axis.sigma_compensated),
            percent(axis.improvement),
            figure(axis.rmse_raw),
            figure(axis.rmse_compensated),
            figure(axis.max_abs_compensated),
            figure(*jump),
        ]
    });
    let header = [
        "axis",
        "unit",
        "n",
        "sigma raw",
        "sigma comp.",
        "improvement",
        "RMSE raw",
        "RMSE comp.",
        "max |error|",
        "max jump",
    ];
    print(table(&header, rows))?;
    print(format_args!(
        "figures of {} s means; RMSE about the mean of the log",
        evaluation.tau_s
    ))?;
    for (flag, rows) in &evaluation.status_rows {
        print(format_args!("status {flag}: {rows} rows"))?;
    }
    Ok(())
}
