//! `tempco evaluate`: how much better the compensated log is.

mod show;

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use tempco_fit::load_set;
use tempco_fit::metrics::evaluate;

use crate::Verdict;
use crate::output::print;
use crate::shared_args::SetAndLog;

/// Judge a coefficient set on a log
///
/// Bias stability, residuals, hysteresis, Allan deviation, boundaries and coverage; docs/metrics.md
/// says what each figure means. Exits with 1 where the compensation of an axis is no better than
/// none.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Set to compare with, such as the one in use; without, the static part of SET
    #[arg(long, value_name = "SET")]
    against: Option<PathBuf>,
    /// Averaging time, in s
    #[arg(
        long,
        value_name = "S",
        default_value_t = 100.0,
        allow_negative_numbers = true
    )]
    tau: f64,
    /// Print one JSON object instead of tables
    #[arg(long)]
    json: bool,
    // Last, since what follows would stand under its heading.
    #[command(flatten)]
    put: SetAndLog,
}

pub(crate) fn run(args: &Args) -> Result<Verdict> {
    ensure!(
        args.tau.is_finite() && args.tau > 0.0,
        "--tau {}: expected seconds, above 0",
        args.tau
    );
    let (set, log) = args.put.read()?;
    let against = args.against.as_deref().map(load_set).transpose()?;
    let evaluation = evaluate(&set, &log, against.as_ref(), args.tau)
        .with_context(|| args.put.log.display().to_string())?;
    if args.json {
        print(serde_json::to_string(&evaluation)?)?;
    } else {
        show::show(&evaluation)?;
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
