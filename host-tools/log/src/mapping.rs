//! Columns that a user names, as text.

use serde::{Deserialize, Serialize};

use super::excerpt::{excerpt, list_names};
use super::names::{self, Linear, TempUnit};
use super::time::TimeUnit;
use crate::unit::{COLUMN_UNITS, ColumnUnit};

/// Columns named by the user instead of by the naming rule, each as the text of an option.
///
/// Each part that is empty is found by the rule: `time_s`; `temp_c` or `temp_NAME_c`;
/// `NAME_UNIT` for the axes. A text is first taken for the whole name of a column, then its end for
/// scale, offset and unit.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Mapping {
    /// The time: `COL[:s|ms|us|ns|iso]`, or `COL:100hz` of a counter at a rate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// The temperatures: `[AXIS=]COL[*SCALE][+OFFSET][:degc|degf|k]`. The axis is its name, or the
    /// last letters of it (`x` for `gx` and `ax`).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub temp: Vec<String>,
    /// The axes: `NAME=COL[*SCALE][+OFFSET]:UNIT`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub axis: Vec<String>,
    /// Only rows with these cells are read: `COL=VALUE`.
    #[serde(rename = "where", skip_serializing_if = "Vec::is_empty")]
    pub filter: Vec<String>,
    /// Of a known logger with several sources, only the rows of this one are read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instance: Option<u32>,
    /// A log with the temperatures, by time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub join: Option<String>,
}

impl Mapping {
    /// Whether nothing is named.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// This, and of another what this does not name.
    pub fn or(&self, other: &Self) -> Self {
        let or = |own: &Vec<String>, other: &Vec<String>| match own.is_empty() {
            true => other.clone(),
            false => own.clone(),
        };
        Self {
            time: self.time.clone().or_else(|| other.time.clone()),
            temp: or(&self.temp, &other.temp),
            axis: or(&self.axis, &other.axis),
            filter: or(&self.filter, &other.filter),
            instance: self.instance.or(other.instance),
            join: self.join.clone().or_else(|| other.join.clone()),
        }
    }

    /// As options on a command line.
    pub fn options(&self) -> String {
        let each = |option: &str, texts: &[String]| {
            let texts = texts.iter();
            texts
                .map(
                    |text| match text.contains([' ', '*', '(', '$', '[', ';', '|']) {
                        true => format!("{option} \"{}\"", excerpt(text)),
                        false => format!("{option} {}", excerpt(text)),
                    },
                )
                .collect::<Vec<_>>()
        };
        let instance = self.instance.map(|instance| instance.to_string());
        let options = [
            each("--time", self.time.as_slice()),
            each("--temp", &self.temp),
            each("--axis", &self.axis),
            each("--where", &self.filter),
            each("--instance", instance.as_slice()),
            each("--join", self.join.as_slice()),
        ];
        options.concat().join(" ")
    }
}

/// The place of a column in a header.
pub(crate) fn position(header: &[String], name: &str) -> Result<usize, String> {
    header
        .iter()
        .position(|column| column == name)
        .ok_or_else(|| {
            let name = excerpt(name);
            format!("no column `{name}`; there are {}", list_names(header))
        })
}

/// A column with its conversion and unit.
#[derive(Debug, PartialEq)]
struct Expression<'a> {
    position: usize,
    linear: Linear,
    unit: Option<&'a str>,
}

