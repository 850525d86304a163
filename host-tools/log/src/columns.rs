//! Which columns of a header are time, temperatures and axes, and in which units.

use std::collections::HashSet;

use tempco::MAX_AXES;

use super::dialect::is_clock;
use super::excerpt::{excerpt, excerpt_of_bytes, list_names};
use super::known::{Known, Signs, recognise};
use super::mapping::{self, Filter, Mapping};
use super::names::{self, Linear};
use super::reading::Reading;
use super::time::TimeUnit;
use crate::unit::{AxisUnit, COLUMN_UNITS, ColumnUnit};

/// The columns that are read.
#[derive(Debug)]
pub(crate) struct Columns {
    pub(crate) time: usize,
    pub(crate) time_unit: TimeUnit,
    pub(crate) channels: Vec<ChannelColumns>,
    pub(crate) filters: Vec<Filter>,
    pub(crate) ignored: Vec<String>,
    pub(crate) reading: Reading,
}

/// The columns of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelColumns {
    /// Name of the temperature column.
    pub column: String,
    /// Where the temperature comes from.
    pub(crate) temp: TempSource,
    /// From its values to degC.
    pub(crate) to_deg_c: Linear,
    /// The axes.
    pub axes: Vec<AxisColumn>,
}

/// Where a temperature comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TempSource {
    /// A column of the log.
    Column(usize),
    /// A temperature of the joined log, by its place there.
    Joined(usize),
}

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

/// A temperature that was found.
#[derive(Clone, Debug)]
pub(crate) struct FoundTemp {
    column: String,
    source: TempSource,
    to_deg_c: Linear,
    owner: Owner,
    /// Its text in a mapping; none where it has a plain name.
    text: Option<String>,
}

/// The axes that a temperature belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Owner {
    All,
    /// Those whose names end so.
    End(String),
    /// Those whose names begin so.
    Start(String),
}

impl Owner {
    fn owns(&self, axis: &str) -> bool {
        match self {
            Self::All => false,
            Self::End(end) => axis.ends_with(end.as_str()),
            Self::Start(start) => axis.starts_with(start.as_str()),
        }
    }
}

/// A time column, its unit, and its text in a mapping unless it has the plain name.
type FoundTime = (usize, TimeUnit, Option<String>);

impl Columns {
    /// Finds the columns: those named by the user, else those of a mapping that was kept and fits,
    /// else those of a known layout, else by their names.
    ///
    /// # Errors
    /// What is wrong with the header, and which option helps.
    pub(crate) fn find(
        signs: &Signs,
        given: &Mapping,
        kept: &[Mapping],
        joined: Option<(Vec<FoundTemp>, String)>,
    ) -> Result<Self, String> {
        let header = signs.header;
        check_names(header)?;
        let fitting = kept.iter().find(|mapping| fits(mapping, header));
        let own = match fitting {
            // Its temperatures are columns of the joined log.
            Some(kept) if kept.join.is_some() => given.or(&Mapping {
                temp: Vec::new(),
                ..kept.clone()
            }),
            Some(kept) => given.or(kept),
            None => given.clone(),
        };
        // A known layout gives what is not named.
        let is_complete = own.time.is_some() && !own.axis.is_empty() && !own.temp.is_empty();
        let is_plain = header.iter().any(|name| name == "time_s");
        let known = match recognise(signs, !own.axis.is_empty()) {
            _ if is_plain => None,
            // Its source still counts.
            Err(_) if is_complete => None,
            known => known?,
        };
        let mapping = match &known {
            Some(known) => own.or(&known.mapping),
            None => own,
        };

        let time = find_time(signs, mapping.time.as_deref())?;
        // A joined log that was kept is for a log without temperatures of its own.
        let own_temps = || find_temps(header, &mapping.temp, known.as_ref());
        let is_wanted = given.join.is_some() || own_temps().is_err();
        let (temps, join) = match joined.filter(|_| is_wanted) {
            Some((temps, file)) => (Ok(temps), Some(file)),
            None => (own_temps(), None),
        };
        let (temps, axes) = match (temps, find_axes(header, &mapping.axis)) {
            (Ok(temps), Ok(axes)) => (temps, axes),
            (Err(of_temps), Err(of_axes)) => return Err(format!("{of_axes}; and {of_temps}")),
            (Err(error), _) | (_, Err(error)) => return Err(error),
        };
        let filters = find_filters(signs, &mapping.filter, known.as_ref())?;

        let (axes, axis_texts): (Vec<AxisColumn>, Vec<Option<String>>) = axes.into_iter().unzip();
        let used: HashSet<usize> = std::iter::once(time.0)
            .chain(temps.iter().filter_map(|temp| match temp.source {
                TempSource::Column(position) => Some(position),
                TempSource::Joined(_) => None,
            }))
            .chain(axes.iter().map(|axis| axis.position))
            .chain(filters.iter().map(|filter| filter.position))
            .collect();
        let ignored = header.iter().enumerate();
        let ignored =
            ignored.filter(|(position, name)| !used.contains(position) && !name.is_empty());
        let ignored = ignored.map(|(_, name)| name.clone()).collect();
        let temp_texts = texts_of(&temps, &axes);
        let used_mapping = Mapping {
            time: time.2,
            temp: temp_texts,
            axis: axis_texts.into_iter().flatten().collect(),
            filter: mapping.filter,
            join,
        };
        Ok(Self {
            time: time.0,
            time_unit: time.1,
            channels: assign(temps, axes)?,
            filters,
            ignored,
            reading: Reading {
                layout: known.as_ref().map(|known| known.name.to_owned()),
                notes: Vec::new(),
                warning: known.and_then(|known| known.warning),
                mapping: (!used_mapping.is_empty()).then_some(used_mapping),
            },
        })
    }

