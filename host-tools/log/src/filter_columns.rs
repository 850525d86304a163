//! Columns by which rows are chosen.

use super::excerpt::{excerpt, excerpt_of_bytes};
use super::known::{Known, Signs};
use super::mapping::{self, Filter};

/// The filters that are named, and the one that a known layout needs.
pub(crate) fn find_filters(
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
