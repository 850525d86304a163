//! Rows of a Parquet file.

use std::fs::File;
use std::io;
use std::sync::{Arc, OnceLock};

use parquet::errors::ParquetError;
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};

use super::LogError;
use super::chunk::Chunk;
use super::excerpt::excerpt;
use super::filter_columns::several_sources;
use super::layout::{Finder, Found, Layout, RowKind};
use super::mapping::{Filter, Mapping};
use super::order::{Bad, Parsed};
use super::pages::{BoundedFile, LARGEST_PAGE};
use super::parallel::{Ahead, Part, Parts, later};
use super::parquet_columns::{self as columns, Column, Origin};
use super::parquet_file::{self, refused};
use super::parquet_filters::{self as filters, Wanted};
use super::skipped::Reason;
use super::slot::{Conversion, Kind, Slot};
use super::source::Source;
use super::time::TimeUnit;
use super::time_types::{TimeType, time_types};

/// Parts that are read ahead of those that are in use.
const PARTS_AHEAD: usize = 2;

/// The rows of a Parquet file, some at a time.
pub(super) struct ParquetRows {
    file: Arc<BoundedFile>,
    metadata: ParquetMetaData,
    layout: Arc<Layout>,
    /// How the time column becomes seconds, if its type says it.
    time: Option<TimeType>,
    /// The first point in time, if the time column holds such.
    origin: Origin,
    /// What is wanted of the column of each filter.
    wanted: Vec<Arc<Wanted>>,
    skip_bad_rows: bool,
    rows_at_a_time: usize,
    /// The next group of rows.
    group: usize,
    /// Rows of the open group that were not yet read.
    rows_left: usize,
    /// For each slot, the reader of its column in the open group.
    readers: Vec<Column<f64>>,
    /// For each filter, the same.
    filters: Vec<Column<bool>>,
    /// The first cell of another source than the one that is wanted.
    other_source: Arc<OnceLock<Vec<u8>>>,
    /// Rows read so far.
    row: u64,
    /// A second reader of the file, since its rows are not read from front to end.
    digest: Option<Box<dyn FnOnce() -> io::Result<String> + Send>>,
}

impl ParquetRows {
    /// Reads the header.
    ///
    /// # Errors
    /// A file that is not sound, columns that do not name time, temperature and axes, columns that
    /// hold no numbers. The time column may hold timestamps, times of day or durations, of which the
    /// only one needs no name that says so, or clock times as text.
    pub(super) fn open(
        source: Source,
        finder: &Finder,
        skip_bad_rows: bool,
        parts: Parts,
    ) -> Result<(Self, Arc<Layout>), LogError> {
        let path = finder.path;
        let file = File::open(path).map_err(LogError::io(path))?;
        let file = BoundedFile::new(file, LARGEST_PAGE);
        let metadata = ParquetMetaDataReader::new().parse_and_finish(&file);
        let metadata = metadata.map_err(|cause| refused(path, &cause))?;
        let schema = metadata.file_metadata().schema_descr();
        let header = schema.columns().iter().map(|column| column.path().string());
        let refused = |message: String| LogError::file(path, message);
        let header: Vec<String> = header.collect();
        // The type of a time column says more than its name.
        let types = time_types(metadata.file_metadata());
        let file = Arc::new(file);
        let sample = parquet_file::sample(&file, &metadata, &types)
            .map_err(|cause| parquet_file::refused(path, &cause))?;
        let found = Found {
            preamble: &[],
            sample: &sample,
            row_kind: RowKind::Row,
            topic: None,
        };
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
        if let Some((instances, message)) = layout.columns.several.take() {
            return Err(LogError::sources(path, None, instances, message));
        }
        let time = types[layout.columns.time];
        if time.is_some() {
            layout.columns.time_unit = TimeUnit::S;
            layout.slots[0].conversion = Conversion::None;
        }
        let is_iso = layout.columns.time_unit == TimeUnit::Iso;
        if is_iso {
            let cells = sample.iter().map(|row| &row[layout.columns.time]);
            layout.origin_ns = cells
                .filter_map(|cell| TimeUnit::Iso.nanoseconds(cell))
                .next();
        }
        if let Some(joined) = &mut layout.joined {
            joined
                .align(layout.columns.time_unit, layout.origin_ns)
                .map_err(refused)?;
        }
        for slot in &layout.slots {
            let column = schema.column(slot.position);
            let name = excerpt(&layout.header[slot.position]);
            let is_time = slot.kind == Kind::Time;
            if is_time && is_iso && !columns::is_text(&column) {
                return Err(refused(format!(
                    "column `{name}` holds no text: expected clock times by ISO 8601, or a unit by \
                     --time {name}:s, :ms, :us or :ns"
                )));
            }
            let may_be_other = is_time && (time.is_some() || is_iso);
            if let Some(found) = columns::no_number(&column).filter(|_| !may_be_other) {
                return Err(refused(format!(
                    "column `{name}` holds {found}: expected floats or integers"
                )));
            }
        }
        let filters = layout.columns.filters.iter();
        let wanted = filters.map(|filter| {
            let name = excerpt(&layout.header[filter.position]);
            Wanted::new(&schema.column(filter.position), &filter.value)
                .map(Arc::new)
                .map_err(|message| format!("--where: column `{name}` {message}"))
        });
        let wanted = wanted.collect::<Result<_, _>>().map_err(refused)?;
        let origin = Origin::new(layout.origin_ns);
        let layout = Arc::new(layout);
        let rows = Self {
            file,
            metadata,
            layout: Arc::clone(&layout),
            time,
            origin,
            wanted,
            skip_bad_rows,
            rows_at_a_time: parts.table_rows,
            group: 0,
            rows_left: 0,
            readers: Vec::new(),
            filters: Vec::new(),
            other_source: Arc::default(),
            row: 0,
            digest: Some(later(parts.cores, move || source.text().sha256())),
        };
        Ok((rows, layout))
    }

