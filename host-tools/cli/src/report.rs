//! The report of a fit or of an evaluation. The logs are read a second time for it.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tempco_fit::summary::is_summary;
use tempco_report::{Report, Rows};
use tempco_set::files::write_files;
use tempco_set::run::is_rereadable;

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

/// Where the rows of the logs of a fit are. Of a summary they are nowhere.
pub(crate) fn rows_of(paths: &[PathBuf]) -> Vec<Rows<'_>> {
    let rows = |path| match is_summary(path) {
        true => Rows::None,
        false => Rows::File(path),
    };
    paths.iter().map(|path| rows(path)).collect()
}

/// Shows the progress of reading for a report, from the first bytes on.
pub(crate) fn reading_again(paths: &[PathBuf]) -> impl FnMut(u64) {
    let mut progress = None;
    move |bytes| {
        let progress = progress.get_or_insert_with(|| Progress::over(paths));
        progress.add(bytes);
    }
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
