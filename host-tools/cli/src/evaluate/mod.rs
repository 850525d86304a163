//! `tempco evaluate`: how much better the compensated log is.

mod show;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tempco_evaluate::{Evaluation, Role, evaluate, judge, sign_off};
use tempco_report::{Report, Subject};
use tempco_set::run::KnownLog;
use tempco_set::{CoefficientSet, Judgement};

use crate::Exit;
use crate::image::is_image;
use crate::judgement::{self, say_rejections};
use crate::output::{say, write_file};
use crate::report::{Found, ensure_rereadable, gather, write_figures};
use crate::shared_args::{SetAndLog, averaging_time, load_set_for};

/// Judge a coefficient set on a log
///
/// Bias stability, residuals, hysteresis, Allan deviation, boundaries and coverage; docs/metrics.md
/// says what each figure means. Exits with 1 where the set is rejected: by this log, by its last
/// sign-off, by the logs it was fitted to, or by its own segments.
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

pub(crate) fn run(args: &Args) -> Result<Exit> {
    if args.report.is_some() || args.figures.is_some() {
        ensure!(
            !is_image(&args.put.set),
            "--report: {}: expected coefficients.json; an image has nothing of the fit to report on",
            args.put.set.display()
        );
        ensure_rereadable(std::slice::from_ref(&args.put.log))?;
    }
    let (mut set, log) = args.put.read()?;
    let against = args.against.as_deref();
    let against = against.map(|set| load_set_for(set, &log)).transpose()?;
    let evaluation = evaluate(&set, &log, against.as_ref(), args.tau)
        .with_context(|| args.put.log.display().to_string())?;
    let found = Found {
        log: KnownLog {
            path: args.put.log.clone(),
            interval_s: log.interval_s,
            sha256: log.sha256.clone(),
        },
        duration_s: log.time_s[log.rows() - 1] - log.time_s[0],
    };
    drop(log);
    if args.sign_off {
        ensure_can_sign_off(&args.put.set, &evaluation)?;
        set.sign_offs.push(sign_off(&evaluation));
    }
    let judgement = judge(&set, Some(&evaluation));
    write_report(args, &set, &evaluation, &judgement, found)?;
    if args.json {
        judgement::print_as_json(&evaluation, &judgement)?;
    } else {
        show::show(&evaluation)?;
        judgement::show(&judgement)?;
    }
    let shown = args.put.set.display();
    say_rejections(&shown, &judgement);
    if args.sign_off {
        let written = write_file(&args.put.set, set.to_json().as_bytes());
        written.context("the verdict was not noted")?;
        let last = set.sign_offs.last();
        let rejects = last.is_some_and(|last| !last.accepted);
        let verdict = if rejects { "rejected" } else { "accepted" };
        say!("{shown}: marked as {verdict}");
    }
    Ok(Exit::of(judgement.is_accepted()))
}

/// Writes what was asked for of report and figures.
fn write_report(
    args: &Args,
    set: &CoefficientSet,
    evaluation: &Evaluation,
    judgement: &Judgement,
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
        judgement,
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

fn ensure_can_sign_off(path: &Path, evaluation: &Evaluation) -> Result<()> {
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
    Ok(())
}
