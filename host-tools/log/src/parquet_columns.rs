//! Columns of a Parquet file: what they hold, and their values as numbers or text.

use std::sync::{Arc, OnceLock};

use parquet::basic::{ConvertedType, LogicalType, Type as PhysicalType};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::schema::types::ColumnDescriptor;

use super::time::TimeUnit;
use super::time_types::TimeType;

/// What a column holds, if that is not plain numbers.
pub(super) fn no_number(column: &ColumnDescriptor) -> Option<String> {
    if column.path().parts().len() > 1 || column.max_rep_level() > 0 {
        return Some("lists or structures".to_owned());
    }
    let logical = column.logical_type_ref();
    match (column.physical_type(), logical, column.converted_type()) {
        (PhysicalType::FLOAT | PhysicalType::DOUBLE, ..) => None,
        (
            PhysicalType::INT32 | PhysicalType::INT64,
            None | Some(LogicalType::Integer { .. }),
            ConvertedType::NONE
            | ConvertedType::INT_8
            | ConvertedType::INT_16
            | ConvertedType::INT_32
            | ConvertedType::INT_64
            | ConvertedType::UINT_8
            | ConvertedType::UINT_16
            | ConvertedType::UINT_32
            | ConvertedType::UINT_64,
        ) => None,
        (_, Some(logical), _) => Some(format!("values of the type {logical:?}")),
        (physical, ..) => Some(format!("values of the type {physical}")),
    }
}

/// Whether a column holds text.
pub(super) fn is_text(column: &ColumnDescriptor) -> bool {
    let is_string = match (column.logical_type_ref(), column.converted_type()) {
        (Some(logical), _) => matches!(logical, LogicalType::String | LogicalType::Enum),
        (None, converted) => matches!(
            converted,
            ConvertedType::UTF8 | ConvertedType::ENUM | ConvertedType::NONE
        ),
    };
    is_flat(column) && column.physical_type() == PhysicalType::BYTE_ARRAY && is_string
}

pub(super) fn is_flat(column: &ColumnDescriptor) -> bool {
    column.path().parts().len() == 1 && column.max_rep_level() == 0
}

pub(super) fn is_unsigned(column: &ColumnDescriptor) -> bool {
    matches!(
        column.converted_type(),
        ConvertedType::UINT_8
            | ConvertedType::UINT_16
            | ConvertedType::UINT_32
            | ConvertedType::UINT_64
    )
}

/// Where points in time count from: the first one.
#[derive(Clone, Default)]
pub(super) struct Origin(Arc<OnceLock<i128>>);

impl Origin {
    /// At a time that is known, or else at the first that is asked for.
    pub(super) fn new(known: Option<i128>) -> Self {
        Self(Arc::new(known.map_or_else(OnceLock::new, OnceLock::from)))
    }

    fn since(&self, time: i128) -> f64 {
        (time - *self.0.get_or_init(|| time)) as f64
    }
}

/// A column of a group of rows.
pub(super) struct Column<V> {
    reader: Box<dyn ReadValues<V>>,
    /// The rows read last; `None` is a null.
    pub(super) values: Vec<Option<V>>,
}

impl<V> Column<V> {
    /// Reads the next rows; returns how many there were.
    pub(super) fn read(&mut self, rows: usize) -> Result<usize, ParquetError> {
        self.values.clear();
        while self.values.len() < rows {
            let wanted = rows - self.values.len();
            if self.reader.read(wanted, &mut self.values)? == 0 {
                break;
            }
        }
        Ok(self.values.len())
    }
}

/// The numbers of a column that holds such.
pub(super) fn numbers(column: &ColumnDescriptor, reader: ColumnReader) -> Column<f64> {
    match (reader, is_unsigned(column)) {
        (ColumnReader::FloatColumnReader(r), _) => typed(column, r, |&v| f64::from(v)),
        (ColumnReader::DoubleColumnReader(r), _) => typed(column, r, |&v| v),
        (ColumnReader::Int32ColumnReader(r), false) => typed(column, r, |&v| f64::from(v)),
        (ColumnReader::Int32ColumnReader(r), true) => typed(column, r, |&v| f64::from(v as u32)),
        (ColumnReader::Int64ColumnReader(r), false) => typed(column, r, |&v| v as f64),
        (ColumnReader::Int64ColumnReader(r), true) => typed(column, r, |&v| v as u64 as f64),
        _ => unreachable!("columns were checked to hold numbers"),
    }
}

