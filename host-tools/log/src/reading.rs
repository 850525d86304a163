//! How a log was read.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::doubt::Doubt;
use super::mapping::Mapping;

/// What was found in a log that a plain log does not have, and how it was read therefore.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reading {
    /// The logger that writes such a log.
    pub layout: Option<String>,
    /// What was found in its text, each in some words.
    pub notes: Vec<String>,
    /// What a person must judge of it.
    pub doubts: Vec<Doubt>,
    /// The columns, where they do not all have plain names.
    pub mapping: Option<Mapping>,
}

impl Reading {
    /// Whether the log is a plain one.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }
}

/// In one line.
impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = self.layout.iter().chain(&self.notes).cloned();
        let options = self.mapping.as_ref().map(Mapping::options);
        let parts: Vec<String> = parts.chain(options).collect();
        f.write_str(&parts.join("; "))?;
        let mut doubts = self.doubts.iter();
        doubts.try_for_each(|doubt| write!(f, "; warning: {}", doubt.detail))
    }
}
