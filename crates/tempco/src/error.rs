//! Why a table is refused, and the bounds that its numbers are checked against.

use core::fmt;

/// Largest magnitude of a coefficient \[unit of the axis\]. With the bounds on rates it keeps
/// every intermediate result finite in f32.
pub(crate) const MAX_COEFFICIENT: f32 = 1e20;

/// Why a table or its settings were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum TableError {
    /// The named setting is not finite or outside its range.
    Setting(&'static str),
    /// There is no cell, or more than [`MAX_CELLS`](crate::MAX_CELLS).
    CellCount,
    /// A coefficient is not finite or its magnitude exceeds 1e20.
    Coefficient {
        /// Number of the cell, 0 for the coldest.
        cell: usize,
        /// Number of the axis.
        axis: usize,
    },
}

impl TableError {
    /// The reason in words, also where nothing can be formatted (a const panic).
    pub const fn message(self) -> &'static str {
        match self {
            Self::Setting(name) => name,
            Self::CellCount => "a table needs 1 to 1024 cells",
            Self::Coefficient { .. } => "a coefficient is not finite or beyond 1e20",
        }
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Setting(name) => write!(f, "setting {name} is not finite or out of range"),
            Self::CellCount => f.write_str(self.message()),
            Self::Coefficient { cell, axis } => {
                write!(f, "{} (cell {cell}, axis {axis})", self.message())
            }
        }
    }
}

impl core::error::Error for TableError {}

/// Whether `value` lies in `low..=high`; NaN does not.
pub(crate) const fn is_within(value: f32, low: f32, high: f32) -> bool {
    value >= low && value <= high
}
