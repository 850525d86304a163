//! Units and profiles as TOML files.

use std::fs;
use std::path::Path;

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use crate::chamber::{Profile, ProfileParts};
use crate::check::Invalid;
use crate::error::FileError;
use crate::unit::Unit;

impl Unit {
    /// Reads a unit file; the unit has the file's name without ending.
    ///
    /// # Errors
    ///
    /// [`FileError`] with file, line, column and what was expected.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let text = text(path)?;
        unit(&stem(path), &text).map_err(|error| error.in_file(path, &text))
    }
}

impl Profile {
    /// Reads a profile file; the profile has the file's name without ending.
    ///
    /// # Errors
    ///
    /// [`FileError`] with file, line, column and what was expected.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let text = text(path)?;
        profile(&stem(path), &text).map_err(|error| error.in_file(path, &text))
    }
}

fn text(path: &Path) -> Result<String, FileError> {
    fs::read_to_string(path).map_err(|error| FileError::Read {
        file: path.display().to_string(),
        error,
    })
}

fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// The unit that a TOML text describes.
pub(crate) fn unit(name: &str, text: &str) -> Result<Unit, Problem> {
    let mut unit: Unit = parse(text)?;
    name.clone_into(&mut unit.name);
    unit.check()
        .map_err(|error| Problem::located(text, error))?;
    Ok(unit)
}

/// The profile that a TOML text describes.
pub(crate) fn profile(name: &str, text: &str) -> Result<Profile, Problem> {
    let parts: ProfileParts = parse(text)?;
    Profile::from_parts(name, parts).map_err(|error| Problem::located(text, error))
}

/// What is wrong with a text, and where.
#[derive(Debug)]
pub(crate) struct Problem {
    byte: usize,
    message: String,
}

fn parse<T: DeserializeOwned>(text: &str) -> Result<T, Problem> {
    toml::from_str(text).map_err(|error| Problem {
        byte: error.span().map_or(0, |span| span.start),
        message: error.message().replace('\n', "; "),
    })
}

impl Problem {
    fn located(text: &str, error: Invalid) -> Self {
        Self {
            byte: place(text, &error.path),
            message: error.to_string(),
        }
    }

    fn in_file(self, path: &Path, text: &str) -> FileError {
        let before = &text[..self.byte.min(text.len())];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        FileError::Content {
            file: path.display().to_string(),
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            message: self.message,
        }
    }
}

/// Where the value at a path begins, or the innermost table or list that is there.
fn place(text: &str, path: &str) -> usize {
    let Ok(table) = DeTable::parse(text) else {
        return 0;
    };
    let mut byte = 0;
    let table = DeValue::Table(table.into_inner());
    let mut value = &table;
    for step in path.split(['.', '[']) {
        let found = match step.strip_suffix(']') {
            Some(number) => number
                .parse::<usize>()
                .ok()
                .and_then(|number| value.get(number - 1)),
            None => value.get(step),
        };
        let Some(found) = found else { break };
        byte = found.span().start;
        value = found.get_ref();
    }
    byte
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "a = 1\n[b]\nc = [1, 2]\n[[d]]\ne = 5\n[[d]]\ne = { f = 6 }\n";

    #[test]
    fn a_path_leads_to_its_value() {
        for (path, found) in [
            ("a", "1\n[b]"),
            ("b.c", "[1, 2]"),
            ("b.c[2]", "2]"),
            ("d[1].e", "5"),
            ("d[2].e.f", "6 }"),
            ("b.c[9]", "[1, 2]"),
        ] {
            let byte = place(TEXT, path);
            assert!(TEXT[byte..].starts_with(found), "{path}: {byte}");
        }
    }
}