    /// Reads ahead: what [`next`](Self::next) says, up to the end of the file or an error.
    pub(super) fn start(mut self, cores: usize) -> Ahead<Parsed> {
        Ahead::new(cores, PARTS_AHEAD, move || self.next())
    }

    /// The next rows, or the hash of the file at its end.
    ///
    /// # Errors
    /// A file that is not sound.
    fn next(&mut self) -> Part<Parsed> {
        let layout = Arc::clone(&self.layout);
        let failed = |cause: ParquetError| refused(&layout.path, &cause);
        while self.rows_left == 0 {
            if self.group == self.metadata.num_row_groups() {
                let digest = self.digest.take().expect("a log ends once");
                return Ok(Err(digest().map_err(LogError::io(&layout.path))?));
            }
            self.open_group().map_err(failed)?;
        }
        let rows = self.rows_left.min(self.rows_at_a_time);
        let readers = self.readers.iter_mut().map(|reader| reader.read(rows));
        let filters = self.filters.iter_mut().map(|reader| reader.read(rows));
        for read in readers.chain(filters) {
            if read.map_err(failed)? != rows {
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
        let rows = usize::try_from(self.metadata.row_group(self.group).num_rows())?;
        let open =
            |position: usize| parquet_file::open(&self.file, &self.metadata, self.group, position);
        let slots = self.layout.slots.iter().map(|slot| {
            let (column, reader) = open(slot.position)?;
            Ok(match slot.kind {
                Kind::Time => columns::times(&column, reader, self.time, &self.origin),
                Kind::Temp(_) | Kind::Axis(_) => columns::numbers(&column, reader),
            })
        });
        let readers = slots.collect::<Result<_, ParquetError>>()?;
        let filters = self.layout.columns.filters.iter().zip(&self.wanted);
        let filters = filters.map(|(filter, wanted)| {
            let (column, reader) = open(filter.position)?;
            Ok(filters::matches(
                &column,
                reader,
                wanted,
                &self.other_source,
            ))
        });
        self.filters = filters.collect::<Result<_, ParquetError>>()?;
        self.readers = readers;
        self.rows_left = rows;
        self.group += 1;
        Ok(())
    }

    /// Checks the rows that were just read.
    fn checked(&mut self, rows: usize) -> Parsed {
        let mut parsed = Parsed::with_capacity(&self.layout, rows);
        let first = self.row + 1;
        if self.take_columns(&mut parsed.chunk) {
            parsed.numbers.push_run(rows, first);
            return parsed;
        }
        let place = (first, rows);
        Parsed::of_table(&self.layout, place, self.skip_bad_rows, |row, values| {
            self.row(row, values)
        })
    }

    /// Takes the rows that were just read column by column, if all of them are wanted and nothing is
    /// wrong with any: much sooner done than row by row.
    fn take_columns(&self, chunk: &mut Chunk) -> bool {
        let are_good = |(slot, reader): (&Slot, &Column<f64>)| {
            let (low, high) = Layout::limits(slot);
            // Not those that are null or NaN.
            let is_good = |value: f64| low <= value && value <= high;
            reader.values.iter().all(|value| value.is_some_and(is_good))
        };
        let columns = || self.layout.slots.iter().zip(&self.readers);
        if !self.filters.is_empty() || !columns().all(are_good) {
            return false;
        }
        for (slot, reader) in columns() {
            let values = reader.values.iter().flatten();
            chunk.extend(slot.kind, values.map(|&value| slot.conversion.of(value)));
        }
        true
    }

    /// Checks a row; whether it is one that is wanted.
    fn row(&self, row: usize, values: &mut [f64]) -> Result<bool, Box<Bad>> {
        for (filter, reader) in self.layout.columns.filters.iter().zip(&self.filters) {
            match reader.values[row] {
                Some(true) => {}
                Some(false) if filter.is_only => {
                    return Err(Box::new(self.other_source(row, filter)));
                }
                _ => return Ok(false),
            }
        }
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
                Some(_) if slot.kind == Kind::Time && self.is_bad_clock(row) => {
                    let message = "expected a time by ISO 8601, such as 2023-03-04T09:00:00.5";
                    Some((Reason::NotANumber, message.to_owned()))
                }
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
            if let Some(objection) = objection {
                let row = (self.row + 1 + row as u64, time_s);
                return Err(Bad::of_cell(&self.layout, row, slot.position, objection));
            }
            time_s.get_or_insert(*value);
        }
        Ok(true)
    }

    /// Whether the time of a row is text that is no time.
    fn is_bad_clock(&self, row: usize) -> bool {
        self.layout.columns.time_unit == TimeUnit::Iso
            && self.readers[0].values[row].is_some_and(f64::is_nan)
    }

    /// The refusal of a row of another source than the one that the log should have.
    fn other_source(&self, row: usize, filter: &Filter) -> Bad {
        let column = &self.layout.header[filter.position];
        let other = self.other_source.get().map_or(&[][..], Vec::as_slice);
        let number = self.row + 1 + row as u64;
        let message = several_sources(column, &filter.value, other);
        Bad {
            number,
            time_s: None,
            reason: Reason::OutOfRange,
            error: LogError::file(&self.layout.path, format!("row {number}: {message}")),
            is_fatal: true,
        }
    }
}
