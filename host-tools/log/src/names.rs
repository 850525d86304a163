//! What column names say: a name, and a unit in brackets or behind `_`.

use super::time::TimeUnit;
use crate::unit::{AxisUnit, ColumnUnit};

/// A conversion: the value is multiplied, then the offset is added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Linear {
    pub(crate) scale: f64,
    pub(crate) offset: f64,
}

impl Linear {
    /// No change.
    pub(crate) const NONE: Self = Self {
        scale: 1.0,
        offset: 0.0,
    };

    /// This, then another.
    pub(crate) fn then(self, next: Self) -> Self {
        Self {
            scale: self.scale * next.scale,
            offset: self.offset * next.scale + next.offset,
        }
    }
}

/// Unit of a temperature column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TempUnit {
    DegC,
    DegF,
    K,
}

impl TempUnit {
    /// As in `--temp COL:UNIT`.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::DegC => "degc",
            Self::DegF => "degf",
            Self::K => "k",
        }
    }

    /// From this unit to degC.
    pub(crate) fn to_deg_c(self) -> Linear {
        match self {
            Self::DegC => Linear::NONE,
            Self::DegF => Linear {
                scale: 5.0 / 9.0,
                offset: -160.0 / 9.0,
            },
            Self::K => Linear {
                scale: 1.0,
                offset: -273.15,
            },
        }
    }
}

/// A unit in lower case, without blanks and with signs that are on every keyboard.
fn plain(unit: &str) -> String {
    let mut plain = String::new();
    for letter in unit.chars().flat_map(char::to_lowercase) {
        match letter {
            '\u{b0}' | '\u{ba}' | '\u{2da}' => plain.push_str("deg"),
            '\u{b5}' | '\u{3bc}' => plain.push('u'),
            '\u{b2}' => plain.push('2'),
            '\u{207b}' | '\u{2212}' => plain.push('-'),
            '\u{b9}' => plain.push('1'),
            ' ' | '^' | '_' | '*' | '\u{b7}' | '\u{22c5}' | '.' => {}
            other => plain.push(other),
        }
    }
    plain
}

/// A unit of time.
pub(crate) fn time_unit(unit: &str) -> Option<TimeUnit> {
    Some(match &plain(unit)[..] {
        "s" | "sec" | "secs" | "second" | "seconds" | "sek" | "sekunden" => TimeUnit::S,
        "ms" | "msec" | "msecs" | "millis" | "millisecond" | "milliseconds" => TimeUnit::Ms,
        "us" | "usec" | "usecs" | "micros" | "microsecond" | "microseconds" => TimeUnit::Us,
        "ns" | "nsec" | "nsecs" | "nanos" | "nanosecond" | "nanoseconds" => TimeUnit::Ns,
        _ => return None,
    })
}

/// The unit of a time as in `--time COL:UNIT`.
pub(crate) fn time_option(text: &str) -> Option<TimeUnit> {
    if text.eq_ignore_ascii_case("iso") {
        return Some(TimeUnit::Iso);
    }
    let rate = text.to_ascii_lowercase();
    if let Some(rate) = rate.strip_suffix("hz").and_then(|rate| rate.parse().ok()) {
        return (1e-3..=1e9).contains(&rate).then_some(TimeUnit::Hz(rate));
    }
    time_unit(text)
}

/// A unit of temperature.
pub(crate) fn temp_unit(unit: &str) -> Option<TempUnit> {
    Some(match &plain(unit)[..] {
        "c" | "degc" | "degsc" | "celsius" | "degcelsius" | "degreescelsius" => TempUnit::DegC,
        "f" | "degf" | "degsf" | "fahrenheit" | "degfahrenheit" | "degreesfahrenheit" => {
            TempUnit::DegF
        }
        "k" | "degk" | "kelvin" => TempUnit::K,
        _ => return None,
    })
}

