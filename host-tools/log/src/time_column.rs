//! The column with the time, and its unit.

use super::dialect::is_clock;
use super::excerpt::{excerpt, excerpt_of_bytes, list_names};
use super::known::Signs;
use super::mapping;
use super::names;
use super::time::TimeUnit;

/// A time column, its unit, and its text in a mapping unless it has the plain name.
pub(crate) type FoundTime = (usize, TimeUnit, Option<String>);

/// What the first row has in a column, if it is a date or a time of day.
fn clock_of<'a>(signs: &'a Signs, position: usize) -> Option<&'a [u8]> {
    let cell = signs.sample.first()?.get(position)?;
    is_clock(cell).then_some(&cell[..])
}

pub(crate) fn find_time(signs: &Signs, text: Option<&str>) -> Result<FoundTime, String> {
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
