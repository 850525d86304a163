//! Which columns of a header are time, temperatures and axes, and in which units.

use std::collections::HashSet;

use tempco::MAX_AXES;

use super::excerpt::{excerpt, list_names};
use crate::unit::{COLUMN_UNITS, ColumnUnit};

/// Columns named by the user instead of by the naming rule.
///
/// Each part that is empty is found by the rule: `time_s`; `temp_c` or `temp_NAME_c`;
/// `NAME_UNIT` for the axes.
#[derive(Clone, Debug, Default)]
pub struct Mapping {
    /// The time column.
    pub time: Option<String>,
    /// The temperature columns.
    pub temps: Vec<TempColumn>,
    /// The axes.
    pub axes: Vec<AxisColumn>,
}

/// A temperature column and the axis it belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TempColumn {
    /// Name of the axis, or the last letters of it (`x` for `gx` and `ax`); `None` for all axes.
    pub axis: Option<String>,
    /// Name of the column.
    pub column: String,
}

/// An axis and its column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AxisColumn {
    /// Name of the axis.
    pub name: String,
    /// Name of the column.
    pub column: String,
    /// Unit of the values in the column.
    pub unit: ColumnUnit,
}

/// Positions of the columns that are read.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Columns {
    pub(crate) time: usize,
    pub(crate) channels: Vec<ChannelColumns>,
    pub(crate) ignored: Vec<String>,
}

/// Positions of the columns of one channel.
#[derive(Debug, PartialEq, Eq)]
pub struct ChannelColumns {
    /// The temperature.
    pub temp: usize,
    /// The axes.
    pub axes: Vec<(usize, AxisColumn)>,
}

impl Columns {
    /// Finds the columns; the error is what is wrong with the header.
    pub(crate) fn find(header: &[String], mapping: &Mapping) -> Result<Self, String> {
        let mut names = HashSet::new();
        if let Some(twice) = header
            .iter()
            .find(|name| !name.is_empty() && !names.insert(name.as_str()))
        {
            return Err(format!("two columns are named `{}`", excerpt(twice)));
        }
        let time = find_time(header, mapping)?;
        let temps = find_temps(header, mapping)?;
        let axes = find_axes(header, mapping)?;
        let used: Vec<usize> = std::iter::once(time)
            .chain(temps.iter().map(|(position, _)| *position))
            .chain(axes.iter().map(|(position, _)| *position))
            .collect();
        let ignored = (0..header.len())
            .filter(|position| !used.contains(position) && !header[*position].is_empty())
            .map(|position| header[position].clone())
            .collect();
        Ok(Self {
            time,
            channels: assign(temps, axes)?,
            ignored,
        })
    }
}

fn position(header: &[String], name: &str) -> Result<usize, String> {
    header
        .iter()
        .position(|column| column == name)
        .ok_or_else(|| format!("no column `{name}`; there are {}", list_names(header)))
}

fn find_time(header: &[String], mapping: &Mapping) -> Result<usize, String> {
    if let Some(name) = &mapping.time {
        return position(header, name);
    }
    position(header, "time_s").map_err(|_| {
        let lead = match header.iter().find(|name| name.starts_with("time")) {
            _ if header.len() == 1 => {
                "one column: columns must be separated by `,`, `;`, `|`, tabs or blanks".to_owned()
            }
            Some(other) => format!("`{}` is not in seconds by its name", excerpt(other)),
            None => "no time column".to_owned(),
        };
        format!(
            "{lead}: expected `time_s` [s], or a column named by --time; there are {}",
            list_names(header)
        )
    })
}

