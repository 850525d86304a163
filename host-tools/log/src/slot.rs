//! The values of a row: where each is read, and how it is converted.

use super::names::Linear;

/// What a value stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Time,
    Temp(usize),
    Axis(usize),
}

/// A value of a row and where it is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) kind: Kind,
    pub(super) position: usize,
    pub(super) conversion: Conversion,
}

/// From the number in a cell to the unit of the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Conversion {
    None,
    /// Ticks, so many in a second: a division rounds once.
    PerSecond(f64),
    Linear(Linear),
}

impl Conversion {
    pub(super) fn linear(linear: Linear) -> Self {
        match linear == Linear::NONE {
            true => Self::None,
            false => Self::Linear(linear),
        }
    }

    #[inline]
    pub(super) fn of(self, value: f64) -> f64 {
        match self {
            Self::None => value,
            Self::PerSecond(ticks) => value / ticks,
            Self::Linear(linear) => value * linear.scale + linear.offset,
        }
    }

    /// The number in a cell that becomes this value.
    pub(super) fn inverse(self, value: f64) -> f64 {
        match self {
            Self::None => value,
            Self::PerSecond(ticks) => value * ticks,
            Self::Linear(linear) => (value - linear.offset) / linear.scale,
        }
    }
}
