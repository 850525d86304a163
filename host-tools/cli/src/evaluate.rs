//! `tempco evaluate`: how much better the compensated log is.

mod show;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tempco_evaluate::{Evaluation, Role, evaluate};
use tempco_report::{Judgement, Report, Subject};
use tempco_set::CoefficientSet;
use tempco_set::run::Reread;

use crate::Verdict;
use crate::image::is_image;
use crate::output::{print_json, say, write_file};
use crate::report::{Found, ensure_rereadable, gather, write_figures};
use crate::shared_args::{SetAndLog, averaging_time, load_set_for};

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
        value_parser = averaging_time,
        allow_negative_numbers = true
    )]
    tau: f64,
    /// Note the verdict in SET (coefficients.json): a set that is no better than none on a
    /// verification log is marked as rejected. Without, SET is not changed
    #[arg(long)]
    sign_off: bool,
    /// Print one JSON object instead of tables
    #[arg(long)]
    json: bool,
    /// Write the report of the verification, for which the log is read once more
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    /// Write the figures of the report into a folder, as SVG files
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    // Last, since what follows would stand under its heading.
    #[command(flatten)]
    put: SetAndLog,
}

pub(crate) fn run(args: &Args) -> Result<Verdict> {
    if args.report.is_some() || args.figures.is_some() {
        ensure!(
            !is_image(&args.put.set),
            "--report: {}: expected coefficients.json; an image has nothing of the fit to report on",
            args.put.set.display()
        );
        ensure_rereadable(std::slice::from_ref(&args.put.log))?;
    }
    let (set, log) = args.put.read()?;
    let against = args.against.as_deref();
    let against = against.map(|set| load_set_for(set, &log)).transpose()?;
    let evaluation = evaluate(&set, &log, against.as_ref(), args.tau)
        .with_context(|| args.put.log.display().to_string())?;
    let found = Found {
        log: Reread {
            path: args.put.log.clone(),
            interval_s: log.interval_s,
            sha256: log.sha256.clone(),
        },
        duration_s: log.time_s[log.rows() - 1] - log.time_s[0],
    };
    drop(log);
    write_report(args, &set, &evaluation, found)?;
    if args.json {
        print_json(&evaluation)?;
    } else {
        show::show(&evaluation)?;
    }
    let worse = evaluation.worse_axes();
    if !worse.is_empty() {
        say!(
            "not acceptable: the compensation is no better than none on {}",
            worse.join(", ")
        );
    }
    if args.sign_off {
        sign_off(&args.put.set, set, &evaluation)?;
    }
    Ok(Verdict::of(worse.is_empty()))
}

/// Writes what was asked for of report and figures.
fn write_report(
    args: &Args,
    set: &CoefficientSet,
    evaluation: &Evaluation,
    found: Found,
) -> Result<()> {
    if args.report.is_none() && args.figures.is_none() {
        return Ok(());
    }
    let reading = args.put.reading.options(set.settings.scale_factor_arcsec);
    let gathered = gather(set, args.tau, &[found], &reading)?;
    let subject = Subject {
        set,
        evaluation: Some(evaluation),
        judgement: &Judgement::new(set, Some(evaluation), &[]),
    };
    let report = Report::new(subject, gathered)?;
    if let Some(folder) = &args.figures {
        write_figures(&report, folder)?;
    }
    if let Some(path) = &args.report {
        write_file(path, report.html.as_bytes())?;
    }
    Ok(())
}

fn sign_off(path: &Path, mut set: CoefficientSet, evaluation: &Evaluation) -> Result<()> {
    let shown = path.display();
    ensure!(
        path.extension()
            .is_some_and(|extension| extension == "json"),
        "--sign-off: {shown}: expected coefficients.json, in which a verdict can be noted"
    );
    ensure!(
        evaluation.log.role == Role::Verification,
        "--sign-off: {shown} was fitted to {}: expected a log it has not seen",
        evaluation.log.file
    );
    set.sign_offs.push(evaluation.sign_off());
    write_file(path, set.to_json().as_bytes()).context("the verdict was not noted")?;
    let verdict = if set.is_rejected() {
        "rejected"
    } else {
        "accepted"
    };
    say!("{shown}: marked as {verdict}");
    Ok(())
}
