//! What a fit writes: the files of a set, and the report on it.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use tempco_fit::summary::{LogSummary, is_summary};
use tempco_log::ReadOptions;
use tempco_report::{Report, Subject};
use tempco_set::{CoefficientSet, Judgement, write_set};

use crate::report::{fitted_logs, gather};

/// The report on a set and the logs it was fitted to. Where one of these is there as a summary only,
/// it has no figures of rows.
pub(crate) fn report_on<'a>(
    set: &CoefficientSet,
    judgement: &Judgement,
    logs: impl Iterator<Item = (&'a LogSummary, &'a PathBuf)> + Clone,
    reading: &ReadOptions,
    tau_s: f64,
) -> Result<Report> {
    let has_rows = logs.clone().all(|(_, path)| !is_summary(path));
    let gathered = match has_rows {
        true => Some(gather(set, tau_s, &fitted_logs(set, logs), reading)?),
        false => None,
    };
    let subject = Subject {
        set,
        evaluation: None,
        judgement,
    };
    Ok(Report::new(subject, gathered)?)
}

/// Writes the files of a set, all or none.
pub(crate) fn write(out: &Path, set: &CoefficientSet, report: Option<&Report>) -> Result<()> {
    let report = report.map(|report| &report.html[..]);
    write_set(out, set, report).context("nothing was written")
}
