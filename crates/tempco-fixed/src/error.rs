//! Why a table does not fit the integer formats.

use core::fmt;

/// Why a table of the f32 core has no counterpart in integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum FixedError {
    /// The number of cells differs from that of the type.
    CellCount,
    /// The cells are narrower than 2^-16 degC.
    CellWidth,
    /// The calibrated rates reach beyond 2000 degC/min.
    Rate,
    /// With the wanted exponent the axis's coefficients do not fit; a larger one is needed.
    Exponent {
        /// Number of the axis.
        axis: usize,
    },
    /// A pulse carry needs 2^-30 to 2^28 pulses per sample for the largest bias.
    Pulses,
}

impl FixedError {
    /// The reason in words, also where nothing can be formatted (a const panic).
    pub const fn message(self) -> &'static str {
        match self {
            Self::CellCount => "the table has another number of cells than its type",
            Self::CellWidth => "the cells of a fixed-point table must be at least 2^-16 degC wide",
            Self::Rate => "the rates of a fixed-point table must be within 2000 degC/min",
            Self::Exponent { .. } => "the coefficients of an axis need a larger exponent",
            Self::Pulses => "the pulses per sample of the largest bias are beyond 2^-30 to 2^28",
        }
    }
}

impl fmt::Display for FixedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exponent { axis } => write!(f, "{} (axis {axis})", self.message()),
            _ => f.write_str(self.message()),
        }
    }
}

impl core::error::Error for FixedError {}