/// A unit of an axis, and what the values are multiplied by to be in it.
pub(crate) fn axis_unit(unit: &str) -> Option<(ColumnUnit, f64)> {
    use AxisUnit::{Dph, Dps, G, Mps2, PulsesPerS, Radps};
    let unit = plain(unit);
    let unit = unit.replace("degrees", "deg").replace("degree", "deg");
    let (unit, factor) = match &unit[..] {
        "pulses" => return Some((ColumnUnit::Pulses, 1.0)),
        "dps" | "deg/s" | "degs/s" | "deg/sec" | "deg/second" | "degs-1" => (Dps, 1.0),
        "mdps" | "mdeg/s" => (Dps, 1e-3),
        "dph" | "deg/h" | "deg/hr" | "deg/hour" | "degh-1" => (Dph, 1.0),
        "radps" | "rad/s" | "rads/s" | "rad/sec" | "rads-1" => (Radps, 1.0),
        "mradps" | "mrad/s" => (Radps, 1e-3),
        "pulsespers" | "pulses/s" => (PulsesPerS, 1.0),
        "mps2" | "m/s2" | "m/s/s" | "m/sec2" | "ms-2" => (Mps2, 1.0),
        "g" => (G, 1.0),
        "mg" => (G, 1e-3),
        _ => return None,
    };
    Some((ColumnUnit::Direct(unit), factor))
}

/// A column name and the unit in brackets at its end, if there is one.
pub(crate) fn divide(column: &str) -> Option<(&str, &str)> {
    let (open, close) = [('[', ']'), ('(', ')'), ('{', '}')]
        .into_iter()
        .find(|(_, close)| column.ends_with(*close))?;
    let start = column.rfind(open)?;
    let unit = &column[start + 1..column.len() - close.len_utf8()];
    Some((column[..start].trim(), unit))
}

/// A column name and its unit: in brackets, or behind the last `_`.
pub(crate) fn divide_any(column: &str) -> Option<(&str, &str)> {
    divide(column).or_else(|| column.rsplit_once('_'))
}

/// A name in lower case, with `_` between its words: `Gyro X` becomes `gyro_x`.
pub(crate) fn tidy(name: &str) -> String {
    let words = name.split(|letter: char| !letter.is_alphanumeric());
    let words: Vec<String> = words
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect();
    words.join("_")
}

/// Words for the time, tidied.
const TIME_NAMES: [&str; 13] = [
    "elapsed",
    "elapsed_time",
    "sampletimefine",
    "t",
    "tiempo",
    "time",
    "time_boot",
    "time_since_boot",
    "time_stamp",
    "timestamp",
    "uptime",
    "zeit",
    "zeitstempel",
];

/// Whether a name without its unit is the time's.
pub(crate) fn is_time(name: &str) -> bool {
    TIME_NAMES.contains(&&tidy(name)[..])
}

/// The unit of a column that is the time's by its name: `Time [ms]`, `time_us`, `millis`.
pub(crate) fn time_column(column: &str) -> Option<TimeUnit> {
    if let Some((name, unit)) = divide_any(column) {
        return time_unit(unit).filter(|_| is_time(name));
    }
    // `TimeUS`, `timestampMs`.
    let lower = column.to_lowercase();
    let behind = ["timestamp", "time"]
        .iter()
        .find_map(|word| lower.strip_prefix(word));
    let behind = behind.filter(|unit| unit.len() > 1).and_then(time_unit);
    if behind.is_some() {
        return behind;
    }
    let is_unit_alone = [
        "millis",
        "micros",
        "milliseconds",
        "microseconds",
        "seconds",
    ]
    .contains(&&column.to_lowercase()[..]);
    time_unit(column).filter(|_| is_unit_alone)
}

/// Whether a name may be the time's, whatever its unit.
pub(crate) fn may_be_time(name: &[u8]) -> bool {
    let name = String::from_utf8_lossy(name);
    let name = name.trim();
    let without = divide_any(name).map_or(name, |(name, _)| name);
    is_time(name)
        || is_time(without)
        || time_column(name).is_some()
        || name.starts_with("time")
        || name.starts_with("Time")
}

/// Whether a name without its unit is a temperature's. Returns what stands before the word: `imu0`
/// of `imu0_temp`.
pub(crate) fn temp_owner(name: &str) -> Option<String> {
    const WORDS: [&str; 6] = [
        "temp",
        "temperature",
        "temperatur",
        "temperatura",
        "tmp",
        "die_temp",
    ];
    // In small, it is a time.
    if name.trim() == "T" {
        return Some(String::new());
    }
    let tidy = tidy(name);
    let words = WORDS.iter().filter_map(|word| {
        let before = tidy.strip_suffix(word)?;
        before.strip_suffix('_').or(before.is_empty().then_some(""))
    });
    words.min_by_key(|before| before.len()).map(str::to_owned)
}

