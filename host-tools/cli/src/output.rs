//! How results are shown and written.

use std::io::{self, Write};
use std::path::Path;

use anyhow::{Context, Result};
use serde::Serialize;
pub(crate) use tempco_evaluate::{figure, percent};
pub(crate) use tempco_report::{states, table};
use tempco_set::escape;
use tempco_set::files::{Draft, keep_all};

/// Prints a line to standard output, after an empty one if it begins with a line break; a closed
/// pipe is an error that `main` forgives.
///
/// Whatever texts from elsewhere are in it, it is one line, and nothing in it acts on a terminal.
pub(crate) fn print(line: impl std::fmt::Display) -> Result<()> {
    let line = line.to_string();
    let (before, line) = match line.strip_prefix('\n') {
        Some(line) => ("\n", line),
        None => ("", &line[..]),
    };
    writeln!(io::stdout().lock(), "{before}{}", escape::line(line))?;
    Ok(())
}

/// Prints lines that hold no text from elsewhere but in cells of a [`table`].
pub(crate) fn print_lines(lines: impl std::fmt::Display) -> Result<()> {
    writeln!(io::stdout().lock(), "{}", escape::lines(&lines.to_string()))?;
    Ok(())
}

/// Prints a value as JSON on one line.
pub(crate) fn print_json(value: &impl Serialize) -> Result<()> {
    let json = serde_json::to_string(value)?;
    writeln!(io::stdout().lock(), "{}", escape::json(&json))?;
    Ok(())
}

/// Says a line on standard error, with the same care as [`print`].
macro_rules! say {
    ($($text:tt)*) => {
        eprintln!("{}", tempco_set::escape::line(&format!($($text)*)))
    };
}
pub(crate) use say;

/// Writes a file in one move, so that no half-written one is ever seen.
pub(crate) fn write_file(path: &Path, contents: &[u8]) -> Result<()> {
    let mut draft = Draft::create(path)?;
    let written = draft.file().write_all(contents);
    written.with_context(|| path.display().to_string())?;
    Ok(keep_all(vec![draft])?)
}

pub(crate) fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error
        .downcast_ref::<io::Error>()
        .is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}