    /// Finds time and temperatures of a log that is joined: each temperature is a channel, without
    /// axes.
    pub(crate) fn of_joined(signs: &Signs, given: &Mapping) -> Result<Self, String> {
        let header = signs.header;
        check_names(header)?;
        // `--time` may name the column of the log only.
        let time = given.time.as_deref();
        let time = time.filter(|text| mapping::time(text, header).is_ok());
        let temps = find_temps(header, &given.temp, None)?;
        let (time, time_unit, _) = find_time(signs, time)?;
        let channels = temps.into_iter().map(|temp| ChannelColumns {
            column: temp.column,
            temp: temp.source,
            to_deg_c: temp.to_deg_c,
            axes: Vec::new(),
        });
        Ok(Self {
            time,
            time_unit,
            channels: channels.collect(),
            filters: Vec::new(),
            ignored: Vec::new(),
            reading: Reading::default(),
        })
    }
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

fn check_names(header: &[String]) -> Result<(), String> {
    let mut names = HashSet::new();
    let mut named = header.iter().filter(|name| !name.is_empty());
    match named.find(|name| !names.insert(name.as_str())) {
        Some(twice) => Err(format!("two columns are named `{}`", excerpt(twice))),
        None => Ok(()),
    }
}

/// Whether a header has all columns of a mapping.
fn fits(kept: &Mapping, header: &[String]) -> bool {
    let has_temps = kept.join.is_some()
        || kept
            .temp
            .iter()
            .all(|text| mapping::temp(text, header).is_ok());
    has_temps
        && kept
            .time
            .iter()
            .all(|text| mapping::time(text, header).is_ok())
        && kept
            .axis
            .iter()
            .all(|text| mapping::axis(text, header).is_ok())
        && kept
            .filter
            .iter()
            .all(|text| mapping::filter(text, header).is_ok())
}

/// What the first row has in a column, if it is a date or a time of day.
fn clock_of<'a>(signs: &'a Signs, position: usize) -> Option<&'a [u8]> {
    let cell = signs.sample.first()?.get(position)?;
    is_clock(cell).then_some(&cell[..])
}

