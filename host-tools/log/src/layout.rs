//! What the columns of one log mean, and what their cells must hold.

use std::path::{Path, PathBuf};

use super::LogError;
use super::chunk::Chunk;
use super::columns::{Columns, Mapping};
use super::excerpt::excerpt;

/// Temperatures outside this range \[degC\] are taken for a wrong unit, not for a reading.
const PLAUSIBLE_TEMP_C: std::ops::RangeInclusive<f64> = -100.0..=200.0;

/// Values beyond this magnitude are no measurement of anything, and the core could not hold them.
const LARGEST_VALUE: f64 = 1e20;

/// How a row of a file is called in messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RowKind {
    /// A line of text; the header is line 1.
    Line,
    /// A row of a table without lines; the first is row 1.
    Row,
}

/// What a value stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Time,
    Temp(usize),
    Axis(usize),
}

/// A value of a row and where it is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) kind: Kind,
    pub(super) position: usize,
}

/// The columns of a log.
///
/// The values of a row are kept in slots: the time, then each channel's temperature and axes.
/// That is also the order in which they are checked.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) path: PathBuf,
    pub(super) header: Vec<String>,
    pub(super) columns: Columns,
    pub(super) slots: Vec<Slot>,
    pub(super) row_kind: RowKind,
}

impl Layout {
    /// Finds the columns of a header.
    ///
    /// # Errors
    /// A header that does not name time, temperature and axes with their units.
    pub(super) fn new(
        path: &Path,
        header: Vec<String>,
        mapping: &Mapping,
        row_kind: RowKind,
    ) -> Result<Self, LogError> {
        let columns = Columns::find(&header, mapping).map_err(|message| match row_kind {
            RowKind::Line => LogError::line(path, 1, message),
            RowKind::Row => LogError::file(path, message),
        })?;
        let mut slots = vec![Slot {
            kind: Kind::Time,
            position: columns.time,
        }];
        let mut axes = 0;
        for (channel, of_channel) in columns.channels.iter().enumerate() {
            slots.push(Slot {
                kind: Kind::Temp(channel),
                position: of_channel.temp,
            });
            for (position, _) in &of_channel.axes {
                slots.push(Slot {
                    kind: Kind::Axis(axes),
                    position: *position,
                });
                axes += 1;
            }
        }
        Ok(Self {
            path: path.to_owned(),
            header,
            columns,
            slots,
            row_kind,
        })
    }

    /// An empty chunk with room for some rows.
    pub(super) fn chunk(&self, rows: usize) -> Chunk {
        let channels = self.columns.channels.len();
        Chunk::with_capacity(channels, self.slots.len() - 1 - channels, rows)
    }

    /// Adds a row of checked values, in the order of the slots.
    #[inline]
    pub(super) fn push(&self, chunk: &mut Chunk, values: &[f64]) {
        for (slot, &value) in self.slots.iter().zip(values) {
            match slot.kind {
                Kind::Time => chunk.time_s.push(value),
                Kind::Temp(channel) => chunk.temps_c[channel].push(value as f32),
                Kind::Axis(axis) => chunk.axes[axis].push(value),
            }
        }
    }

    /// What is wrong with a finite value; `None` if nothing is.
    pub(super) fn objection(kind: Kind, value: f64) -> Option<String> {
        if value.abs() > LARGEST_VALUE {
            return Some(format!("{value:e}: expected a magnitude of 1e20 at most"));
        }
        if matches!(kind, Kind::Temp(_)) && !PLAUSIBLE_TEMP_C.contains(&value) {
            let hint = match (173.15..=473.15).contains(&value) {
                true => " (is it in kelvin?)",
                false => "",
            };
            return Some(format!("{value}: expected -100 to 200 degC{hint}"));
        }
        None
    }

    /// Lowest and highest acceptable value.
    pub(super) fn limits(kind: Kind) -> (f64, f64) {
        match kind {
            Kind::Temp(_) => (*PLAUSIBLE_TEMP_C.start(), *PLAUSIBLE_TEMP_C.end()),
            Kind::Time | Kind::Axis(_) => (-LARGEST_VALUE, LARGEST_VALUE),
        }
    }

    /// An error of a cell in row or line `number`.
    pub(super) fn cell_error(&self, number: u64, position: usize, message: String) -> LogError {
        let (path, name) = (self.path.clone(), excerpt(&self.header[position]));
        let column = position + 1;
        match self.row_kind {
            RowKind::Line => LogError::Cell {
                path,
                line: number,
                column,
                name,
                message,
            },
            RowKind::Row => LogError::Value {
                path,
                row: number,
                column,
                name,
                message,
            },
        }
    }
}
