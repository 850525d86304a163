//! From summaries of logs to all that is written of a unit: fit, judge, report, files.

use std::path::Path;

use tempco_fit::summary::LogSummary;
use tempco_fit::{Fit, FitError, FitOptions, fit_summaries};
use tempco_log::{Log, ReadOptions};
use tempco_set::run::{KnownLog, Part, RunError, apply_to_file, apply_to_log};
use tempco_set::{CoefficientSet, Judgement, WriteError, write_set};
use thiserror::Error;

use crate::{Gatherer, LogTimes, Report, ReportError, Subject};

/// Where the rows of a log are that a report shows.
#[derive(Clone, Copy, Debug)]
pub enum Rows<'a> {
    /// In a file, which is read once more.
    File(&'a Path),
    /// In memory.
    Log(&'a Log),
    /// Nowhere: the log is there as a summary only.
    None,
}

/// A fitted unit.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The set, and what it does not hold of its fit.
    pub fit: Fit,
    /// The verdict on it.
    pub judgement: Judgement,
    /// The report, if it was wanted.
    pub report: Option<Report>,
}

impl Calibration {
    /// Fits a set to logs and judges it. Its report is made if `rows` are given, one for each log; where
    /// those of a log are nowhere, it has no figures of rows. `observer` gets how many more bytes of
    /// files were read for it.
    ///
    /// # Errors
    /// Those of [`fit_summaries`]; files that cannot be read once more, or have changed.
    pub fn new(
        logs: &[LogSummary],
        options: &FitOptions,
        rows: Option<&[Rows]>,
        reading: &ReadOptions,
        observer: impl FnMut(u64),
    ) -> Result<Self, CalibrationError> {
        let fit = fit_summaries(logs, options)?;
        let judgement = fit.judge();
        let report = rows.map(|rows| -> Result<Report, CalibrationError> {
            let shown = shown(&fit.set, logs, rows);
            let gathered =
                shown.map(|logs| gather(&fit.set, options.plan.tau_s, &logs, reading, observer));
            let subject = Subject {
                set: &fit.set,
                evaluation: None,
                judgement: &judgement,
            };
            Ok(Report::new(subject, gathered.transpose()?)?)
        });
        let report = report.transpose()?;
        Ok(Self {
            fit,
            judgement,
            report,
        })
    }

    /// Writes the files of the set into a folder, all or none.
    ///
    /// # Errors
    /// A set that cannot be emitted; what the system says.
    pub fn write(&self, folder: &Path) -> Result<(), WriteError> {
        let report = self.report.as_ref().map(|report| &report.html[..]);
        write_set(folder, &self.fit.set, report)
    }
}

/// The logs that a set was fitted to, in its order; none if the rows of one are nowhere.
fn shown<'a>(
    set: &CoefficientSet,
    logs: &[LogSummary],
    rows: &[Rows<'a>],
) -> Option<Vec<ShownLog<'a>>> {
    let inputs = set.provenance.inputs.iter();
    inputs
        .map(|input| {
            let place = logs.iter().position(|log| log.sha256() == input.sha256)?;
            Some(ShownLog {
                rows: match rows[place] {
                    Rows::None => return None,
                    rows => rows,
                },
                interval_s: input.interval_s,
                duration_s: input.duration_s,
                sha256: input.sha256.clone(),
            })
        })
        .collect()
}

/// A log that a report shows, as it was when it was first read.
#[derive(Clone, Debug)]
pub struct ShownLog<'a> {
    /// Where its rows are.
    pub rows: Rows<'a>,
    /// Median time between rows \[s\].
    pub interval_s: f64,
    /// Time from the first row to the last \[s\].
    pub duration_s: f64,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

/// Runs logs through the core again, and gathers the data of the figures. `observer` gets how many more
/// bytes of files were read.
///
/// # Errors
/// A file that cannot be read, or has changed; a log without an axis of the set.
pub fn gather(
    set: &CoefficientSet,
    tau_s: f64,
    logs: &[ShownLog],
    reading: &ReadOptions,
    mut observer: impl FnMut(u64),
) -> Result<Gatherer, RunError> {
    let times: Vec<LogTimes> = logs
        .iter()
        .map(|log| LogTimes {
            interval_s: log.interval_s,
            duration_s: log.duration_s,
        })
        .collect();
    let mut gatherer = Gatherer::new(set, tau_s, &times);
    for log in logs {
        gatherer.begin_log();
        let sink = |part: Part| gatherer.push(part.time_s, &part.applied);
        match log.rows {
            Rows::File(path) => {
                let known = KnownLog {
                    path: path.to_owned(),
                    interval_s: log.interval_s,
                    sha256: log.sha256.clone(),
                };
                apply_to_file(set, None, &known, reading, &mut observer, sink)?;
            }
            Rows::Log(log) => apply_to_log(set, None, log, sink)?,
            Rows::None => {}
        }
    }
    Ok(gatherer)
}

/// A unit cannot be calibrated.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// The logs cannot be fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// A log cannot be read for the report.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The report could not be made.
    #[error(transparent)]
    Report(#[from] ReportError),
}