fn find_time(signs: &Signs, text: Option<&str>) -> Result<FoundTime, String> {
    let header = signs.header;
    let found = |position: usize, unit: TimeUnit| {
        let text = format!("{}:{unit}", header[position]);
        Ok((position, unit, Some(text)))
    };
    if let Some(text) = text {
        let (position, unit) = mapping::time(text, header)?;
        let column = &header[position];
        let by_name = names::divide(column).or_else(|| column.rsplit_once('_'));
        let by_name = by_name.and_then(|(_, unit)| names::time_unit(unit));
        let by_name = by_name.or_else(|| names::time_column(column));
        let by_cells = clock_of(signs, position).map(|_| TimeUnit::Iso);
        let unit = unit.or(by_name).or(by_cells);
        if let (None, Some((_, unit))) = (unit, names::divide(column)) {
            return Err(format!(
                "`{}` has the unknown unit `{}`: expected --time COL:UNIT with UNIT s, ms, us, ns or iso",
                excerpt(column),
                excerpt(unit)
            ));
        }
        return found(position, unit.unwrap_or(TimeUnit::S));
    }
    if let Ok(position) = mapping::position(header, "time_s") {
        return Ok((position, TimeUnit::S, None));
    }
    let named = |wanted: fn(&str) -> bool| -> Vec<usize> {
        let columns = header.iter().enumerate().filter(|(_, name)| wanted(name));
        columns.map(|(position, _)| position).collect()
    };
    let several = |positions: &[usize]| {
        let names: Vec<String> = positions.iter().map(|&at| header[at].clone()).collect();
        let names = list_names(&names);
        Err(format!(
            "several columns may be the time: {names}: choose one by --time COL:UNIT"
        ))
    };
    let with_unit = named(|name| names::time_column(name).is_some());
    match with_unit[..] {
        [position] => {
            let unit = names::time_column(&header[position]).unwrap_or(TimeUnit::S);
            return found(position, unit);
        }
        [] => {}
        _ => return several(&with_unit),
    }
    let is_clock_column = |position: &usize| {
        clock_of(signs, *position).is_some_and(|cell| TimeUnit::Iso.nanoseconds(cell).is_some())
    };
    let without_unit = named(names::is_time);
    let clocks: Vec<usize> = without_unit
        .iter()
        .copied()
        .filter(is_clock_column)
        .collect();
    match clocks[..] {
        [position] => return found(position, TimeUnit::Iso),
        [] => {}
        _ => return several(&clocks),
    }
    let is_like_time = |name: &&String| names::may_be_time(name.as_bytes());
    let lead = match (without_unit.first(), header.iter().find(is_like_time)) {
        _ if header.len() == 1 => {
            "one column: columns must be separated by `,`, `;`, `|`, tabs or blanks".to_owned()
        }
        (Some(&position), _) => match clock_of(signs, position) {
            Some(cell) => format!(
                "`{}` in `{}` is not a time by ISO 8601, such as 2023-03-04T09:00:00.5",
                excerpt_of_bytes(cell),
                excerpt(&header[position])
            ),
            None => {
                let name = excerpt(&header[position]);
                format!(
                    "`{name}` has no unit: expected --time {name}:s, :ms, :us, :ns or :iso, or a \
                     unit in the name, such as `{name} [ms]`"
                )
            }
        },
        (None, Some(other)) => format!("`{}` is not in seconds by its name", excerpt(other)),
        (None, None) => "no time column".to_owned(),
    };
    Err(format!(
        "{lead}: expected `time_s` [s], or a column named by --time; there are {}",
        list_names(header)
    ))
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

fn find_temps(
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

/// An axis, and its text in a mapping unless it has a plain name.
type FoundAxis = (AxisColumn, Option<String>);

fn find_axes(header: &[String], texts: &[String]) -> Result<Vec<FoundAxis>, String> {
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

fn find_filters(
    signs: &Signs,
    texts: &[String],
    known: Option<&Known>,
) -> Result<Vec<Filter>, String> {
    let filters = texts.iter().map(|text| mapping::filter(text, signs.header));
    let mut filters = filters.collect::<Result<Vec<_>, _>>()?;
    // A log of one source: the column of sources says the same in every row.
    let source = known.and_then(|known| known.source);
    let source = source.and_then(|name| mapping::position(signs.header, name).ok());
    if let Some(position) = source
        && filters.iter().all(|filter| filter.position != position)
    {
        let cells = signs.sample.iter().filter_map(|row| row.get(position));
        let mut cells = cells.filter(|cell| !cell.is_empty());
        if let Some(first) = cells.next() {
            if let Some(other) = cells.find(|cell| *cell != first) {
                return Err(several_sources(&signs.header[position], first, other));
            }
            filters.push(Filter {
                position,
                value: first.clone(),
                is_only: true,
            });
        }
    }
    Ok(filters)
}

/// The error of a log in which several units are mixed.
pub(crate) fn several_sources(column: &str, first: &[u8], other: &[u8]) -> String {
    let (column, first) = (excerpt(column), excerpt_of_bytes(first));
    format!(
        "column `{column}` has several sources, `{first}` and `{}`: choose one by --where \
         {column}={first}",
        excerpt_of_bytes(other)
    )
}

/// Texts of temperatures in a mapping; a temperature of axes by the start of their names is given to
/// each of them.
fn texts_of(temps: &[FoundTemp], axes: &[AxisColumn]) -> Vec<String> {
    let mut texts = Vec::new();
    for temp in temps {
        match (&temp.text, &temp.owner) {
            (Some(text), Owner::Start(_)) => {
                let owned = axes.iter().filter(|axis| temp.owner.owns(&axis.name));
                texts.extend(owned.map(|axis| format!("{}={text}", axis.name)));
            }
            (Some(text), _) => texts.push(text.clone()),
            (None, _) => {}
        }
    }
    texts
}

/// Gives each axis its temperature.
fn assign(temps: Vec<FoundTemp>, axes: Vec<AxisColumn>) -> Result<Vec<ChannelColumns>, String> {
    let channel = |temp: &FoundTemp| ChannelColumns {
        column: temp.column.clone(),
        temp: temp.source,
        to_deg_c: temp.to_deg_c,
        axes: Vec::new(),
    };
    if let [one] = &temps[..]
        && one.owner == Owner::All
    {
        let channel = channel(one);
        return Ok(vec![ChannelColumns { axes, ..channel }]);
    }
    // A temperature that is named for several axes is one channel.
    let mut channels: Vec<ChannelColumns> = Vec::new();
    let mut channel_of = Vec::new();
    for temp in &temps {
        let is_same =
            |other: &ChannelColumns| other.temp == temp.source && other.to_deg_c == temp.to_deg_c;
        let place = channels.iter().position(is_same);
        channel_of.push(place.unwrap_or(channels.len()));
        if place.is_none() {
            channels.push(channel(temp));
        }
    }
    let count_of_temps = channels.len();
    for axis in axes {
        let owners = temps.iter().zip(&channel_of);
        let owners = owners.filter(|(temp, _)| temp.owner.owns(&axis.name));
        let owners: HashSet<usize> = owners.map(|(_, channel)| *channel).collect();
        match (owners.len(), owners.iter().next()) {
            (1, Some(&channel)) => channels[channel].axes.push(axis),
            _ => {
                return Err(format!(
                    "{count_of_temps} temperature columns, and it is not clear which belongs to \
                     axis `{}`: choose one for all axes by --temp COLUMN, or one per axis by \
                     --temp AXIS=COLUMN",
                    excerpt(&axis.name)
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

    fn find_with(header: &str, mapping: &Mapping) -> Result<Columns, String> {
        let header: Vec<String> = header.split(',').map(str::to_owned).collect();
        let signs = Signs {
            header: &header,
            file: "log.csv",
            preamble: &[],
            sample: &[],
        };
        Columns::find(&signs, mapping, &[], None)
    }

    fn find(header: &str) -> Result<Columns, String> {
        find_with(header, &Mapping::default())
    }

    fn names(columns: &Columns) -> Vec<Vec<&str>> {
        let name = |axis: &AxisColumn| axis.name.clone().leak() as &str;
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
        assert_eq!(columns.channels[0].axes[1].unit, ColumnUnit::Pulses);
        assert_eq!(columns.ignored, ["baro_temp_c", "mx_cnt", "note"]);
    }

    #[test]
    fn temperatures_per_axis_go_to_their_axes() {
        let columns = find("time_s,temp_x_c,temp_y_c,gx_dps,gy_dps,ax_g,ay_g").unwrap();
        assert_eq!(names(&columns), [["gx", "ax"], ["gy", "ay"]]);
        assert_eq!(columns.channels[1].temp, TempSource::Column(2));
    }

    #[test]
    fn what_is_unclear_is_refused_with_what_was_expected() {
        for (header, part) in [
            ("time_min,temp_c,x_dps", "`time_min` is not in seconds"),
            (
                "t,temp_c,x_dps",
                "`t` has no unit: expected --time t:s, :ms, :us",
            ),
            (
                "Time,temp_c,x_dps",
                "`Time` has no unit: expected --time Time:s",
            ),
            (
                "Time [ms],time_us,temp_c,x_dps",
                "`Time [ms]`, `time_us`: choose one by --time",
            ),
            (
                "time_s,Temp,x_dps",
                "`Temp` has no unit: expected --temp Temp:degc, :degf or :k",
            ),
            (
                "time_s,temp_c,Gyro X [rpm]",
                "`Gyro X [rpm]` has the unknown unit `rpm`",
            ),
            ("time_s,temp_c,GyX,GyY", "--axis \"gyx=GyX:UNIT\""),
            ("time_s,temp_c,Weight [g]", "no axis column"),
            (
                "time_s,temp_c,Gyro X [dps],gyro_x (dps)",
                "two axes are named `gyro_x`",
            ),
            ("time_s;temp_c;x_dps", "columns must be separated by"),
            ("time_s,x_dps", "no temperature column"),
            ("time_s,temp_r,x_dps", "`temp_r` is not in degC"),
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
    fn units_in_names_are_read() {
        let columns =
            find("Zeit [s],Temperatur [\u{b0}C],Gyro X [\u{b0}/s],Gyro Y (deg/s)").unwrap();
        assert_eq!(names(&columns), [["gyro_x", "gyro_y"]]);
        let mapping = columns.reading.mapping.unwrap();
        assert_eq!(mapping.time.as_deref(), Some("Zeit [s]:s"));
        assert_eq!(mapping.temp, ["Temperatur [\u{b0}C]:degc"]);
        assert_eq!(mapping.axis[0], "gyro_x=Gyro X [\u{b0}/s]");
        let columns = find("millis,temp_k,x_dps").unwrap();
        assert_eq!(columns.time_unit, TimeUnit::Ms);
        assert_eq!(columns.channels[0].to_deg_c, names::TempUnit::K.to_deg_c());
        assert!(
            find("time_s,temp_c,x_dps,Gyro X [rpm],T [K]")
                .unwrap()
                .reading
                .is_plain()
        );
    }

    #[test]
    fn temperatures_by_the_start_of_names_are_channels() {
        let columns = find("time_s,imu0_temp_c,imu0_gx_dps,imu1_temp_c,imu1_gx_dps").unwrap();
        assert_eq!(names(&columns), [["imu0_gx"], ["imu1_gx"]]);
        let mapping = columns.reading.mapping.unwrap();
        assert_eq!(
            mapping.temp,
            ["imu0_gx=imu0_temp_c:degc", "imu1_gx=imu1_temp_c:degc"]
        );
        let header = "time_s,imu0_temp_c,imu0_gx_dps,imu1_temp_c,imu1_gx_dps";
        let again = find_with(header, &mapping).unwrap();
        assert_eq!(again.channels, columns.channels);
    }

    #[test]
    fn a_mapping_overrules_the_names() {
        let mapping = Mapping {
            time: Some("t".to_owned()),
            temp: vec!["x=T2".to_owned(), "y=T1".to_owned()],
            axis: vec!["x=wx:dps".to_owned(), "y=wy:dps".to_owned()],
            ..Mapping::default()
        };
        let columns = find_with("t,T1,T2,wx,wy", &mapping).unwrap();
        let temp = columns.channels[0].temp;
        assert_eq!((columns.time, temp), (0, TempSource::Column(2)));
        assert_eq!(names(&columns), [["x"], ["y"]]);
        let missing = Mapping {
            time: Some("time".to_owned()),
            ..mapping
        };
        let error = find_with("t,T1,T2,wx,wy", &missing).unwrap_err();
        assert!(error.contains("no column `time`"), "{error}");
    }
}
