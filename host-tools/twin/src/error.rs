//! What can be wrong with a name, a file or a simulation.

use std::io;

use thiserror::Error;

use crate::check::Invalid;

/// A name for which there is no unit or no profile.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("unknown {kind} `{name}`, expected one of: {}", known.join(", "))]
pub struct UnknownName {
    /// What was asked for: `unit` or `profile`.
    pub kind: &'static str,
    /// The name as given.
    pub name: String,
    /// Every name that would have been accepted.
    pub known: &'static [&'static str],
}

/// A unit or profile file that cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileError {
    /// It cannot be read.
    #[error("{file}: {error}")]
    Read {
        /// The file.
        file: String,
        /// Why.
        error: io::Error,
    },
    /// It is not TOML, has keys that are not known, lacks some, or has numbers that cannot be.
    #[error("{file}:{line}:{column}: {message}")]
    Content {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// What is wrong and what was expected.
        message: String,
    },
}

/// A simulation that cannot be started.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The sample rate is outside [`RATE_RANGE_HZ`](crate::RATE_RANGE_HZ) or not a number.
    #[error("sample rate {rate_hz} Hz is outside 0.01..10000 Hz")]
    Rate {
        /// The rate as given, Hz.
        rate_hz: f64,
    },
    /// A part of the unit cannot be.
    #[error(transparent)]
    Unit(#[from] Invalid),
}
