//! Reads a set from a file: one that was fitted, or coefficients that were printed.

use std::fs;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::escape;
use crate::import::static_coefficients;
use crate::{CoefficientSet, MARK, TABLE_BIN, strangers};

/// Reads a set from `coefficients.json`, or from a CSV file of static coefficients.
///
/// # Errors
/// An unreadable file, or one whose contents are no set, see [`CoefficientSet::from_json`]; a
/// folder in which other files are of another set, see [`strangers`].
pub fn load_set(path: &Path) -> Result<CoefficientSet, SetError> {
    let set = read_set(path)?;
    if path.file_name().is_some_and(|name| name == MARK) {
        check_others(path, &set)?;
    }
    Ok(set)
}

/// Checks that the files in the folder of a set are of one set, if `path` is its
/// `coefficients.json` or the `table.bin` beside it.
///
/// # Errors
/// Those of [`load_set`].
pub fn check_folder(path: &Path) -> Result<(), SetError> {
    let mark = path.with_file_name(MARK);
    let is_in_folder = path
        .file_name()
        .is_some_and(|name| name == MARK || name == TABLE_BIN);
    if is_in_folder && mark.exists() {
        load_set(&mark)?;
    }
    Ok(())
}

fn check_others(mark: &Path, set: &CoefficientSet) -> Result<(), SetError> {
    let folder = mark.parent().unwrap_or(Path::new(""));
    let strangers = strangers(folder, set).map_err(|cause| SetError::Io {
        path: folder.to_owned(),
        cause,
    })?;
    if strangers.is_empty() {
        Ok(())
    } else {
        Err(SetError::Mixed {
            path: mark.to_owned(),
            strangers,
        })
    }
}

/// Reads a set whatever is beside its file.
///
/// # Errors
/// Those of [`load_set`], but for the folder.
pub fn read_set(path: &Path) -> Result<CoefficientSet, SetError> {
    let text = fs::read_to_string(path).map_err(|cause| SetError::Io {
        path: path.to_owned(),
        cause,
    })?;
    let is_csv = path.extension().is_some_and(|extension| extension == "csv");
    let set = if is_csv {
        static_coefficients(path, &text)
    } else {
        CoefficientSet::from_json(&text)
    };
    set.map_err(|message| SetError::Refused {
        path: path.to_owned(),
        message: escape::line(&message),
    })
}

/// A coefficient set was refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SetError {
    /// The file cannot be read.
    #[error("{}: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: std::io::Error,
    },
    /// The contents are unusable.
    #[error("{}: {message}", path.display())]
    Refused {
        /// The file.
        path: PathBuf,
        /// What was found and what was expected.
        message: String,
    },
    /// Files of several sets are in one folder.
    #[error(
        "{}: files of several sets are in its folder: {} not of this set: expected the files of one \
         `tempco fit` (its writing was cut short, or files were exchanged: fit again)",
        path.display(),
        names(strangers)
    )]
    Mixed {
        /// The set.
        path: PathBuf,
        /// The files of another set.
        strangers: Vec<&'static str>,
    },
}

fn names(strangers: &[&str]) -> String {
    let verb = if strangers.len() == 1 { "is" } else { "are" };
    format!("{} {verb}", strangers.join(", "))
}
