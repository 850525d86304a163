//! Serial numbers as names of folders, beside each other and beside the summary.

use std::ffi::OsStr;
use std::path::Path;

use thiserror::Error;

use super::UnitLogs;

/// Names of the files of the summary.
pub const SUMMARY_FILES: [&str; 2] = ["summary.csv", "summary.html"];

/// Checks that a serial number can be the name of a folder of its own, beside those of all `units`.
///
/// # Errors
/// No name of a folder, the name of a file of the summary, or one that differs from that of
/// another unit by case alone.
pub fn check_serial(serial: &str, units: &[UnitLogs]) -> Result<(), SerialError> {
    let serial_of = || serial.to_owned();
    if Path::new(serial).file_name() != Some(OsStr::new(serial)) {
        return Err(SerialError::NoName(serial_of()));
    }
    let lower = serial.to_lowercase();
    if SUMMARY_FILES.contains(&lower.as_str()) {
        return Err(SerialError::Summary(serial_of()));
    }
    let mut others = units.iter().map(|unit| &unit.serial);
    match others.find(|other| *other != serial && other.to_lowercase() == lower) {
        Some(other) => Err(SerialError::Case(serial_of(), other.clone())),
        None => Ok(()),
    }
}

/// A serial number that cannot be the name of a folder of its own.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SerialError {
    /// No folder can have this name.
    #[error("serial number `{0}`: expected a name that a folder can have")]
    NoName(String),
    /// It is the name of a file of the summary.
    #[error("serial number `{0}`: expected another name than that of the batch's summary")]
    Summary(String),
    /// Two units whose folders are one where the file system does not tell case.
    #[error("serial numbers `{0}` and `{1}` differ by case only: expected different ones")]
    Case(String, String),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn serial_numbers_have_folders_of_their_own() {
        let units = ["A1", "a1", "B2", "ß", ""].map(|serial| UnitLogs {
            serial: serial.to_owned(),
            logs: Vec::new(),
        });
        let check = |serial: &str| check_serial(serial, &units).map_err(|error| error.to_string());
        for good in ["B2", "ß", "summary", "summary.csv.old", "C-3.1"] {
            assert_eq!(check(good), Ok(()), "{good}");
        }
        for (bad, expected) in [
            ("", "a folder can have"),
            (".", "a folder can have"),
            ("..", "a folder can have"),
            ("../B2", "a folder can have"),
            ("B2/", "a folder can have"),
            ("/B2", "a folder can have"),
            ("summary.csv", "the batch's summary"),
            ("Summary.HTML", "the batch's summary"),
            ("A1", "`A1` and `a1` differ by case only"),
            ("a1", "`a1` and `A1` differ by case only"),
        ] {
            let error = check(bad).unwrap_err();
            assert!(error.contains(expected), "{bad}: {error}");
        }
    }
}
