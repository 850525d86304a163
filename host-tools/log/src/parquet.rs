//! Rows of a Parquet file.

use std::fs::File;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};

use parquet::basic::{ConvertedType, LogicalType, Type as PhysicalType};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::schema::types::ColumnDescriptor;

use super::LogError;
use super::excerpt::excerpt;
use super::layout::{Finder, Found, Layout, RowKind};
use super::mapping::Mapping;
use super::order::{Bad, Parsed};
use super::pages::{BoundedFile, LARGEST_PAGE, Pages, TooLarge};
use super::row_numbers::RowNumbers;
use super::skipped::{Reason, SkippedRows};
use super::slot::{Conversion, Kind};
use super::source::Source;
use super::time::TimeUnit;
use super::time_types::{TimeType, time_types};

/// The rows of a Parquet file, some at a time.
pub(super) struct ParquetRows {
    file: Arc<BoundedFile>,
    metadata: ParquetMetaData,
    layout: Arc<Layout>,
    /// How the time column becomes seconds, if its type says it.
    time: Option<TimeType>,
    /// The first point in time, if the time column holds such.
    origin: Arc<OnceLock<i64>>,
    skip_bad_rows: bool,
    rows_at_a_time: usize,
    /// The next group of rows.
    group: usize,
    /// Rows of the open group that were not yet read.
    rows_left: usize,
    /// For each slot, the reader of its column in the open group.
    readers: Vec<Column>,
    /// Rows read so far.
    row: u64,
    /// A second reader of the file, since its rows are not read from front to end.
    digest: Option<JoinHandle<std::io::Result<String>>>,
}

impl ParquetRows {
    /// Reads the header.
    ///
    /// # Errors
    /// A file that is not sound, columns that do not name time, temperature and axes, columns that
    /// hold no numbers. The time column may hold timestamps, times of day or durations; the only
    /// such column needs no name that says so.
    pub(super) fn open(
        source: Source,
        finder: &Finder,
        skip_bad_rows: bool,
        rows_at_a_time: usize,
    ) -> Result<(Self, Arc<Layout>), LogError> {
        let path = finder.path;
        let file = File::open(path).map_err(LogError::io(path))?;
        let file = BoundedFile::new(file, LARGEST_PAGE);
        let metadata = ParquetMetaDataReader::new().parse_and_finish(&file);
        let metadata = metadata.map_err(|cause| refused(path, &cause))?;
        let schema = metadata.file_metadata().schema_descr();
        let header = schema.columns().iter().map(|column| column.path().string());
        let refused = |message: String| LogError::file(path, message);
        let found = Found {
            preamble: &[],
            sample: &[],
            row_kind: RowKind::Row,
        };
        let header: Vec<String> = header.collect();
        // The type of a time column says more than its name.
        let types = time_types(metadata.file_metadata());
        let mut timed = types.iter().zip(&header).filter(|(time, _)| time.is_some());
        let mapping = match (&finder.mapping.time, timed.next(), timed.next()) {
            (None, Some((_, name)), None) => Mapping {
                time: Some(format!("{name}:s")),
                ..finder.mapping.clone()
            },
            _ => finder.mapping.clone(),
        };
        let finder = Finder {
            mapping: &mapping,
            ..finder.clone()
        };
        let mut layout = Layout::new(header, &found, &finder).map_err(refused)?;
        let time = types[layout.columns.time];
        if time.is_some() {
            layout.columns.time_unit = TimeUnit::S;
            layout.slots[0].conversion = Conversion::None;
        }
        if !layout.columns.filters.is_empty() || layout.columns.time_unit == TimeUnit::Iso {
            let message = "--where and clock times: expected a log as text, such as CSV";
            return Err(refused(message.to_owned()));
        }
        if let Some(joined) = &mut layout.joined {
            joined
                .align(layout.columns.time_unit, None)
                .map_err(refused)?;
        }
        for slot in &layout.slots {
            let column = schema.column(slot.position);
            let is_time = slot.kind == Kind::Time && time.is_some();
            if let Some(found) = no_number(&column).filter(|_| !is_time) {
                let name = excerpt(&layout.header[slot.position]);
                return Err(LogError::file(
                    path,
                    format!("column `{name}` holds {found}: expected floats or integers"),
                ));
            }
        }
        let layout = Arc::new(layout);
        let rows = Self {
            file: Arc::new(file),
            metadata,
            layout: Arc::clone(&layout),
            time,
            origin: Arc::default(),
            skip_bad_rows,
            rows_at_a_time,
            group: 0,
            rows_left: 0,
            readers: Vec::new(),
            row: 0,
            digest: Some(thread::spawn(move || source.text()?.sha256())),
        };
        Ok((rows, layout))
    }

