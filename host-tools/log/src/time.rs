//! Units of time columns, and clock times.

use std::fmt;

use jiff::Timestamp;
use jiff::civil::{Date, DateTime, Time};
use jiff::tz::TimeZone;

/// How the cells of a time column are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TimeUnit {
    /// Seconds.
    S,
    /// Milliseconds.
    Ms,
    /// Microseconds.
    Us,
    /// Nanoseconds; times count from the first row, since a double holds no such times of today.
    Ns,
    /// Dates and times of day by ISO 8601; times count from the first row.
    Iso,
    /// Ticks at this rate \[Hz\].
    Hz(f64),
}

impl TimeUnit {
    /// How many make a second; none of clock times.
    pub(crate) fn per_second(self) -> Option<f64> {
        match self {
            Self::S => Some(1.0),
            Self::Ms => Some(1e3),
            Self::Us => Some(1e6),
            Self::Ns => Some(1e9),
            Self::Hz(rate) => Some(rate),
            Self::Iso => None,
        }
    }

    /// Whether times count from the first row.
    pub(crate) fn has_origin(self) -> bool {
        matches!(self, Self::Ns | Self::Iso)
    }

    /// Nanoseconds of a cell, exact; none of a unit without origin.
    pub(crate) fn nanoseconds(self, cell: &[u8]) -> Option<i128> {
        let text = str::from_utf8(cell).ok()?.trim();
        match self {
            Self::Ns => text.parse().ok(),
            Self::Iso => clock_ns(text),
            _ => None,
        }
    }
}

impl fmt::Display for TimeUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::S => f.write_str("s"),
            Self::Ms => f.write_str("ms"),
            Self::Us => f.write_str("us"),
            Self::Ns => f.write_str("ns"),
            Self::Iso => f.write_str("iso"),
            Self::Hz(rate) => write!(f, "{rate}hz"),
        }
    }
}

/// A date and time by ISO 8601, with or without an offset from UTC, or a time of day, in nanoseconds.
pub(crate) fn clock_ns(text: &str) -> Option<i128> {
    if !text.contains(':') {
        return None;
    }
    if let Ok(instant) = text.parse::<Timestamp>() {
        return Some(instant.as_nanosecond());
    }
    let is_time_of_day = text.as_bytes().get(2) == Some(&b':');
    let civil = match is_time_of_day {
        true => DateTime::from_parts(Date::constant(1970, 1, 1), text.parse::<Time>().ok()?),
        false => text.parse::<DateTime>().ok()?,
    };
    let instant = TimeZone::UTC.to_timestamp(civil).ok()?;
    Some(instant.as_nanosecond())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clock_times_are_exact() {
        let since = |text: &str, start: &str| clock_ns(text).unwrap() - clock_ns(start).unwrap();
        let start = "2023-03-04 09:00:00";
        assert_eq!(since("2023-03-04T09:00:00.2", start), 200_000_000);
        assert_eq!(since("2023-03-04 09:00:00,200000001", start), 200_000_001);
        assert_eq!(
            since("2023-03-04T10:00:01+01:00", "2023-03-04T09:00:00Z"),
            1_000_000_000
        );
        assert_eq!(since("10:00:00.5", "09:59:59"), 1_500_000_000);
        for text in [
            "03/04/2023 09:00:00",
            "04.03.2023 09:00:00",
            "2023-03-04",
            "12.5",
            "9:00",
            "",
        ] {
            assert_eq!(clock_ns(text), None, "{text}");
        }
    }
}