/// Reads `COL[*SCALE][+OFFSET][:UNIT]`; of several readings, the one with the longest name.
fn expression<'a>(text: &'a str, header: &[String]) -> Result<Expression<'a>, String> {
    let find = |name: &str| header.iter().position(|column| column == name.trim());
    let number = |text: &str| {
        let number: f64 = text.trim().parse().ok()?;
        (number.is_finite() && number.abs() <= 1e15).then_some(number)
    };
    let scaled = |text: &str| -> Option<(usize, f64, usize)> {
        if let Some(position) = find(text) {
            return Some((position, 1.0, text.len()));
        }
        let stars = text.rmatch_indices('*');
        stars
            .filter_map(|(star, _)| {
                let scale = number(&text[star + 1..]).filter(|scale| *scale != 0.0)?;
                Some((find(&text[..star])?, scale, star))
            })
            .next()
    };
    let linear = |text: &str| -> Option<(usize, Linear, usize)> {
        let plain = scaled(text).map(|(position, scale, length)| {
            let linear = Linear { scale, offset: 0.0 };
            (position, linear, length)
        });
        let signs = text.rmatch_indices(['+', '-']).filter_map(|(sign, _)| {
            let offset = text[sign..].strip_prefix('+').unwrap_or(&text[sign..]);
            let (position, scale, length) = scaled(&text[..sign])?;
            let offset = number(offset)?;
            Some((position, Linear { scale, offset }, length))
        });
        plain
            .into_iter()
            .chain(signs)
            .max_by_key(|(.., length)| *length)
    };
    let whole = linear(text).map(|found| (found, None));
    let with_unit = text
        .rsplit_once(':')
        .and_then(|(front, unit)| Some((linear(front)?, Some(unit.trim()))));
    // The last of equals is taken: the whole text as a name.
    let found = with_unit.into_iter().chain(whole);
    match found.max_by_key(|((.., length), _)| *length) {
        Some(((position, linear, _), unit)) => Ok(Expression {
            position,
            linear,
            unit,
        }),
        None => {
            let name = text.rsplit_once(':').map_or(text, |(name, _)| name);
            let name = name.split('*').next().unwrap_or(name);
            Err(position(header, name).err().unwrap_or_else(|| {
                let text = excerpt(text);
                format!("`{text}`: expected COL[*SCALE][+OFFSET][:UNIT]")
            }))
        }
    }
}

/// The time column and its unit, if the text names one.
pub(crate) fn time(text: &str, header: &[String]) -> Result<(usize, Option<TimeUnit>), String> {
    let found = expression(text, header)?;
    if found.linear != Linear::NONE {
        return Err(format!(
            "--time `{}`: expected COL[:UNIT] without scale and offset",
            excerpt(text)
        ));
    }
    let unit = found.unit.map(|unit| {
        names::time_option(unit).ok_or_else(|| {
            format!(
                "--time: unknown unit `{}`: expected s, ms, us, ns or iso",
                excerpt(unit)
            )
        })
    });
    Ok((found.position, unit.transpose()?))
}

/// A temperature as the text says it.
pub(crate) struct TempText {
    pub(crate) axis: Option<String>,
    pub(crate) position: usize,
    pub(crate) linear: Linear,
    pub(crate) unit: Option<TempUnit>,
}

/// A temperature column.
pub(crate) fn temp(text: &str, header: &[String]) -> Result<TempText, String> {
    let whole = expression(text, header).map(|found| (None, found));
    let (axis, found) = whole.or_else(|error| named(text, header).unwrap_or(Err(error)))?;
    let unit = found.unit.map(|unit| {
        names::temp_unit(unit).ok_or_else(|| {
            format!(
                "--temp: unknown unit `{}`: expected degc, degf or k",
                excerpt(unit)
            )
        })
    });
    Ok(TempText {
        axis,
        position: found.position,
        linear: found.linear,
        unit: unit.transpose()?,
    })
}

/// A name, and what it stands for.
type Named<'a> = (Option<String>, Expression<'a>);

/// Reads `NAME=EXPRESSION`; `None` without a `=`. The first `=` that leaves a column counts.
fn named<'a>(text: &'a str, header: &[String]) -> Option<Result<Named<'a>, String>> {
    let read = text.match_indices('=').map(|(at, _)| {
        let found = expression(&text[at + 1..], header)?;
        Ok((Some(text[..at].trim().to_owned()), found))
    });
    let mut read: Vec<_> = read.collect();
    let good = read.iter().position(Result::is_ok).unwrap_or(0);
    (!read.is_empty()).then(|| read.swap_remove(good))
}

/// An axis as the text says it.
#[derive(Debug)]
pub(crate) struct AxisText {
    pub(crate) name: String,
    pub(crate) position: usize,
    pub(crate) linear: Linear,
    pub(crate) unit: ColumnUnit,
}

/// An axis; without a unit in the text, the column's name must have one.
pub(crate) fn axis(text: &str, header: &[String]) -> Result<AxisText, String> {
    let expected = || {
        format!(
            "--axis `{}`: expected NAME=COL:UNIT with UNIT one of {COLUMN_UNITS}",
            excerpt(text)
        )
    };
    let (name, found) = named(text, header).ok_or_else(expected)??;
    let column = &header[found.position];
    let unit = match found.unit {
        Some(unit) => names::axis_unit(unit)
            .ok_or_else(|| format!("unknown unit `{}`; {}", excerpt(unit), expected()))?,
        None => names::divide_any(column)
            .and_then(|(_, unit)| names::axis_unit(unit))
            .ok_or_else(expected)?,
    };
    let (unit, factor) = unit;
    let scale = Linear {
        scale: factor,
        offset: 0.0,
    };
    Ok(AxisText {
        name: name.unwrap_or_default(),
        position: found.position,
        linear: found.linear.then(scale),
        unit,
    })
}