    /// The next rows, or the hash of the file at its end.
    ///
    /// # Errors
    /// A file that is not sound.
    pub(super) fn next(&mut self) -> Result<Result<Parsed, String>, LogError> {
        let layout = Arc::clone(&self.layout);
        let failed = |cause: ParquetError| refused(&layout.path, &cause);
        while self.rows_left == 0 {
            if self.group == self.metadata.num_row_groups() {
                let digest = self.digest.take().expect("a log ends once").join();
                let digest = digest.expect("hashing cannot panic");
                return Ok(Err(digest.map_err(LogError::io(&layout.path))?));
            }
            self.open_group().map_err(failed)?;
        }
        let rows = self.rows_left.min(self.rows_at_a_time);
        for reader in &mut self.readers {
            if reader.read(rows).map_err(failed)? != rows {
                let message = "not a sound Parquet file: columns of different lengths";
                return Err(LogError::file(&layout.path, message));
            }
        }
        self.rows_left -= rows;
        let parsed = self.checked(rows);
        self.row += rows as u64;
        Ok(Ok(parsed))
    }

    fn open_group(&mut self) -> Result<(), ParquetError> {
        let group = self.metadata.row_group(self.group);
        let schema = self.metadata.file_metadata().schema_descr();
        let rows = usize::try_from(group.num_rows())?;
        self.readers = self
            .layout
            .slots
            .iter()
            .map(|slot| {
                let column = schema.column(slot.position);
                let pages = Pages::new(&self.file, group.column(slot.position), rows)?;
                let reader = get_column_reader(Arc::clone(&column), Box::new(pages));
                let time = self.time.filter(|_| slot.kind == Kind::Time);
                Ok(Column::new(&column, reader, time, &self.origin))
            })
            .collect::<Result<_, ParquetError>>()?;
        self.rows_left = rows;
        self.group += 1;
        Ok(())
    }

    /// Checks the rows that were just read.
    fn checked(&mut self, rows: usize) -> Parsed {
        let mut parsed = Parsed {
            chunk: self.layout.chunk(rows),
            numbers: RowNumbers::default(),
            has_blanks: false,
            skipped: SkippedRows::default(),
            bad: None,
        };
        let mut values = vec![0.0; self.readers.len()];
        for row in 0..rows {
            match self.row(row, &mut values) {
                Ok(()) => {
                    parsed.has_blanks |= values.iter().any(|value| value.is_nan());
                    self.layout.push(&mut parsed.chunk, &values);
                    parsed.numbers.push(self.row + 1 + row as u64);
                }
                Err(bad) if self.skip_bad_rows => parsed.skipped.count(bad.reason),
                Err(bad) => {
                    parsed.bad = Some(*bad);
                    break;
                }
            }
        }
        parsed
    }

    fn row(&self, row: usize, values: &mut [f64]) -> Result<(), Box<Bad>> {
        let mut time_s = None;
        for ((slot, reader), value) in self.layout.slots.iter().zip(&self.readers).zip(values) {
            let objection = match reader.values[row] {
                // A blank temperature: the last one may be held.
                None if matches!(slot.kind, Kind::Temp(_)) => {
                    *value = f64::NAN;
                    None
                }
                None => Some((
                    Reason::EmptyCell,
                    "null: expected a finite number".to_owned(),
                )),
                Some(found) if !found.is_finite() => {
                    let message = format!("`{found}`: expected a finite number");
                    Some((Reason::NotANumber, message))
                }
                Some(found) => {
                    *value = slot.conversion.of(found);
                    let objection = Layout::objection(slot.kind, *value);
                    objection.map(|message| (Reason::OutOfRange, message))
                }
            };
            if let Some((reason, message)) = objection {
                let number = self.row + 1 + row as u64;
                return Err(Box::new(Bad {
                    number,
                    time_s,
                    reason,
                    error: self.layout.cell_error(number, slot.position, message),
                    is_fatal: false,
                }));
            }
            time_s.get_or_insert(*value);
        }
        Ok(())
    }
}