/// Whether a name, without its unit, is one under which axes usually go: x, gx, GyroX, acc_y.
pub(crate) fn is_axis(name: &str) -> bool {
    let tidy = tidy(name).replace('_', "");
    let Some(prefix) = tidy.strip_suffix(['x', 'y', 'z']) else {
        return false;
    };
    const PREFIXES: [&str; 20] = [
        "",
        "g",
        "gy",
        "gyr",
        "gyro",
        "gyroscope",
        "w",
        "wrss",
        "omega",
        "rate",
        "angvel",
        "angularvelocity",
        "angularrate",
        "a",
        "ac",
        "acc",
        "accel",
        "accelerometer",
        "acceleration",
        "alpha",
    ];
    PREFIXES.contains(&prefix)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_as_people_write_them() {
        for unit in ["ms", "msec", "Millis", "milliseconds"] {
            assert_eq!(time_unit(unit), Some(TimeUnit::Ms), "{unit}");
        }
        assert_eq!(time_unit("\u{b5}s"), Some(TimeUnit::Us));
        for unit in [
            "\u{b0}C", "degC", "deg C", "C", "\u{ba}C", "Celsius", "deg_C",
        ] {
            assert_eq!(temp_unit(unit), Some(TempUnit::DegC), "{unit}");
        }
        assert_eq!(temp_unit("\u{b0}F"), Some(TempUnit::DegF));
        assert_eq!(temp_unit("K"), Some(TempUnit::K));
        let dps = Some((ColumnUnit::Direct(AxisUnit::Dps), 1.0));
        for unit in [
            "\u{b0}/s",
            "deg/s",
            "dps",
            "deg s^-1",
            "degrees/s",
            "Deg/Sec",
        ] {
            assert_eq!(axis_unit(unit), dps, "{unit}");
        }
        let radps = Some((ColumnUnit::Direct(AxisUnit::Radps), 1.0));
        for unit in ["rad s^-1", "rad/s", "rad\u{b7}s\u{207b}\u{b9}"] {
            assert_eq!(axis_unit(unit), radps, "{unit}");
        }
        let mps2 = Some((ColumnUnit::Direct(AxisUnit::Mps2), 1.0));
        for unit in ["m s^-2", "m/s^2", "m/s\u{b2}", "m/s/s"] {
            assert_eq!(axis_unit(unit), mps2, "{unit}");
        }
        assert_eq!(
            axis_unit("mdps"),
            Some((ColumnUnit::Direct(AxisUnit::Dps), 1e-3))
        );
        for unit in ["rpm", "LSB", "", "uT", "m/s"] {
            assert_eq!(axis_unit(unit), None, "{unit}");
        }
    }

    #[test]
    fn names_are_read_without_their_units() {
        assert_eq!(divide("Gyro X (deg/s)"), Some(("Gyro X", "deg/s")));
        assert_eq!(divide("Time(ms)"), Some(("Time", "ms")));
        assert_eq!(divide("clip_counter[0]"), Some(("clip_counter", "0")));
        assert_eq!(divide("time_s"), None);
        assert_eq!(tidy("Gyro X"), "gyro_x");
        assert_eq!(time_column("Zeit [s]"), Some(TimeUnit::S));
        assert_eq!(time_column("time_us"), Some(TimeUnit::Us));
        assert_eq!(time_column("millis"), Some(TimeUnit::Ms));
        for name in ["TimeUS", "timestampUs", "time_boot_us"] {
            assert_eq!(time_column(name), Some(TimeUnit::Us), "{name}");
        }
        for name in [
            "Time",
            "Times",
            "t",
            "timestamp",
            "s",
            "dwell_s",
            "time_min",
        ] {
            assert_eq!(time_column(name), None, "{name}");
        }
        assert_eq!(temp_owner("Temperature").as_deref(), Some(""));
        assert_eq!(temp_owner("imu0_temp").as_deref(), Some("imu0"));
        assert_eq!(temp_owner("IMU Temperature").as_deref(), Some("imu"));
        assert_eq!(temp_owner("attempt"), None);
        assert_eq!(temp_owner("T").as_deref(), Some(""));
        assert_eq!(temp_owner("t"), None);
    }

    #[test]
    fn units_are_read_as_they_are_written() {
        for text in ["s", "ms", "us", "ns", "iso", "100hz", "10000hz", "0.5hz"] {
            assert_eq!(time_option(text).unwrap().to_string(), text);
        }
        assert_eq!(time_option("Hz"), None);
        assert_eq!(time_option("0hz"), None);
        assert_eq!(time_option("min"), None);
    }
}