/// Rows that are read: those whose cell in this column is this text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Filter {
    pub(crate) position: usize,
    pub(crate) value: Vec<u8>,
    /// Whether another text is an error: the column counts sources, and there should be one.
    pub(crate) is_only: bool,
}

/// A choice of rows, `COL=VALUE`.
pub(crate) fn filter(text: &str, header: &[String]) -> Result<Filter, String> {
    let mut last = format!("--where `{}`: expected COL=VALUE", excerpt(text));
    for (at, _) in text.match_indices('=') {
        match position(header, text[..at].trim()) {
            Ok(position) => {
                return Ok(Filter {
                    position,
                    value: text[at + 1..].trim().as_bytes().to_vec(),
                    is_only: false,
                });
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(names: &str) -> Vec<String> {
        names.split(',').map(str::to_owned).collect()
    }

    #[test]
    fn a_whole_name_comes_first_then_the_end_from_the_right() {
        let header = header("tmp,tmp*2,tmp:k,a+b,Gyro X [deg/s],tmp*2+1:k,x=y");
        let read = |text| {
            let found = temp(text, &header).unwrap();
            let unit = found.unit.map(TempUnit::name);
            (
                found.position,
                found.linear.scale,
                found.linear.offset,
                unit,
            )
        };
        assert_eq!(read("tmp"), (0, 1.0, 0.0, None));
        assert_eq!(read("tmp*2"), (1, 1.0, 0.0, None));
        assert_eq!(read("tmp*3"), (0, 3.0, 0.0, None));
        assert_eq!(read("tmp*2*3"), (1, 3.0, 0.0, None));
        assert_eq!(read("tmp*2+1:k"), (5, 1.0, 0.0, None));
        assert_eq!(read("tmp*2+1:degf"), (1, 1.0, 1.0, Some("degf")));
        assert_eq!(read("tmp:k"), (2, 1.0, 0.0, None));
        assert_eq!(read("tmp:degc"), (0, 1.0, 0.0, Some("degc")));
        assert_eq!(read("tmp*0.00294+36.53"), (0, 0.00294, 36.53, None));
        assert_eq!(read("tmp*1e-3-5e1:K"), (0, 1e-3, -50.0, Some("k")));
        assert_eq!(read("tmp+-3"), (0, 1.0, -3.0, None));
        assert_eq!(read("a+b+1"), (3, 1.0, 1.0, None));
        assert_eq!(read("x=y"), (6, 1.0, 0.0, None));
        assert_eq!(temp("x=tmp", &header).unwrap().axis.as_deref(), Some("x"));
        assert_eq!(temp("x=x=y*2", &header).unwrap().position, 6);
        let found = axis("gx=tmp*0.00763:dps", &header).unwrap();
        assert_eq!((found.position, found.linear.scale), (0, 0.00763));
        assert_eq!(axis("gx=Gyro X [deg/s]", &header).unwrap().position, 4);
        assert_eq!(filter("x=y=3", &header).unwrap().position, 6);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let header = header("t,tmp,gx");
        let texts = [
            (
                temp("temp*2", &header).err(),
                "no column `temp`; there are `t`",
            ),
            (
                temp("tmp:degx", &header).err(),
                "unknown unit `degx`: expected degc",
            ),
            (
                temp("tmp*0", &header).err(),
                "`tmp*0`: expected COL[*SCALE]",
            ),
            (
                temp("tmp*nan", &header).err(),
                "`tmp*nan`: expected COL[*SCALE]",
            ),
            (axis("gx", &header).err(), "expected NAME=COL:UNIT"),
            (axis("gx=gx", &header).err(), "expected NAME=COL:UNIT"),
            (axis("gx=gx:rpm", &header).err(), "unknown unit `rpm`"),
            (axis("gx=gz:dps", &header).err(), "no column `gz`"),
            (
                time("t:h", &header).err(),
                "unknown unit `h`: expected s, ms",
            ),
            (time("t*2", &header).err(), "without scale"),
            (filter("I=0", &header).err(), "no column `I`"),
            (filter("I", &header).err(), "expected COL=VALUE"),
        ];
        for (error, expected) in texts {
            let error = error.unwrap();
            assert!(error.contains(expected), "{error}");
        }
    }
}
