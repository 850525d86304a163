//! What a person must judge of how a log was read.

use serde::{Deserialize, Serialize};

/// A kind of doubt.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DoubtKind {
    /// The logger's own correction may be in the values.
    OwnCorrection,
    /// The recorder started again, and nobody knows after how long.
    TimeRestarts,
    /// Rows are stamped in bursts so long that the time of a row is not known well.
    LongBursts,
}

/// A doubt about a log.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Doubt {
    /// What is in doubt.
    pub kind: DoubtKind,
    /// What was found, for a person.
    pub detail: String,
}