fn refused(path: &Path, cause: &ParquetError) -> LogError {
    let message = match cause {
        ParquetError::External(cause) if cause.is::<TooLarge>() => cause.to_string(),
        ParquetError::NYI(what) => what.clone(),
        _ => format!("not a sound Parquet file (was it cut off?): {cause}"),
    };
    LogError::file(path, message)
}

/// What a column holds, if that is not plain numbers.
fn no_number(column: &ColumnDescriptor) -> Option<String> {
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

/// A column of a group of rows.
struct Column {
    reader: Box<dyn ReadValues>,
    /// The rows read last; `None` is a null.
    values: Vec<Option<f64>>,
}

impl Column {
    /// Values as they are; seconds of a `time`, since `origin` if it is a point in time.
    fn new(
        column: &ColumnDescriptor,
        reader: ColumnReader,
        time: Option<TimeType>,
        origin: &Arc<OnceLock<i64>>,
    ) -> Self {
        let can_be_null = column.max_def_level() > 0;
        let is_unsigned = matches!(
            column.converted_type(),
            ConvertedType::UINT_8
                | ConvertedType::UINT_16
                | ConvertedType::UINT_32
                | ConvertedType::UINT_64
        );
        let origin = Arc::clone(origin);
        let seconds = move |value: i64, time: TimeType| {
            let since = match time.is_instant {
                true => value.wrapping_sub(*origin.get_or_init(|| value)),
                false => value,
            };
            since as f64 / time.per_second as f64
        };
        let reader: Box<dyn ReadValues> = match (reader, is_unsigned) {
            (ColumnReader::Int64ColumnReader(r), _) if let Some(time) = time => {
                typed(r, can_be_null, move |value| seconds(value, time))
            }
            (ColumnReader::Int32ColumnReader(r), _) if let Some(time) = time => {
                typed(r, can_be_null, move |value| seconds(value.into(), time))
            }
            (ColumnReader::FloatColumnReader(r), _) => typed(r, can_be_null, f64::from),
            (ColumnReader::DoubleColumnReader(r), _) => typed(r, can_be_null, |value| value),
            (ColumnReader::Int32ColumnReader(r), false) => typed(r, can_be_null, f64::from),
            (ColumnReader::Int32ColumnReader(r), true) => {
                typed(r, can_be_null, |value| f64::from(value as u32))
            }
            (ColumnReader::Int64ColumnReader(r), false) => {
                typed(r, can_be_null, |value| value as f64)
            }
            (ColumnReader::Int64ColumnReader(r), true) => {
                typed(r, can_be_null, |value| value as u64 as f64)
            }
            _ => unreachable!("columns were checked to hold numbers"),
        };
        Self {
            reader,
            values: Vec::new(),
        }
    }

    /// Reads the next rows; returns how many there were.
    fn read(&mut self, rows: usize) -> Result<usize, ParquetError> {
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

/// Reads values of any type as doubles.
trait ReadValues: Send {
    /// Appends at most `rows` rows; returns how many.
    fn read(&mut self, rows: usize, values: &mut Vec<Option<f64>>) -> Result<usize, ParquetError>;
}

struct Typed<T: DataType> {
    reader: ColumnReaderImpl<T>,
    can_be_null: bool,
    to_f64: Box<dyn Fn(T::T) -> f64 + Send>,
    levels: Vec<i16>,
    present: Vec<T::T>,
}

fn typed<T: DataType>(
    reader: ColumnReaderImpl<T>,
    can_be_null: bool,
    to_f64: impl Fn(T::T) -> f64 + Send + 'static,
) -> Box<dyn ReadValues>
where
    Typed<T>: ReadValues + 'static,
{
    Box::new(Typed {
        reader,
        can_be_null,
        to_f64: Box::new(to_f64),
        levels: Vec::new(),
        present: Vec::new(),
    })
}

impl<T: DataType> ReadValues for Typed<T>
where
    T::T: Copy,
    ColumnReaderImpl<T>: Send,
{
    fn read(&mut self, rows: usize, values: &mut Vec<Option<f64>>) -> Result<usize, ParquetError> {
        self.levels.clear();
        self.present.clear();
        let levels = self.can_be_null.then_some(&mut self.levels);
        let (read, ..) = self
            .reader
            .read_records(rows, levels, None, &mut self.present)?;
        let mut present = self.present.iter().map(|&value| (self.to_f64)(value));
        if self.can_be_null {
            let levels = self.levels.iter();
            values.extend(levels.map(|&level| if level == 0 { None } else { present.next() }));
        } else {
            values.extend(present.map(Some));
        }
        Ok(read)
    }
}
