//! Ranges of numbers, and the error that names what is outside one.

use core::fmt::Display;

use thiserror::Error;

/// A part of a unit or a profile that cannot be.
///
/// Reads `PATH is FOUND, expected EXPECTED`; elements of lists are counted from 1.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("`{path}` is {found}, expected {expected}")]
pub struct Invalid {
    /// Where it stands, as `axis.x.play[2].half_width_c`.
    pub path: String,
    /// What was given.
    pub found: String,
    /// What would have been right.
    pub expected: String,
}

impl Invalid {
    pub(crate) fn new(
        path: impl Into<String>,
        found: impl Display,
        expected: impl Into<String>,
    ) -> Self {
        Self {
            path: path.into(),
            found: found.to_string(),
            expected: expected.into(),
        }
    }

    /// The same, with the path seen from outside the part.
    pub(crate) fn inside(self, part: impl Display) -> Self {
        Self {
            path: format!("{part}.{}", self.path),
            ..self
        }
    }
}

/// Numbers from `low` to `high`, both included.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Range {
    low: f64,
    high: f64,
}

impl Range {
    /// Anything that may be negative. Wide enough for any physical quantity in any of the units,
    /// narrow enough that no sum of products overflows.
    pub(crate) const SIGNED: Self = Self::new(-1e9, 1e9);
    /// Sigmas and other magnitudes, 0 for none.
    pub(crate) const MAGNITUDE: Self = Self::new(0.0, 1e9);
    /// Temperatures \[degC\], and those of no thing in kelvin.
    pub(crate) const TEMPERATURE: Self = Self::new(-100.0, 200.0);
    /// Differences of temperatures \[degC\].
    pub(crate) const DIFFERENCE: Self = Self::new(-300.0, 300.0);
    /// Magnitudes of differences of temperatures \[degC\], where 0 has no meaning.
    pub(crate) const WIDTH: Self = Self::new(1e-6, 300.0);
    /// Time constants \[s\] of parts that are there.
    pub(crate) const TIME_CONSTANT: Self = Self::new(0.001, 1e7);
    /// Durations of steps \[minutes\].
    pub(crate) const DURATION_MIN: Self = Self::new(1e-4, 6e5);
    /// Times in a profile \[minutes\].
    pub(crate) const TIME_MIN: Self = Self::new(0.0, 6e5);
    /// Rates of chamber air \[degC/min\]: the fastest shock chambers stay below the upper end.
    pub(crate) const AIR_RATE: Self = Self::new(1e-4, 100.0);
    /// Parts of a whole.
    pub(crate) const SHARE: Self = Self::new(0.0, 1.0);
    /// Frequencies \[Hz\].
    pub(crate) const FREQUENCY: Self = Self::new(1e-6, 1e5);

    pub(crate) const fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// The value is in the range; NaN is in none.
    pub(crate) fn check(self, path: &str, value: f64) -> Result<(), Invalid> {
        let Self { low, high } = self;
        if (low..=high).contains(&value) {
            Ok(())
        } else {
            Err(Invalid::new(path, value, format!("{low} to {high}")))
        }
    }
}

/// An element of a list, counted from 1.
pub(crate) fn element(list: &str, index: usize) -> String {
    format!("{list}[{}]", index + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_inside_and_not_a_number_is_not() {
        assert!(Range::SHARE.check("a", 0.0).is_ok());
        assert!(Range::SHARE.check("a", 1.0).is_ok());
        for value in [-1e-9, 1.1, f64::NAN, f64::INFINITY] {
            assert!(Range::SHARE.check("a", value).is_err(), "{value}");
        }
    }

    #[test]
    fn an_error_tells_where_what_and_what_was_expected() {
        let error = Range::SHARE.check(&element("play", 0), 2.0).unwrap_err();
        assert_eq!(
            error.inside("axis.x").to_string(),
            "`axis.x.play[1]` is 2, expected 0 to 1"
        );
    }
}