fn find_temps(
    header: &[String],
    mapping: &Mapping,
) -> Result<Vec<(usize, Option<String>)>, String> {
    if !mapping.temps.is_empty() {
        return mapping
            .temps
            .iter()
            .map(|temp| Ok((position(header, &temp.column)?, temp.axis.clone())))
            .collect();
    }
    let found: Vec<(usize, Option<String>)> = header
        .iter()
        .enumerate()
        .filter_map(|(position, name)| {
            let channel = name.strip_prefix("temp")?.strip_suffix("_c")?;
            let channel = channel.trim_start_matches('_');
            Some((position, (!channel.is_empty()).then(|| channel.to_owned())))
        })
        .collect();
    match found.len() {
        0 => {
            let lead = match header.iter().find(|name| name.starts_with("temp")) {
                Some(other) => format!("`{}` is not in degC by its name", excerpt(other)),
                None => "no temperature column".to_owned(),
            };
            Err(format!(
                "{lead}: expected `temp_c` [degC] or one `temp_AXIS_c` per axis, or a column \
                 named by --temp; there are {}",
                list_names(header)
            ))
        }
        1 => Ok(vec![(found[0].0, None)]),
        _ => Ok(found),
    }
}

fn find_axes(header: &[String], mapping: &Mapping) -> Result<Vec<(usize, AxisColumn)>, String> {
    let axes: Vec<(usize, AxisColumn)> = if mapping.axes.is_empty() {
        let mut axes = Vec::new();
        for (position, column) in header.iter().enumerate() {
            if let Some(axis) = recognise(column)? {
                axes.push((position, axis));
            }
        }
        axes
    } else {
        mapping
            .axes
            .iter()
            .map(|axis| Ok((position(header, &axis.column)?, axis.clone())))
            .collect::<Result<_, String>>()?
    };
    match axes.len() {
        0 => Err(format!(
            "no axis column: expected NAME_UNIT with UNIT one of {COLUMN_UNITS}, or columns \
             named by --axis; there are {}",
            list_names(header)
        )),
        1..=MAX_AXES => Ok(axes),
        count => Err(format!(
            "{count} axis columns, expected 1 to {MAX_AXES}: choose them by --axis"
        )),
    }
}

/// Reads `NAME_UNIT`; a column that is plainly an axis but has no known unit is an error, since
/// leaving it out silently would lose an axis.
fn recognise(column: &str) -> Result<Option<AxisColumn>, String> {
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
            column: column.to_owned(),
            unit,
        }));
    }
    let (name, unit) = split.unwrap_or((column, ""));
    if is_axis_name(name) || is_axis_name(column) {
        let found = if is_axis_name(column) || unit.is_empty() {
            "has no unit".to_owned()
        } else {
            format!("has the unknown unit `{}`", excerpt(unit))
        };
        return Err(format!(
            "column `{}` {found}: expected one of {COLUMN_UNITS}",
            excerpt(column)
        ));
    }
    Ok(None)
}

/// Names under which axes usually go: x, gx, ax, gyro_x, accel_x and the like.
fn is_axis_name(name: &str) -> bool {
    let Some(prefix) = name.strip_suffix(['x', 'y', 'z']) else {
        return false;
    };
    matches!(
        prefix.trim_end_matches('_'),
        "" | "g" | "a" | "w" | "gyr" | "gyro" | "acc" | "accel" | "rate" | "omega"
    )
}

