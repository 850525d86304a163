//! The report of a fit or of an evaluation. The logs are read a second time for it.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tempco_fit::summary::LogSummary;
use tempco_log::ReadOptions;
use tempco_report::{Gatherer, LogTimes, Report};
use tempco_set::CoefficientSet;
use tempco_set::files::write_files;
use tempco_set::run::{KnownLog, apply_to_file, is_rereadable};

use crate::progress::Progress;

/// Refuses logs that cannot be read twice, before the work begins.
pub(crate) fn ensure_rereadable(paths: &[PathBuf]) -> Result<()> {
    let pipe = paths
        .iter()
        .find(|path| path.exists() && !is_rereadable(path));
    ensure!(
        pipe.is_none(),
        "{}: the report reads a log twice: expected a regular file (`fit --no-report` reads it once)",
        pipe.map(|path| path.display().to_string())
            .unwrap_or_default()
    );
    Ok(())
}

/// A log, as it was when it was first read.
pub(crate) struct Found {
    pub(crate) log: KnownLog,
    pub(crate) duration_s: f64,
}

/// The logs that a set was fitted to, in its order.
pub(crate) fn fitted_logs<'a>(
    set: &CoefficientSet,
    logs: impl Iterator<Item = (&'a LogSummary, &'a PathBuf)> + Clone,
) -> Vec<Found> {
    let inputs = set.provenance.inputs.iter().filter_map(|input| {
        let of_input = |(log, _): &(&LogSummary, &PathBuf)| log.sha256() == input.sha256;
        let (_, path) = logs.clone().find(of_input)?;
        Some(Found {
            log: KnownLog {
                path: path.clone(),
                interval_s: input.interval_s,
                sha256: input.sha256.clone(),
            },
            duration_s: input.duration_s,
        })
    });
    inputs.collect()
}

/// Runs the logs through the core again, and gathers the data of the figures.
pub(crate) fn gather(
    set: &CoefficientSet,
    tau_s: f64,
    logs: &[Found],
    options: &ReadOptions,
) -> Result<Gatherer> {
    let times: Vec<LogTimes> = logs
        .iter()
        .map(|found| LogTimes {
            interval_s: found.log.interval_s,
            duration_s: found.duration_s,
        })
        .collect();
    let mut gatherer = Gatherer::new(set, tau_s, &times);
    let progress = Progress::over(logs.iter().map(|found| &found.log.path));
    for found in logs {
        gatherer.begin_log();
        let observer = |bytes| progress.add(bytes);
        apply_to_file(set, None, &found.log, options, observer, |part| {
            gatherer.push(part.time_s, &part.applied);
        })?;
    }
    Ok(gatherer)
}

/// Writes the figures of a report into a folder, all or none.
pub(crate) fn write_figures(report: &Report, folder: &Path) -> Result<()> {
    let files: Vec<(&str, &[u8])> = report
        .figures
        .iter()
        .map(|(name, svg)| (name.as_str(), svg.as_bytes()))
        .collect();
    write_files(folder, &files).context("the figures were not written")
}
