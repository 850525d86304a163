//! Errors of logs: where, what was found, what was expected.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// A log was refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LogError {
    /// The file cannot be read.
    #[error("{}: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: std::io::Error,
    },
    /// The file as a whole is unusable.
    #[error("{}: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What was found and what was expected.
        message: String,
    },
    /// The rows of several sources are in the log, and none of them was chosen.
    #[error("{}{}: {message}", path.display(), line.map(|line| format!(":{line}")).unwrap_or_default())]
    Sources {
        /// The file.
        path: PathBuf,
        /// Line number in a text.
        line: Option<u64>,
        /// Their numbers.
        instances: Vec<u32>,
        /// What was found and what was expected.
        message: String,
    },
    /// A line is unusable.
    #[error("{}:{line}: {message}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Line number, the header being 1.
        line: u64,
        /// What was found and what was expected.
        message: String,
    },
    /// A cell is unusable.
    #[error("{}:{line}:{column}: column `{name}`: {message}", path.display())]
    Cell {
        /// The file.
        path: PathBuf,
        /// Line number, the header being 1.
        line: u64,
        /// Column number, the first being 1.
        column: usize,
        /// Name of the column.
        name: String,
        /// What was found and what was expected.
        message: String,
    },
    /// A value of a table without lines (Parquet) is unusable.
    #[error("{}: row {row}, column {column} `{name}`: {message}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// Row number, the first being 1.
        row: u64,
        /// Column number, the first being 1.
        column: usize,
        /// Name of the column.
        name: String,
        /// What was found and what was expected.
        message: String,
    },
}

impl LogError {
    pub(crate) fn file(path: &Path, message: impl Into<String>) -> Self {
        Self::File {
            path: path.to_owned(),
            message: message.into(),
        }
    }

    /// The log has too few rows.
    pub fn too_few_rows(path: &Path, found: usize) -> Self {
        Self::file(
            path,
            format!("{found} usable rows after the header: expected at least 2"),
        )
    }

    pub(crate) fn sources(
        path: &Path,
        line: Option<u64>,
        instances: Vec<u32>,
        message: String,
    ) -> Self {
        Self::Sources {
            path: path.to_owned(),
            line,
            instances,
            message,
        }
    }

    pub(crate) fn line(path: &Path, line: u64, message: impl Into<String>) -> Self {
        Self::Line {
            path: path.to_owned(),
            line,
            message: message.into(),
        }
    }

    pub(crate) fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |cause| Self::Io {
            path: path.to_owned(),
            cause,
        }
    }
}
