//! Columns with temperatures, their units, and the axes that they belong to.

use super::excerpt::{excerpt, list_names};
use super::known::Known;
use super::mapping::{self, Mapping};
use super::names::{self, Linear};

/// Where a temperature comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TempSource {
    /// A column of the log.
    Column(usize),
    /// A temperature of the joined log, by its place there.
    Joined(usize),
}

/// A temperature that was found.
#[derive(Clone, Debug)]
pub(crate) struct FoundTemp {
    pub(crate) column: String,
    pub(crate) source: TempSource,
    pub(crate) to_deg_c: Linear,
    pub(crate) owner: Owner,
    /// Its text in a mapping; none where it has a plain name.
    pub(crate) text: Option<String>,
}

/// The axes that a temperature belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Owner {
    All,
    /// Those whose names end so.
    End(String),
    /// Those whose names begin so.
    Start(String),
}

impl Owner {
    pub(crate) fn owns(&self, axis: &str) -> bool {
        match self {
            Self::All => false,
            Self::End(end) => axis.ends_with(end.as_str()),
            Self::Start(start) => axis.starts_with(start.as_str()),
        }
    }
}

/// A temperature column with what its name, and then a text, say.
fn temp_of(header: &[String], text: &str) -> Result<FoundTemp, String> {
    let found = mapping::temp(text, header)?;
    let column = header[found.position].clone();
    let by_name = names::divide_any(&column).and_then(|(_, unit)| names::temp_unit(unit));
    // What is not said is degC, and is kept so.
    let unit = found.unit.or(by_name);
    let text = match unit {
        Some(_) => text.to_owned(),
        None => format!("{text}:degc"),
    };
    let unit = unit.unwrap_or(names::TempUnit::DegC);
    Ok(FoundTemp {
        column,
        source: TempSource::Column(found.position),
        to_deg_c: found.linear.then(unit.to_deg_c()),
        owner: found.axis.map_or(Owner::All, Owner::End),
        text: Some(text),
    })
}

pub(crate) fn find_temps(
    header: &[String],
    texts: &[String],
    known: Option<&Known>,
) -> Result<Vec<FoundTemp>, String> {
    if !texts.is_empty() {
        return texts.iter().map(|text| temp_of(header, text)).collect();
    }
    if let Some(known) = known {
        return Err(format!(
            "{} without a temperature: expected --join FILE, a log with `time_s` and `temp_c`, or \
             a column named by --temp",
            known.name
        ));
    }
    // Plain names first: `temp_c`, `temp_x_c`.
    let columns = || header.iter().enumerate();
    let plain = columns().filter_map(|(position, column)| {
        let channel = column.strip_prefix("temp")?.strip_suffix("_c")?;
        let channel = channel.trim_start_matches('_');
        Some(FoundTemp {
            column: column.clone(),
            source: TempSource::Column(position),
            to_deg_c: Linear::NONE,
            owner: match channel {
                "" => Owner::All,
                channel => Owner::End(channel.to_owned()),
            },
            text: None,
        })
    });
    let mut found: Vec<FoundTemp> = plain.collect();
    if found.is_empty() {
        let named = columns().filter_map(|(position, column)| {
            let (name, unit) = names::divide_any(column)?;
            let (unit, owner) = (names::temp_unit(unit)?, names::temp_owner(name)?);
            Some(FoundTemp {
                column: column.clone(),
                source: TempSource::Column(position),
                to_deg_c: unit.to_deg_c(),
                owner: match &owner[..] {
                    "" => Owner::All,
                    _ => Owner::Start(owner),
                },
                text: Some(format!("{column}:{}", unit.name())),
            })
        });
        found = named.collect();
    }
    match &mut found[..] {
        [] => Err(no_temp(header)),
        [one] => {
            one.owner = Owner::All;
            Ok(found)
        }
        _ => Ok(found),
    }
}

fn no_temp(header: &[String]) -> String {
    let is_temp = |name: &str| names::temp_owner(name).is_some();
    let without = |name: &str| names::divide_any(name).is_some_and(|(name, _)| is_temp(name));
    let doubtful = header.iter().find(|name| is_temp(name));
    let other = header
        .iter()
        .find(|name| name.starts_with("temp") || without(name));
    let lead = match (doubtful, other) {
        (Some(name), _) => {
            let name = excerpt(name);
            format!("`{name}` has no unit: expected --temp {name}:degc, :degf or :k")
        }
        (None, Some(name)) => format!("`{}` is not in degC by its name", excerpt(name)),
        (None, None) => "no temperature column".to_owned(),
    };
    format!(
        "{lead}: expected `temp_c` [degC] or one `temp_AXIS_c` per axis, a column named by \
         --temp, or a log with it by --join; there are {}",
        list_names(header)
    )
}

/// The temperatures of a log that is joined, for the axes of another.
///
/// # Errors
/// What is wrong with its header.
pub(crate) fn joined_temps(header: &[String], given: &Mapping) -> Result<Vec<FoundTemp>, String> {
    let temps = find_temps(header, &given.temp, None)?
        .into_iter()
        .enumerate();
    let joined = temps.map(|(place, temp)| FoundTemp {
        source: TempSource::Joined(place),
        to_deg_c: Linear::NONE,
        ..temp
    });
    Ok(joined.collect())
}
