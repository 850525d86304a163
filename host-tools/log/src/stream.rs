//! A log as a stream of chunks.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::binary::BinaryRows;
use super::channel_columns::ChannelColumns;
use super::chunk::Chunk;
use super::column_use::{ColumnUse, column_uses};
use super::doubt::Doubt;
use super::frame::{self, Frame, FrameRows};
use super::join::Joined;
use super::layout::{Finder, Layout};
use super::mapping::Mapping;
use super::order::{Parsed, TimeOrder};
use super::parallel::{Ahead, Parts};
use super::parquet::ParquetRows;
use super::pipeline::Pipeline;
use super::skipped::SkippedRows;
use super::source::{Format, Source};
use super::temp_columns::joined_temps;
use super::{LogError, ReadOptions, Reading};

/// A log that is read in memory of a fixed size, however long it is.
///
/// Every cell is checked as by [`read_log`](super::read_log). Values are in the units of their
/// columns: pulse counts become rates only when the median interval is known.
pub struct LogStream {
    rows: Rows,
    layout: Arc<Layout>,
    order: TimeOrder,
    bytes: Option<u64>,
    bytes_read: Arc<AtomicU64>,
    sha256: Option<String>,
}

/// Where rows come from.
enum Rows {
    Text(Pipeline),
    Parquet(Ahead<Parsed>),
    Binary(Box<BinaryRows>),
    Frame(Box<FrameRows>),
}

