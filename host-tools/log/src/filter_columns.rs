//! Columns by which rows are chosen.

use std::collections::BTreeSet;

use super::excerpt::{excerpt, excerpt_of_bytes};
use super::known::Signs;
use super::mapping::{self, Filter};

pub(crate) const NO_INSTANCES: &str = "--instance: no column numbers the sources: expected a log of PX4 (.ulg) \
     or ArduPilot; choose rows by --where COL=VALUE";

/// Sources of which none was chosen, and what to do.
pub(crate) type Several = (Vec<u32>, String);

/// The filters that are named, and the one that a known layout needs: the column of its sources.
pub(crate) fn find_filters(
    signs: &Signs,
    texts: &[String],
    source: Option<usize>,
    instance: Option<u32>,
) -> Result<(Vec<Filter>, Option<Several>), String> {
    let filters = texts.iter().map(|text| mapping::filter(text, signs.header));
    let mut filters = filters.collect::<Result<Vec<_>, _>>()?;
    let Some(position) = source.filter(|_| !signs.has_instances) else {
        return Ok((filters, None));
    };
    let is_chosen = filters.iter().any(|filter| filter.position == position);
    if let Some(instance) = instance {
        let value = instance.to_string().into_bytes();
        if filters
            .iter()
            .any(|filter| filter.position == position && filter.value != value)
        {
            return Err("--instance and --where choose different sources: expected one".to_owned());
        }
        filters.push(Filter {
            position,
            value,
            is_only: false,
        });
        return Ok((filters, None));
    }
    // A log of one source: the column of sources says the same in every row.
    let cells = signs.sample.iter().filter_map(|row| row.get(position));
    let mut cells = cells.filter(|cell| !cell.is_empty()).filter(|_| !is_chosen);
    let Some(first) = cells.next() else {
        return Ok((filters, None));
    };
    let mut others = cells.clone().filter(|cell| *cell != first);
    if let Some(other) = others.next() {
        let message = several_sources(&signs.header[position], first, other);
        let number = |cell: &Vec<u8>| str::from_utf8(cell).ok()?.parse::<u32>().ok();
        let numbers = std::iter::once(first).chain(cells).map(number);
        let numbers = numbers.collect::<Option<BTreeSet<u32>>>();
        let numbers = numbers.ok_or_else(|| message.clone())?;
        return Ok((filters, Some((numbers.into_iter().collect(), message))));
    }
    filters.push(Filter {
        position,
        value: first.clone(),
        is_only: true,
    });
    Ok((filters, None))
}

/// The error of a log in which several units are mixed.
pub(crate) fn several_sources(column: &str, first: &[u8], other: &[u8]) -> String {
    let (column, first) = (excerpt(column), excerpt_of_bytes(first));
    format!(
        "column `{column}` has several sources, `{first}` and `{}`: choose one by --instance, or \
         by --where {column}={first}",
        excerpt_of_bytes(other)
    )
}