/// The times of a column: seconds by its type, or by its text, NaN where that is no time; else its
/// numbers.
pub(super) fn times(
    column: &ColumnDescriptor,
    reader: ColumnReader,
    time: Option<TimeType>,
    origin: &Origin,
) -> Column<f64> {
    let since = origin.clone();
    let seconds = move |value: i64, time: TimeType| {
        let since = match time.is_instant {
            true => since.since(value.into()),
            false => value as f64,
        };
        since / time.per_second as f64
    };
    match (reader, time) {
        (ColumnReader::Int64ColumnReader(r), Some(time)) => {
            typed(column, r, move |&v| seconds(v, time))
        }
        (ColumnReader::Int32ColumnReader(r), Some(time)) => {
            typed(column, r, move |&v| seconds(v.into(), time))
        }
        (ColumnReader::ByteArrayColumnReader(r), _) => {
            let origin = origin.clone();
            typed(column, r, move |v: &ByteArray| {
                let time_ns = TimeUnit::Iso.nanoseconds(v.data());
                time_ns.map_or(f64::NAN, |time_ns| origin.since(time_ns) / 1e9)
            })
        }
        (reader, _) => numbers(column, reader),
    }
}

/// The values of a column as text; none of a column that holds lists or bytes.
pub(super) fn texts(column: &ColumnDescriptor, reader: ColumnReader) -> Option<Column<Vec<u8>>> {
    let text = |text: String| text.into_bytes();
    Some(match reader {
        _ if !is_flat(column) => return None,
        ColumnReader::ByteArrayColumnReader(r) if is_text(column) => {
            typed(column, r, |v: &ByteArray| v.data().trim_ascii().to_vec())
        }
        ColumnReader::BoolColumnReader(r) => typed(column, r, move |v| text(v.to_string())),
        _ if no_number(column).is_some() => return None,
        ColumnReader::Int32ColumnReader(r) if is_unsigned(column) => {
            typed(column, r, move |&v| text((v as u32).to_string()))
        }
        ColumnReader::Int32ColumnReader(r) => typed(column, r, move |v| text(v.to_string())),
        ColumnReader::Int64ColumnReader(r) if is_unsigned(column) => {
            typed(column, r, move |&v| text((v as u64).to_string()))
        }
        ColumnReader::Int64ColumnReader(r) => typed(column, r, move |v| text(v.to_string())),
        ColumnReader::FloatColumnReader(r) => typed(column, r, move |v| text(v.to_string())),
        ColumnReader::DoubleColumnReader(r) => typed(column, r, move |v| text(v.to_string())),
        _ => return None,
    })
}

/// Reads values of any type as something else.
pub(super) trait ReadValues<V>: Send {
    /// Appends at most `rows` rows; returns how many.
    fn read(&mut self, rows: usize, values: &mut Vec<Option<V>>) -> Result<usize, ParquetError>;
}

pub(super) struct Typed<T: DataType, F> {
    reader: ColumnReaderImpl<T>,
    can_be_null: bool,
    convert: F,
    levels: Vec<i16>,
    present: Vec<T::T>,
}

pub(super) fn typed<T: DataType + 'static, V, F: Fn(&T::T) -> V + Send + 'static>(
    column: &ColumnDescriptor,
    reader: ColumnReaderImpl<T>,
    convert: F,
) -> Column<V>
where
    ColumnReaderImpl<T>: Send,
{
    Column {
        reader: Box::new(Typed {
            reader,
            can_be_null: column.max_def_level() > 0,
            convert,
            levels: Vec::new(),
            present: Vec::new(),
        }),
        values: Vec::new(),
    }
}

impl<T: DataType, V, F: Fn(&T::T) -> V + Send> ReadValues<V> for Typed<T, F>
where
    ColumnReaderImpl<T>: Send,
{
    fn read(&mut self, rows: usize, values: &mut Vec<Option<V>>) -> Result<usize, ParquetError> {
        self.levels.clear();
        self.present.clear();
        let levels = self.can_be_null.then_some(&mut self.levels);
        let (read, ..) = self
            .reader
            .read_records(rows, levels, None, &mut self.present)?;
        let mut present = self.present.iter().map(&self.convert);
        if self.can_be_null {
            let levels = self.levels.iter();
            values.extend(levels.map(|&level| if level == 0 { None } else { present.next() }));
        } else {
            values.extend(present.map(Some));
        }
        Ok(read)
    }
}
