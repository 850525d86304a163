//! Columns with axes, and their units.

use std::collections::HashSet;

use tempco::MAX_AXES;

use super::excerpt::{excerpt, list_names};
use super::mapping;
use super::names::{self, Linear};
use crate::unit::{AxisUnit, COLUMN_UNITS, ColumnUnit};

/// An axis and its column.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisColumn {
    /// Name of the axis.
    pub name: String,
    /// Unit of the values, once they are converted.
    pub unit: ColumnUnit,
    pub(crate) position: usize,
    pub(crate) linear: Linear,
}

/// An axis, and its text in a mapping unless it has a plain name.
pub(crate) type FoundAxis = (AxisColumn, Option<String>);

pub(crate) fn find_axes(header: &[String], texts: &[String]) -> Result<Vec<FoundAxis>, String> {
    let mut axes: Vec<FoundAxis> = Vec::new();
    for text in texts {
        let found = mapping::axis(text, header)?;
        let axis = AxisColumn {
            name: found.name,
            unit: found.unit,
            position: found.position,
            linear: found.linear,
        };
        axes.push((axis, Some(text.clone())));
    }
    if axes.is_empty() {
        for (position, column) in header.iter().enumerate() {
            axes.extend(recognise_axis(position, column)?.map(|axis| (axis, None)));
        }
    }
    // Only where no name is plain, so that a plain log stays what it is.
    if axes.is_empty() {
        for (position, column) in header.iter().enumerate() {
            axes.extend(bracketed_axis(position, column)?);
        }
    }
    let mut names = HashSet::new();
    if let Some((twice, _)) = axes.iter().find(|(axis, _)| !names.insert(&axis.name)) {
        return Err(format!("two axes are named `{}`", excerpt(&twice.name)));
    }
    match axes.len() {
        0 => Err(no_axis(header)),
        1..=MAX_AXES => Ok(axes),
        count => Err(format!(
            "{count} axis columns, expected 1 to {MAX_AXES}: choose them by --axis"
        )),
    }
}

fn no_axis(header: &[String]) -> String {
    let is_axis = |name: &&String| names::is_axis(name);
    match header.iter().find(is_axis) {
        Some(column) => no_unit(column, "has no unit"),
        None => format!(
            "no axis column: expected NAME_UNIT with UNIT one of {COLUMN_UNITS}, or columns \
             named by --axis; there are {}",
            list_names(header)
        ),
    }
}

fn no_unit(column: &str, found: &str) -> String {
    let column = excerpt(column);
    let name = excerpt(&names::tidy(&column));
    format!(
        "column `{column}` {found}: expected one of {COLUMN_UNITS}: give it by --axis \
         \"{name}={column}:UNIT\""
    )
}

/// Reads `NAME_UNIT`; a column that is plainly an axis but has no known unit is an error, since
/// leaving it out silently would lose an axis.
fn recognise_axis(position: usize, column: &str) -> Result<Option<AxisColumn>, String> {
    // `pulses_per_s` contains the separator, so it is looked for first.
    let split = column
        .strip_suffix("_pulses_per_s")
        .map(|name| (name, "pulses_per_s"))
        .or_else(|| column.rsplit_once('_'));
    if let Some((name, unit)) = split
        && let Ok(unit) = unit.parse::<ColumnUnit>()
        && !name.is_empty()
    {
        return Ok(Some(AxisColumn {
            name: name.to_owned(),
            unit,
            position,
            linear: Linear::NONE,
        }));
    }
    let (name, unit) = split.unwrap_or((column, ""));
    if is_plain_axis_name(name) || is_plain_axis_name(column) {
        let found = if is_plain_axis_name(column) || unit.is_empty() {
            "has no unit".to_owned()
        } else {
            format!("has the unknown unit `{}`", excerpt(unit))
        };
        return Err(no_unit(column, &found));
    }
    Ok(None)
}

/// Names under which axes usually go in plain logs: x, gx, ax, gyro_x, accel_x and the like.
fn is_plain_axis_name(name: &str) -> bool {
    let Some(prefix) = name.strip_suffix(['x', 'y', 'z']) else {
        return false;
    };
    matches!(
        prefix.trim_end_matches('_'),
        "" | "g" | "a" | "w" | "gyr" | "gyro" | "acc" | "accel" | "rate" | "omega"
    )
}

/// Reads `Gyro X [deg/s]`. A unit of weight counts for names of axes only.
fn bracketed_axis(position: usize, column: &str) -> Result<Option<FoundAxis>, String> {
    let Some((name, unit)) = names::divide(column) else {
        return Ok(None);
    };
    let is_axis = names::is_axis(name);
    match names::axis_unit(unit) {
        Some((ColumnUnit::Direct(AxisUnit::G), _)) if !is_axis => Ok(None),
        Some((unit, scale)) => {
            let name = names::tidy(name);
            let text = format!("{name}={column}");
            let axis = AxisColumn {
                name,
                unit,
                position,
                linear: Linear { scale, offset: 0.0 },
            };
            Ok(Some((axis, Some(text))))
        }
        None if is_axis => {
            let unit = excerpt(unit);
            Err(no_unit(column, &format!("has the unknown unit `{unit}`")))
        }
        None => Ok(None),
    }
}
