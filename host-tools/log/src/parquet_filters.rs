//! Columns of a Parquet file by which rows are chosen.

use std::sync::{Arc, OnceLock};

use parquet::basic::Type as PhysicalType;
use parquet::column::reader::ColumnReader;
use parquet::data_type::ByteArray;
use parquet::schema::types::ColumnDescriptor;

use super::decimal;
use super::excerpt::excerpt_of_bytes;
use super::parquet_columns::{Column, is_flat, is_text, is_unsigned, no_number, typed};

/// What a filter wants of a column.
pub(super) enum Wanted {
    Text(Vec<u8>),
    /// A number, and the same if it is whole.
    Number(f64, Option<i128>),
}

impl Wanted {
    /// Of a column.
    ///
    /// # Errors
    /// No number for a column of numbers; a column of neither numbers nor text.
    pub(super) fn new(column: &ColumnDescriptor, value: &[u8]) -> Result<Self, String> {
        let is_bool = is_flat(column) && column.physical_type() == PhysicalType::BOOLEAN;
        if is_text(column) || is_bool {
            return Ok(Self::Text(value.to_vec()));
        }
        if let Some(found) = no_number(column) {
            return Err(format!("holds {found}: expected text, floats or integers"));
        }
        let number = decimal::parse(value).ok_or_else(|| {
            format!(
                "holds numbers: expected one instead of `{}`",
                excerpt_of_bytes(value)
            )
        })?;
        let whole = str::from_utf8(value).ok();
        Ok(Self::Number(
            number,
            whole.and_then(|text| text.parse().ok()),
        ))
    }

    fn is_whole(&self, value: i128) -> bool {
        match self {
            Self::Text(_) => false,
            Self::Number(_, Some(whole)) => value == *whole,
            Self::Number(number, None) => value as f64 == *number,
        }
    }

    fn is_number(&self, value: f64) -> bool {
        matches!(self, Self::Number(number, _) if value == *number)
    }

    fn is_text(&self, value: &[u8]) -> bool {
        matches!(self, Self::Text(text) if value == text)
    }
}

/// Whether the values of a column are what is wanted; the first that is not is kept in `other`.
pub(super) fn matches(
    column: &ColumnDescriptor,
    reader: ColumnReader,
    wanted: &Arc<Wanted>,
    other: &Arc<OnceLock<Vec<u8>>>,
) -> Column<bool> {
    let (wanted, other) = (Arc::clone(wanted), Arc::clone(other));
    let keep = move |is_wanted: bool, text: &dyn Fn() -> Vec<u8>| {
        if !is_wanted && other.get().is_none() {
            let _ = other.set(text());
        }
        is_wanted
    };
    match (reader, is_unsigned(column)) {
        (ColumnReader::ByteArrayColumnReader(r), _) => typed(column, r, move |v: &ByteArray| {
            let text = v.data().trim_ascii();
            keep(wanted.is_text(text), &|| text.to_vec())
        }),
        (ColumnReader::BoolColumnReader(r), _) => typed(column, r, move |v| {
            let text = v.to_string().into_bytes();
            keep(wanted.is_text(&text), &|| text.clone())
        }),
        (ColumnReader::Int32ColumnReader(r), is_unsigned) => typed(column, r, move |&v| {
            let value = if is_unsigned {
                i128::from(v as u32)
            } else {
                v.into()
            };
            keep(wanted.is_whole(value), &|| value.to_string().into_bytes())
        }),
        (ColumnReader::Int64ColumnReader(r), is_unsigned) => typed(column, r, move |&v| {
            let value = if is_unsigned {
                i128::from(v as u64)
            } else {
                v.into()
            };
            keep(wanted.is_whole(value), &|| value.to_string().into_bytes())
        }),
        (ColumnReader::FloatColumnReader(r), _) => typed(column, r, move |&v| {
            // As the text of the value says it, not as a double holds it.
            let text = v.to_string();
            let is_wanted = text.parse().is_ok_and(|value| wanted.is_number(value));
            keep(is_wanted, &|| text.clone().into_bytes())
        }),
        (ColumnReader::DoubleColumnReader(r), _) => typed(column, r, move |&v| {
            keep(wanted.is_number(v), &|| v.to_string().into_bytes())
        }),
        _ => unreachable!("columns were checked to hold text or numbers"),
    }
}
