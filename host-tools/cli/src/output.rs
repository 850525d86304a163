//! How results are shown and written.

use std::io::{self, Write};
use std::path::Path;

use anyhow::{Context, Result};
use comfy_table::{ContentArrangement, Row, Table, presets};
use serde::Serialize;
pub(crate) use tempco_evaluate::{figure, percent, without_dust};
pub(crate) use tempco_report::table;
use tempco_set::escape;
use tempco_set::files::{Draft, keep_all};

/// Columns that fit on every terminal.
pub(crate) const WIDTH: u16 = 80;

/// A text in lines of at most [`WIDTH`] columns, the second and later ones indented.
pub(crate) fn wrap(text: &str) -> Vec<String> {
    let lines = wrapped(Row::from([escape::line(text)]));
    let indented = lines.into_iter().enumerate();
    indented
        .map(|(number, line)| {
            if number > 0 {
                format!("  {line}")
            } else {
                line
            }
        })
        .collect()
}

/// A text in one line of at most [`WIDTH`] columns, shortened at its end.
pub(crate) fn shorten(text: &str) -> String {
    let mut row = Row::from([escape::line(text)]);
    row.max_height(1);
    wrapped(row).join("")
}

/// The lines of a cell, with room for an indent.
fn wrapped(row: Row) -> Vec<String> {
    let mut cell = Table::new();
    cell.load_style(presets::NOTHING)
        .set_truncation_indicator("...");
    within(&mut cell, WIDTH - 2).add_row(row);
    for column in cell.column_iter_mut() {
        column.set_padding((0, 0));
    }
    cell.lines()
        .map(|line| line.trim_end().to_owned())
        .collect()
}

/// Breaks the cells of a table where it would be wider.
pub(crate) fn within(table: &mut Table, width: u16) -> &mut Table {
    table
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(width)
}

/// Prints a line to standard output, after an empty one if it begins with a line break; a closed
/// pipe is an error that `main` forgives.
///
/// Texts from elsewhere are escaped: it is one line, and nothing in it acts on a terminal.
pub(crate) fn print(line: impl std::fmt::Display) -> Result<()> {
    let line = line.to_string();
    let (before, line) = match line.strip_prefix('\n') {
        Some(line) => ("\n", line),
        None => ("", &line[..]),
    };
    writeln!(io::stdout().lock(), "{before}{}", escape::line(line))?;
    Ok(())
}

/// Prints lines. Texts from elsewhere may stand in cells of a [`table`] only, or in [`wrap`]ped
/// lines: there they are escaped.
pub(crate) fn print_lines(lines: impl std::fmt::Display) -> Result<()> {
    writeln!(io::stdout().lock(), "{}", escape::lines(&lines.to_string()))?;
    Ok(())
}

/// Prints a text in lines of at most [`WIDTH`] columns.
pub(crate) fn print_wrapped(text: &str) -> Result<()> {
    wrap(text).iter().try_for_each(print_lines)
}

/// Prints a value as JSON on one line.
pub(crate) fn print_json(value: &impl Serialize) -> Result<()> {
    let json = serde_json::to_string(value)?;
    writeln!(io::stdout().lock(), "{}", escape::json(&json))?;
    Ok(())
}

/// Prints a line to standard error, escaped as by [`print`].
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_broken_between_words_and_what_is_hidden_is_shown() {
        let long = format!("one\u{1b}two {}", "word ".repeat(30));
        let lines = wrap(&long);
        assert_eq!(lines.len(), 3);
        assert!(lines[0].starts_with("one\\u{1b}two word"), "{lines:?}");
        assert!(lines[1].starts_with("  word"), "{lines:?}");
        assert!(lines.iter().all(|line| line.len() <= 80), "{lines:?}");
        assert_eq!(lines.join(" ").matches("word").count(), 30);
        let short = shorten(&long);
        assert!(short.len() <= 80 && short.ends_with("..."), "{short}");
        assert_eq!(wrap("short"), ["short"]);
        assert_eq!(shorten("short"), "short");
    }
}
