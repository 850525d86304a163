//! Reads a set from a file: one that was fitted, or coefficients that were printed.

use std::fs;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::import::static_coefficients;
use crate::set::CoefficientSet;

/// Reads a set from `coefficients.json`, or from a CSV file of static coefficients.
///
/// # Errors
/// An unreadable file, or one whose contents are no set; see [`CoefficientSet::from_json`].
pub fn load_set(path: &Path) -> Result<CoefficientSet, SetError> {
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
        message,
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
}
