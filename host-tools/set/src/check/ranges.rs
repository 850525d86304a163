//! Ranges of numbers, and the message for one that is out of its range.

use std::fmt::Display;
use std::ops::RangeInclusive;

/// Angles per pulse that a gyro can have \[arcsec\].
pub const SCALE_FACTORS_ARCSEC: RangeInclusive<f64> = 1e-6..=1e6;

/// No figure of a set is larger.
pub(super) const LARGEST: f64 = 1e30;
pub(super) const ANY: RangeInclusive<f64> = -LARGEST..=LARGEST;
pub(super) const AT_LEAST_0: RangeInclusive<f64> = 0.0..=LARGEST;

/// Shares of the lags that the core takes, and more.
pub(super) const LAG_SHARES: RangeInclusive<f64> = -2.0..=2.0;

/// Shares and correlations may be beyond 1 by rounding.
pub(super) const ONE: f64 = 1.0 + 1e-3;

/// A number in its range, or a message with its key.
pub(super) fn within(
    key: impl Display,
    value: f64,
    range: RangeInclusive<f64>,
) -> Result<(), String> {
    if range.contains(&value) {
        return Ok(());
    }
    let (low, high) = range.into_inner();
    Err(format!("{key} is {value:?}: expected {low:?} to {high:?}"))
}

/// Numbers with their names in `parent`, all in one range.
pub(super) fn all_within(
    parent: &str,
    numbers: &[(&str, f64)],
    range: &RangeInclusive<f64>,
) -> Result<(), String> {
    let mut numbers = numbers.iter();
    numbers.try_for_each(|(name, value)| {
        within(format_args!("{parent}.{name}"), *value, range.clone())
    })
}

/// Numbers of a list, all in one range.
pub(super) fn all_in(
    parent: &str,
    name: &str,
    list: &[f64],
    range: &RangeInclusive<f64>,
) -> Result<(), String> {
    let mut list = list.iter().enumerate();
    list.try_for_each(|(i, value)| {
        within(format_args!("{parent}.{name}[{i}]"), *value, range.clone())
    })
}
