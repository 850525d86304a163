//! What a fit writes: the files of a set, and the report on it.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use tempco_log::ReadOptions;
use tempco_report::{Report, Subject};
use tempco_set::{CoefficientSet, Judgement, write_set};

use crate::report::{fitted_logs, gather};

/// The report on a set and the logs it was fitted to.
pub(crate) fn report_on(
    set: &CoefficientSet,
    judgement: &Judgement,
    logs: &[PathBuf],
    reading: &ReadOptions,
    tau_s: f64,
) -> Result<Report> {
    let gathered = gather(set, tau_s, &fitted_logs(set, logs), reading)?;
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
