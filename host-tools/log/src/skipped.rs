//! Rows that were left out on reading, by reason.

use serde::{Deserialize, Serialize};

/// Why a row is bad by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reason {
    CellCount,
    EmptyCell,
    NotANumber,
    OutOfRange,
}

/// Rows left out because skipping bad rows was asked for, by the first thing wrong with each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SkippedRows {
    /// With more or fewer cells than the header.
    #[serde(skip_serializing_if = "is_zero")]
    pub cell_count: usize,
    /// With an empty cell, or a null.
    #[serde(skip_serializing_if = "is_zero")]
    pub empty_cell: usize,
    /// With a cell that is not a finite number.
    #[serde(skip_serializing_if = "is_zero")]
    pub not_a_number: usize,
    /// With a number outside the range of its column.
    #[serde(skip_serializing_if = "is_zero")]
    pub out_of_range: usize,
    /// With a time that is not after the time of the row before.
    #[serde(skip_serializing_if = "is_zero")]
    pub time_order: usize,
    /// Damaged parts of a binary log; how many rows were in them is not known.
    #[serde(skip_serializing_if = "is_zero")]
    pub damaged: usize,
}

const fn is_zero(rows: &usize) -> bool {
    *rows == 0
}

impl SkippedRows {
    /// All of them.
    pub fn total(&self) -> usize {
        self.by_reason().iter().map(|(_, rows)| rows).sum()
    }

    /// Share of the rows of a log of which `kept` rows were not left out, 0 to 1.
    pub fn share(&self, kept: usize) -> f64 {
        let total = self.total();
        total as f64 / (total + kept).max(1) as f64
    }

    pub(crate) const fn count(&mut self, reason: Reason) {
        let rows = match reason {
            Reason::CellCount => &mut self.cell_count,
            Reason::EmptyCell => &mut self.empty_cell,
            Reason::NotANumber => &mut self.not_a_number,
            Reason::OutOfRange => &mut self.out_of_range,
        };
        *rows += 1;
    }

    pub(crate) const fn add(&mut self, other: Self) {
        self.cell_count += other.cell_count;
        self.empty_cell += other.empty_cell;
        self.not_a_number += other.not_a_number;
        self.out_of_range += other.out_of_range;
        self.time_order += other.time_order;
        self.damaged += other.damaged;
    }

    const fn by_reason(&self) -> [(&'static str, usize); 6] {
        [
            ("wrong number of cells", self.cell_count),
            ("empty cell", self.empty_cell),
            ("not a number", self.not_a_number),
            ("out of range", self.out_of_range),
            ("time does not increase", self.time_order),
            ("damaged part", self.damaged),
        ]
    }
}

/// The reasons with their rows, such as `not a number 3, out of range 1`.
impl std::fmt::Display for SkippedRows {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let found = self.by_reason().into_iter().filter(|(_, rows)| *rows > 0);
        for (number, (reason, rows)) in found.enumerate() {
            let separator = if number == 0 { "" } else { ", " };
            write!(f, "{separator}{reason} {rows}")?;
        }
        Ok(())
    }
}
