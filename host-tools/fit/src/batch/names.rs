//! Serial numbers as names of folders, next to each other and to the summary.

use std::ffi::OsStr;
use std::path::Path;

use thiserror::Error;

use super::UnitLogs;

/// Names of the files of the summary.
pub const SUMMARY_FILES: [&str; 2] = ["summary.csv", "summary.html"];

/// Whether a serial number can be the name of a folder within another.
pub fn is_folder_name(serial: &str) -> bool {
    Path::new(serial).file_name() == Some(OsStr::new(serial))
}

/// Checks that a serial number can be the name of a folder of its own, next to the folders of all `units`.
///
/// # Errors
/// No name of a folder, the name of a file of the summary, or one that differs from another unit's
/// by case only.
pub fn check_serial(serial: &str, units: &[UnitLogs]) -> Result<(), SerialError> {
    let serial_of = || serial.to_owned();
    if !is_folder_name(serial) || (cfg!(windows) && !is_name_on_windows(serial)) {
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

/// Whether Windows takes the name as it is. It cuts dots and spaces off the end, and some names are
/// devices, also with an ending.
fn is_name_on_windows(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default().trim_end();
    let stem = stem.to_ascii_uppercase();
    let port = stem.strip_prefix("COM").or(stem.strip_prefix("LPT"));
    let is_port = port.is_some_and(|port| matches!(port.as_bytes(), [b'0'..=b'9']));
    let is_device = is_port || ["CON", "PRN", "AUX", "NUL"].contains(&stem.as_str());
    !(is_device || name.ends_with(['.', ' ']) || name.contains(['<', '>', ':', '"', '|', '?', '*']))
}

/// A serial number that cannot be the name of a folder of its own.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SerialError {
    /// No folder can have this name.
    #[error("serial number `{0}`: expected a name that a folder can have")]
    NoName(String),
    /// It is the name of a file of the summary.
    #[error("serial number `{0}`: expected another name, since the batch's summary has this one")]
    Summary(String),
    /// Two units whose folders are one where the file system ignores case.
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
            ("summary.csv", "the batch's summary has this one"),
            ("Summary.HTML", "the batch's summary has this one"),
            ("A1", "`A1` and `a1` differ by case only"),
            ("a1", "`a1` and `A1` differ by case only"),
        ] {
            let error = check(bad).unwrap_err();
            assert!(error.contains(expected), "{bad}: {error}");
        }
    }

    #[test]
    fn windows_takes_no_devices_and_no_dots_or_spaces_at_the_end() {
        for good in [
            "B2", "COM", "COM12", "COM!", "CONSOLE", "C-3.1", ".con", "COMB",
        ] {
            assert!(is_name_on_windows(good), "{good}");
        }
        for bad in [
            "con", "NUL.csv", "Com1", "LPT9", "aux .x", "B2.", "B2 ", "B:2", "B?",
        ] {
            assert!(!is_name_on_windows(bad), "{bad}");
        }
    }
}
