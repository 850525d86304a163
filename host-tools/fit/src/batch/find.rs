//! Finds the units of a folder and their logs.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::SUMMARY_FILES;

/// Endings of files that are taken for logs, in lower case.
const LOG_ENDINGS: [&str; 7] = [
    ".csv", ".csv.gz", ".csv.zst", ".parquet", ".ulg", ".bin", ".summary",
];

/// A unit and its logs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitLogs {
    /// Serial number of the unit.
    pub serial: String,
    /// Its logs, by name; none if its folder holds none.
    pub logs: Vec<PathBuf>,
}

/// Finds the units whose logs are in `folder`, by serial number.
///
/// A sub-folder is a unit: its name is the serial number, the logs are the files directly in it. A
/// log directly in `folder` belongs to the unit that its name starts with, up to the first `_` or
/// `.`: `SN7.csv` and `SN7_run2.csv.gz` are logs of `SN7`. Logs end in `.csv`, `.csv.gz`,
/// `.csv.zst`, `.parquet`, `.ulg`, `.bin` or `.summary`. Names that start with a dot are passed over, and so are the folder
/// `out`, to which sets are written, and the summary in it.
///
/// # Errors
/// A folder that cannot be read, or that holds no unit; names that are not UTF-8.
pub fn find_units(folder: &Path, out: &Path) -> Result<Vec<UnitLogs>, FindError> {
    let out = out.canonicalize().ok();
    let holds_summary = out.is_some() && folder.canonicalize().ok() == out;
    let mut units: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for (path, name) in entries(folder)? {
        if path.is_dir() {
            if path.canonicalize().ok() == out {
                continue;
            }
            let logs = entries(&path)?.into_iter();
            let logs = logs.filter(|(path, name)| is_log(name) && !path.is_dir());
            let unit = units.entry(name).or_default();
            unit.extend(logs.map(|(path, _)| path));
        } else if is_log(&name) && !(holds_summary && SUMMARY_FILES.contains(&name.as_str())) {
            let serial = name.split(['_', '.']).next().unwrap_or_default();
            units.entry(serial.to_owned()).or_default().push(path);
        }
    }
    if units.is_empty() {
        return Err(FindError::NoUnits {
            folder: folder.to_owned(),
        });
    }
    let units = units.into_iter();
    Ok(units
        .map(|(serial, logs)| UnitLogs { serial, logs })
        .collect())
}

/// Paths and names in a folder, by name.
fn entries(folder: &Path) -> Result<Vec<(PathBuf, String)>, FindError> {
    let failed = |cause| FindError::Io {
        folder: folder.to_owned(),
        cause,
    };
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name().into_string().map_err(|name| {
            let message = format!("the name {name:?} is not UTF-8");
            failed(io::Error::new(io::ErrorKind::InvalidData, message))
        })?;
        if !name.starts_with('.') {
            entries.push((entry.path(), name));
        }
    }
    entries.sort();
    Ok(entries)
}

fn is_log(name: &str) -> bool {
    let name = name.to_lowercase();
    LOG_ENDINGS.iter().any(|ending| name.ends_with(ending))
}

/// No units could be found.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FindError {
    /// The folder cannot be read.
    #[error("{}: {cause}", folder.display())]
    Io {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
    /// There is nothing that could be a unit.
    #[error(
        "{}: no units: expected a sub-folder per serial number, or logs named SERIAL.csv or \
         SERIAL_*.csv (also .csv.gz, .csv.zst, .parquet, \
         .ulg, .bin, .summary)",
        folder.display()
    )]
    NoUnits {
        /// The folder.
        folder: PathBuf,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_folders_and_names_of_files() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        for name in ["A1", "B_2", "empty", "out", ".git"] {
            fs::create_dir(root.join(name)).unwrap();
        }
        for name in [
            "A1/run.csv",
            "A1/second.PARQUET",
            "A1/notes.txt",
            "B_2/x.csv.zst",
            "out/summary.csv",
            "C3.csv",
            "C3_b.csv.gz",
            "D-4_1.csv",
            "readme.md",
            ".hidden.csv",
        ] {
            fs::write(root.join(name), "").unwrap();
        }
        let units = find_units(root, &root.join("out")).unwrap();
        let found: Vec<(&str, Vec<&str>)> = units
            .iter()
            .map(|unit| {
                let names = unit
                    .logs
                    .iter()
                    .map(|log| log.file_name().unwrap().to_str().unwrap());
                (unit.serial.as_str(), names.collect())
            })
            .collect();
        assert_eq!(
            found,
            [
                ("A1", vec!["run.csv", "second.PARQUET"]),
                ("B_2", vec!["x.csv.zst"]),
                ("C3", vec!["C3.csv", "C3_b.csv.gz"]),
                ("D-4", vec!["D-4_1.csv"]),
                ("empty", vec![]),
            ]
        );
        let error = find_units(&root.join("empty"), root).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("no units: expected a sub-folder")
        );
        assert!(find_units(&root.join("none"), root).is_err());
    }

    #[test]
    fn the_summary_among_the_logs_is_no_log() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        for name in ["A1.csv", "summary.csv"] {
            fs::write(root.join(name), "").unwrap();
        }
        let serials = |out: &Path| -> Vec<String> {
            let units = find_units(root, out).unwrap();
            units.into_iter().map(|unit| unit.serial).collect()
        };
        assert_eq!(serials(root), ["A1"]);
        assert_eq!(serials(&root.join("out")), ["A1", "summary"]);
    }
}