/// Gives each axis its temperature.
fn assign(
    temps: Vec<(usize, Option<String>)>,
    axes: Vec<(usize, AxisColumn)>,
) -> Result<Vec<ChannelColumns>, String> {
    if let [(temp, None)] = temps[..] {
        return Ok(vec![ChannelColumns { temp, axes }]);
    }
    let mut channels: Vec<ChannelColumns> = temps
        .iter()
        .map(|(temp, _)| ChannelColumns {
            temp: *temp,
            axes: Vec::new(),
        })
        .collect();
    for axis in axes {
        let mut owners = temps.iter().enumerate().filter(|(_, (_, channel))| {
            channel
                .as_ref()
                .is_some_and(|channel| axis.1.name.ends_with(channel.as_str()))
        });
        match (owners.next(), owners.next()) {
            (Some((channel, _)), None) => channels[channel].axes.push(axis),
            _ => {
                return Err(format!(
                    "{} temperature columns, and it is not clear which belongs to axis `{}`: \
                     choose one for all axes by --temp COLUMN, or one per axis by \
                     --temp AXIS=COLUMN",
                    temps.len(),
                    excerpt(&axis.1.name)
                ));
            }
        }
    }
    let count = channels[0].axes.len();
    if channels.iter().any(|channel| channel.axes.len() != count) || count == 0 {
        return Err(
            "every temperature column must belong to the same number of axes: choose them by \
             --temp and --axis"
                .to_owned(),
        );
    }
    Ok(channels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(header: &str) -> Result<Columns, String> {
        let header: Vec<String> = header.split(',').map(str::to_owned).collect();
        Columns::find(&header, &Mapping::default())
    }

    fn names(columns: &Columns) -> Vec<Vec<&str>> {
        let name = |axis: &(usize, AxisColumn)| axis.1.name.clone().leak() as &str;
        columns
            .channels
            .iter()
            .map(|channel| channel.axes.iter().map(name).collect())
            .collect()
    }

    #[test]
    fn names_with_units_are_recognised_and_the_rest_is_ignored() {
        let columns = find("time_s,temp_c,gx_dps,gyro_y_pulses,az_mps2,baro_temp_c,mx_cnt,note");
        let columns = columns.unwrap();
        assert_eq!(names(&columns), [["gx", "gyro_y", "az"]]);
        assert_eq!(columns.channels[0].axes[1].1.unit, ColumnUnit::Pulses);
        assert_eq!(columns.ignored, ["baro_temp_c", "mx_cnt", "note"]);
    }

    #[test]
    fn temperatures_per_axis_go_to_their_axes() {
        let columns = find("time_s,temp_x_c,temp_y_c,gx_dps,gy_dps,ax_g,ay_g").unwrap();
        assert_eq!(names(&columns), [["gx", "ax"], ["gy", "ay"]]);
        assert_eq!(columns.channels[1].temp, 2);
    }

    #[test]
    fn what_is_unclear_is_refused_with_what_was_expected() {
        for (header, part) in [
            ("time_ms,temp_c,x_dps", "`time_ms` is not in seconds"),
            ("t,temp_c,x_dps", "expected `time_s`"),
            ("time_s;temp_c;x_dps", "columns must be separated by"),
            ("time_s,x_dps", "no temperature column"),
            ("time_s,temp_k,x_dps", "`temp_k` is not in degC"),
            ("time_s,temp_c,x_rpm", "unknown unit `rpm`"),
            ("time_s,temp_c,gx_dps,gy_dps,gz", "`gz` has no unit"),
            ("time_s,temp_c,gyro_x", "`gyro_x` has no unit"),
            ("time_s,temp_c,mx_cnt", "no axis column"),
            (
                "time_s,temp_c,temp_c,x_dps",
                "two columns are named `temp_c`",
            ),
            ("time_s,temp_c,temp_case_c,x_dps", "2 temperature columns"),
            ("time_s,temp1_c,temp2_c,x_dps", "2 temperature columns"),
            ("time_s,temp_x_c,temp_y_c,x_dps", "same number of axes"),
            (
                "time_s,temp_c,a_g,b_g,c_g,d_g,e_g,f_g,h_g",
                "7 axis columns",
            ),
        ] {
            let error = find(header).unwrap_err();
            assert!(error.contains(part), "{header}: {error}");
        }
    }

    #[test]
    fn a_mapping_overrules_the_names() {
        let header: Vec<String> = ["t", "T1", "T2", "wx", "wy"].map(str::to_owned).into();
        let axis = |name: &str, column: &str| AxisColumn {
            name: name.to_owned(),
            column: column.to_owned(),
            unit: "dps".parse().unwrap(),
        };
        let temp = |axis: &str, column: &str| TempColumn {
            axis: Some(axis.to_owned()),
            column: column.to_owned(),
        };
        let mapping = Mapping {
            time: Some("t".to_owned()),
            temps: vec![temp("x", "T2"), temp("y", "T1")],
            axes: vec![axis("x", "wx"), axis("y", "wy")],
        };
        let columns = Columns::find(&header, &mapping).unwrap();
        assert_eq!((columns.time, columns.channels[0].temp), (0, 2));
        assert_eq!(names(&columns), [["x"], ["y"]]);
        let missing = Mapping {
            time: Some("time".to_owned()),
            ..mapping
        };
        let error = Columns::find(&header, &missing).unwrap_err();
        assert!(error.contains("no column `time`"), "{error}");
    }
}
