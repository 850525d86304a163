//! `tempco evaluate`: a log before and after compensation.

mod show;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tempco_evaluate::{Evaluation, Role, evaluate, evaluate_file, judge, sign_off};
use tempco_log::Log;
use tempco_report::{Report, Rows, ShownLog, Subject, gather};
use tempco_set::run::is_rereadable;
use tempco_set::{CoefficientSet, Judgement};

use crate::Exit;
use crate::answer::Answer;
use crate::image::is_image;
use crate::output::{say, write_file};
use crate::progress::Progress;
use crate::report::{ensure_rereadable, reading_again, write_figures};
use crate::shared_args::{PrintArgs, SetAndLog, averaging_time, load_set_for};

/// Judge a coefficient set on a log, before and after compensation
///
/// Prints the verdict, the reasons for it, and the bias stability of each axis. With --verbose also
/// residuals, hysteresis, Allan deviation, boundaries and coverage; docs/metrics.md defines them.
///
/// Exit code 1: the set is rejected. This log, the last sign-off, the fitted logs or the segments
/// of the set can be the reason.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco evaluate RLG-7/coefficients.json verification.csv")]
pub(crate) struct Args {
    /// Compare with this set, such as the one in use. Default: the static part of SET
    #[arg(long, value_name = "SET")]
    against: Option<PathBuf>,
    /// Averaging time of the bias stability, in s
    #[arg(
        long,
        value_name = "S",
        default_value_t = 100.0,
        value_parser = averaging_time,
        allow_negative_numbers = true
    )]
    tau: f64,
    /// Keep the verdict of this log in SET (coefficients.json). The log must not be one that SET
    /// was fitted to
    #[arg(long)]
    sign_off: bool,
    /// Write the report of the verification. The log is read a second time for it
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    /// Write the figures of the report into this folder, as SVG files
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    #[command(flatten)]
    print: PrintArgs,
    // Last: later options would stand under its heading.
    #[command(flatten)]
    put: SetAndLog,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    if args.report.is_some() || args.figures.is_some() {
        ensure!(
            !is_image(&args.put.set),
            "--report: {}: expected coefficients.json; an image holds nothing of the fit",
            args.put.set.display()
        );
        ensure_rereadable(std::slice::from_ref(&args.put.log))?;
    }
    let (mut set, evaluation, shown) = evaluated(args)?;
    if args.sign_off {
        ensure_can_sign_off(&args.put.set, &evaluation)?;
        set.sign_offs.push(sign_off(&evaluation));
    }
    let judgement = judge(&set, Some(&evaluation));
    write_report(args, &set, &evaluation, &judgement, shown)?;
    let answer = Answer {
        set: &set,
        judgement: &judgement,
        evaluation: Some(&evaluation),
        is_against: args.against.is_some(),
        notes: Vec::new(),
        written: written(args),
    };
    let tables = || show::show(&set, &evaluation);
    answer.print(&args.print, &args.put.set, || &evaluation, tables)?;
    if args.sign_off {
        let written = write_file(&args.put.set, set.to_json().as_bytes());
        written.context("the verdict was not kept")?;
        let last = set.sign_offs.last();
        let rejects = last.is_some_and(|last| !last.accepted);
        let verdict = if rejects { "rejected" } else { "accepted" };
        say!("{}: marked as {verdict}", args.put.set.display());
    }
    Ok(Exit::of(judgement.is_accepted()))
}

/// The set, how it does on the log, and what is known of that.
fn evaluated(args: &Args) -> Result<(CoefficientSet, Evaluation, ShownLog<'_>)> {
    let path = &args.put.log;
    let at_log = || path.display().to_string();
    let against = |log: &Log| {
        let path = args.against.as_deref();
        path.map(|path| load_set_for(path, log)).transpose()
    };
    let shown = |log: &Log, duration_s| ShownLog {
        rows: Rows::File(path),
        interval_s: log.interval_s,
        duration_s,
        sha256: log.sha256.clone(),
    };
    if is_rereadable(path) {
        // The interval must be known first, so the log is read twice: no row is kept in memory.
        let (set, (survey, options)) = args.put.survey()?;
        let against = against(&survey.head)?;
        let progress = Progress::over([path]);
        let observer = |bytes| progress.add(bytes);
        let log = (path.as_path(), &survey);
        let evaluation = evaluate_file(&set, log, &options, against.as_ref(), args.tau, observer);
        let evaluation = evaluation.with_context(at_log)?;
        return Ok((set, evaluation, shown(&survey.head, survey.duration_s)));
    }
    let (set, log) = args.put.read()?;
    let against = against(&log)?;
    let evaluation = evaluate(&set, &log, against.as_ref(), args.tau).with_context(at_log)?;
    let duration_s = log.time_s[log.rows() - 1] - log.time_s[0];
    Ok((set, evaluation, shown(&log, duration_s)))
}

/// Names the files that were written.
fn written(args: &Args) -> Vec<String> {
    let paths = args.report.iter().chain(&args.figures);
    paths
        .map(|path| format!("wrote {}", path.display()))
        .collect()
}

/// Writes the report and the figures, if they were asked for.
fn write_report(
    args: &Args,
    set: &CoefficientSet,
    evaluation: &Evaluation,
    judgement: &Judgement,
    shown: ShownLog,
) -> Result<()> {
    if args.report.is_none() && args.figures.is_none() {
        return Ok(());
    }
    let reading = args.put.reading.options(Some(set))?;
    let observer = reading_again(std::slice::from_ref(&args.put.log));
    let gathered = gather(set, args.tau, &[shown], &reading, observer)?;
    let subject = Subject {
        set,
        evaluation: Some(evaluation),
        judgement,
    };
    let report = Report::new(subject, Some(gathered))?;
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
        "--sign-off: {shown}: expected coefficients.json, which can keep a verdict"
    );
    ensure!(
        evaluation.log.role == Role::Verification,
        "--sign-off: {shown} was fitted to {}: expected a log that it was not fitted to",
        evaluation.log.file
    );
    Ok(())
}
