//! How a log was read.

use std::fmt;

/// What was found in a log that a plain log does not have, and how it was read therefore.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// What was found, each in some words.
    pub notes: Vec<String>,
}

impl Reading {
    /// Whether the log is a plain one.
    pub fn is_plain(&self) -> bool {
        self.notes.is_empty()
    }
}

/// In one line.
impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.notes.join("; "))
    }
}
