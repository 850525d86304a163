//! What is wrong with a signal, and where.

use serde::{Deserialize, Serialize};

/// A kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// An axis is at its own largest or smallest value again and again.
    FullScale,
    /// An axis repeats a value, bit by bit, for much longer than it usually does.
    IdenticalValues,
    /// The temperature does not change although the unit's temperature does.
    FrozenTemperature,
    /// The temperature does not change for longer than its noise lets it; the rest of the log does
    /// not say whether the unit's temperature does.
    StandingTemperature,
    /// An axis is a running total, not a rate.
    RunningTotal,
    /// The temperature changes faster than a unit can.
    TemperatureJump,
    /// Rows of several sources take turns.
    AlternatingSources,
    /// The temperature looks like degrees Fahrenheit.
    Fahrenheit,
}

/// A fault of a column, with its place in the log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Finding {
    /// What is wrong.
    pub fault: Fault,
    /// Name of the axis, or of the temperature column.
    pub column: String,
    /// Rows that show it.
    pub rows: usize,
    /// Their share of the rows that were looked at, 0 to 1.
    pub share: f64,
    /// Time of the first of them \[s\].
    pub from_s: f64,
    /// Time of the last of them \[s\].
    pub to_s: f64,
    /// What stands there, for a person.
    pub detail: String,
}