impl LogStream {
    /// Opens a log and reads its header. The format is told by the first bytes: Parquet, ULog,
    /// DataFlash, gzip and zstd have their marks, everything else is CSV.
    ///
    /// # Errors
    /// An unreadable or empty file, a header that does not name time, temperature and axes with
    /// their units.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Self, LogError> {
        Self::open_in_parts(path, options, Parts::usual())
    }

    /// Opens columns in memory as a log.
    ///
    /// # Errors
    /// Columns of different lengths, or whose names are not those of a log.
    pub(super) fn of_frame(frame: Frame, options: &ReadOptions) -> Result<Self, LogError> {
        let path = frame::path_of(&frame).to_owned();
        let joined = options.mapping.join.as_ref().map(PathBuf::from);
        let joined = joined.map(|file| read_joined(&file, options, &options.mapping));
        let finder = Finder {
            path: &path,
            mapping: &options.mapping,
            kept: &options.kept,
            joined: joined.transpose()?,
            without_axes: false,
        };
        let skip = options.skip_bad_rows;
        let (rows, layout) = FrameRows::open(frame, &finder, skip, Parts::usual().table_rows)?;
        Ok(Self {
            rows: Rows::Frame(Box::new(rows)),
            order: TimeOrder::new(&layout, skip),
            layout,
            bytes: None,
            bytes_read: Arc::default(),
            sha256: None,
        })
    }

    /// Opens a log of which only time and temperatures are read.
    pub(super) fn open_joined(path: &Path, options: &ReadOptions) -> Result<Self, LogError> {
        let finder = Finder {
            path,
            mapping: &options.mapping,
            kept: &[],
            joined: None,
            without_axes: true,
        };
        Self::start(&finder, options, Parts::usual())
    }

    /// Opens a log to be read in parts of another size.
    pub(super) fn open_in_parts(
        path: &Path,
        options: &ReadOptions,
        parts: Parts,
    ) -> Result<Self, LogError> {
        // A joined log that was kept with a set lies next to the log, where it is of this log.
        let given = options.mapping.join.as_ref().map(PathBuf::from);
        let kept = options.kept.iter().filter_map(|kept| {
            let name = Path::new(kept.join.as_ref()?).file_name()?;
            Some((path.with_file_name(name), kept)).filter(|(file, _)| file.is_file())
        });
        let joined = match (given, kept.take(1).next()) {
            (Some(file), _) => Some(read_joined(&file, options, &options.mapping)?),
            (None, Some((file, kept))) => {
                Some(read_joined(&file, options, &options.mapping.or(kept))?)
            }
            (None, None) => None,
        };
        let finder = Finder {
            path,
            mapping: &options.mapping,
            kept: &options.kept,
            joined,
            without_axes: false,
        };
        Self::start(&finder, options, parts)
    }

    fn start(finder: &Finder, options: &ReadOptions, parts: Parts) -> Result<Self, LogError> {
        let source = Source::open(finder.path).map_err(LogError::io(finder.path))?;
        let (bytes, bytes_read) = (source.bytes, Arc::clone(&source.bytes_read));
        let skip = options.skip_bad_rows;
        let (rows, layout) = match source.format {
            Format::Parquet => {
                let (rows, layout) = ParquetRows::open(source, finder, skip, parts)?;
                (Rows::Parquet(rows.start(parts.cores)), layout)
            }
            Format::Ulog | Format::DataFlash => {
                let (rows, layout) = BinaryRows::open(source, finder, skip, parts.table_rows)?;
                (Rows::Binary(Box::new(rows)), layout)
            }
            Format::Text | Format::Gzip | Format::Zstd => {
                let (rows, layout) = Pipeline::start(source, finder, skip, parts)?;
                (Rows::Text(rows), layout)
            }
        };
        Ok(Self {
            rows,
            order: TimeOrder::new(&layout, skip),
            layout,
            bytes,
            bytes_read,
            sha256: None,
        })
    }

    /// The next rows; `None` at the end of the log.
    ///
    /// # Errors
    /// The first thing that is wrong, with file, line and column, or row and column.
    pub fn next_chunk(&mut self) -> Result<Option<Chunk>, LogError> {
        while self.sha256.is_none() {
            let next = match &mut self.rows {
                Rows::Text(rows) => rows.next(),
                Rows::Parquet(rows) => rows.next(),
                Rows::Binary(rows) => Ok(rows.next()),
                Rows::Frame(rows) => Ok(rows.next()),
            };
            // What is wrong with the rows that wait comes first.
            let next = next.or_else(|error| self.order.finish(&self.layout).and(Err(error)));
            let rows = match next? {
                Ok(parsed) => self.order.take(&self.layout, parsed)?,
                Err(sha256) => {
                    let rest = self.order.finish(&self.layout)?;
                    self.sha256 = Some(sha256);
                    rest
                }
            };
            if rows.rows() > 0 {
                return Ok(Some(rows));
            }
        }
        Ok(None)
    }

    pub(super) fn layout(&self) -> &Layout {
        &self.layout
    }

    /// SHA-256 of the file's bytes, in hexadecimal, once the log was read to its end.
    pub fn sha256(&self) -> Option<&str> {
        self.sha256.as_deref()
    }

    /// Rows left out so far because skipping bad rows was asked for.
    pub fn skipped_rows(&self) -> SkippedRows {
        self.order.skipped
    }

    /// What was found in the stamps of the rows so far.
    #[cfg(test)]
    pub(super) fn time_notes(&self) -> super::clock::TimeNotes {
        self.order.notes()
    }

    /// Bytes of the file that were read so far.
    pub fn bytes_read(&self) -> u64 {
        self.bytes_read.load(Ordering::Relaxed)
    }

    /// Length of the file; `None` of a pipe.
    pub fn bytes(&self) -> Option<u64> {
        self.bytes
    }

    /// Names of all columns.
    pub fn header(&self) -> &[String] {
        &self.layout.header
    }

    /// The columns of temperatures and axes, in the order of the chunks.
    pub fn channels(&self) -> &[ChannelColumns] {
        &self.layout.columns.channels
    }

    /// What each column is used for, in the order of the header.
    pub fn column_uses(&self) -> Vec<ColumnUse> {
        column_uses(&self.layout)
    }

    /// Columns that were neither mapped nor recognised.
    pub fn ignored(&self) -> &[String] {
        &self.layout.columns.ignored
    }

    /// How the log is read, as far as it is known from the rows so far.
    pub fn reading(&self) -> Reading {
        let mut reading = self.layout.columns.reading.clone();
        let notes = self.order.notes();
        reading.notes.extend(notes.in_words());
        reading.doubts.extend(notes.doubts());
        if let Some(joined) = &self.layout.joined {
            reading.doubts.extend_from_slice(&joined.doubts);
        }
        reading
    }

    /// A chunk to which others of this log can be appended.
    pub fn empty_chunk(&self) -> Chunk {
        self.layout.chunk(0)
    }
}

/// Reads a log of which only time and temperatures are needed.
///
/// # Errors
/// Those of any log.
fn read_joined(path: &Path, options: &ReadOptions, mapping: &Mapping) -> Result<Joined, LogError> {
    let own = ReadOptions {
        mapping: Mapping {
            time: mapping.time.clone(),
            temp: mapping.temp.clone(),
            ..Mapping::default()
        },
        kept: Vec::new(),
        ..options.clone()
    };
    let mut stream = LogStream::open_joined(path, &own)?;
    let mut rows = stream.empty_chunk();
    while let Some(chunk) = stream.next_chunk()? {
        rows.append(&chunk);
    }
    if rows.rows() == 0 {
        return Err(LogError::too_few_rows(path, 0));
    }
    let file = path.display().to_string();
    let doubts = stream.reading().doubts.into_iter().map(|doubt| Doubt {
        detail: format!("in {file}: {}", doubt.detail),
        ..doubt
    });
    let layout = stream.layout();
    let temps = joined_temps(&layout.header, &own.mapping);
    Ok(Joined {
        temps: temps.map_err(|message| LogError::file(path, message))?,
        doubts: doubts.collect(),
        file,
        unit: layout.columns.time_unit,
        origin_ns: layout.origin_ns,
        offset_s: 0.0,
        rows: Arc::new(rows),
    })
}
