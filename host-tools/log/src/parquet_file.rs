//! What is read of a Parquet file besides its rows in turn.

use std::path::Path;
use std::sync::Arc;

use parquet::column::reader::{ColumnReader, get_column_reader};
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::schema::types::ColumnDescPtr;

use super::LogError;
use super::pages::{BoundedFile, Pages, TooLarge};
use super::parquet_columns as columns;
use super::time_types::TimeType;

/// Rows whose cells say what the columns hold.
const SAMPLE_ROWS: usize = 20;

/// The error of a file that is not sound.
pub(super) fn refused(path: &Path, cause: &ParquetError) -> LogError {
    let message = match cause {
        ParquetError::External(cause) if cause.is::<TooLarge>() => cause.to_string(),
        ParquetError::NYI(what) => what.clone(),
        _ => format!("not a sound Parquet file (was it cut off?): {cause}"),
    };
    LogError::file(path, message)
}

/// The reader of a column in a group of rows.
pub(super) fn open(
    file: &Arc<BoundedFile>,
    metadata: &ParquetMetaData,
    group: usize,
    position: usize,
) -> Result<(ColumnDescPtr, ColumnReader), ParquetError> {
    let column = metadata.file_metadata().schema_descr().column(position);
    let group = metadata.row_group(group);
    let rows = usize::try_from(group.num_rows())?;
    let pages = Pages::new(file, group.column(position), rows)?;
    let reader = get_column_reader(Arc::clone(&column), Box::new(pages));
    Ok((column, reader))
}

/// The cells of the first rows as text; empty where a column holds times by its type, lists, or
/// nothing that is text.
pub(super) fn sample(
    file: &Arc<BoundedFile>,
    metadata: &ParquetMetaData,
    times: &[Option<TimeType>],
) -> Result<Vec<Vec<Vec<u8>>>, ParquetError> {
    let group = metadata
        .row_groups()
        .iter()
        .position(|of| of.num_rows() > 0);
    let Some(group) = group else {
        return Ok(Vec::new());
    };
    let rows = usize::try_from(metadata.row_group(group).num_rows())?.min(SAMPLE_ROWS);
    let mut sample = vec![vec![Vec::new(); times.len()]; rows];
    for position in (0..times.len()).filter(|&position| times[position].is_none()) {
        let (column, reader) = open(file, metadata, group, position)?;
        let Some(mut texts) = columns::texts(&column, reader) else {
            continue;
        };
        texts.read(rows)?;
        for (row, text) in sample.iter_mut().zip(texts.values) {
            row[position] = text.unwrap_or_default();
        }
    }
    Ok(sample)
}
