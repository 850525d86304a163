//! What the columns of one log mean, and what their cells must hold.

use std::path::{Path, PathBuf};

use super::LogError;
use super::chunk::Chunk;
use super::columns::Columns;
use super::decimal;
use super::dialect::Separator;
use super::excerpt::{excerpt, excerpt_of_bytes};
use super::join::{HOLD_S, Joined};
use super::known::Signs;
use super::mapping::Mapping;
use super::skipped::Reason;
use super::slot::{Conversion, Kind, Slot};
use super::temp_columns::TempSource;
use super::time::TimeUnit;

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
    pub(super) separator: Separator,
    /// Whether numbers have a decimal comma.
    pub(super) decimal_comma: bool,
    /// Whether any number is converted.
    pub(super) converts: bool,
    /// Where times count from, of units that count from the first row.
    pub(super) origin_ns: Option<i128>,
    /// Temperatures of another log.
    pub(super) joined: Option<Joined>,
}

/// What the columns of a log are found from.
#[derive(Clone)]
pub(super) struct Finder<'a> {
    pub(super) path: &'a Path,
    pub(super) mapping: &'a Mapping,
    /// Mappings that were kept, used where they fit.
    pub(super) kept: &'a [Mapping],
    /// Temperatures of another log.
    pub(super) joined: Option<Joined>,
    /// Whether this is a log to be joined, of which only time and temperatures are read.
    pub(super) without_axes: bool,
}

/// What stands about a header.
pub(super) struct Found<'a> {
    pub(super) preamble: &'a [Vec<u8>],
    pub(super) sample: &'a [Vec<Vec<u8>>],
    pub(super) row_kind: RowKind,
    /// The topic of a binary log that the rows are of.
    pub(super) topic: Option<&'a str>,
}

impl Layout {
    /// Finds the columns of a header.
    ///
    /// # Errors
    /// A header that does not name time, temperature and axes with their units.
    pub(super) fn new(header: Vec<String>, found: &Found, finder: &Finder) -> Result<Self, String> {
        let file = finder.path.file_name().unwrap_or_default();
        let file = file.to_string_lossy();
        let signs = Signs {
            header: &header,
            // A topic is what names of files say where they are written from a binary log.
            file: found.topic.unwrap_or(&file),
            has_instances: found.topic.is_some(),
            preamble: found.preamble,
            sample: found.sample,
        };
        let joined = finder.joined.as_ref();
        let temps = joined.map(|joined| (joined.temps.clone(), joined.file.clone()));
        let columns = match finder.without_axes {
            true => Columns::of_joined(&signs, finder.mapping)?,
            false => Columns::find(&signs, finder.mapping, finder.kept, temps)?,
        };
        let ticks = columns.time_unit.per_second();
        let mut sources = columns.channels.iter().map(|channel| channel.temp);
        let is_joined = sources.any(|temp| matches!(temp, TempSource::Joined(_)));
        let mut slots = vec![Slot {
            kind: Kind::Time,
            position: columns.time,
            conversion: match ticks {
                Some(ticks) if ticks != 1.0 => Conversion::PerSecond(ticks),
                _ => Conversion::None,
            },
        }];
        let mut axes = 0;
        for (channel, of_channel) in columns.channels.iter().enumerate() {
            if let TempSource::Column(position) = of_channel.temp {
                slots.push(Slot {
                    kind: Kind::Temp(channel),
                    position,
                    conversion: Conversion::linear(of_channel.to_deg_c),
                });
            }
            for axis in &of_channel.axes {
                slots.push(Slot {
                    kind: Kind::Axis(axes),
                    position: axis.position,
                    conversion: Conversion::linear(axis.linear),
                });
                axes += 1;
            }
        }
        let mut layout = Self {
            path: finder.path.to_owned(),
            header,
            columns,
            slots,
            row_kind: found.row_kind,
            separator: Separator::Comma,
            decimal_comma: false,
            converts: false,
            origin_ns: None,
            joined: joined.filter(|_| is_joined).cloned(),
        };
        layout.converts = layout.has_conversion();
        Ok(layout)
    }

    pub(super) fn has_conversion(&self) -> bool {
        let mut slots = self.slots.iter();
        slots.any(|slot| slot.conversion != Conversion::None)
    }

    /// Whether rows must be looked at cell by cell.
    pub(super) fn needs_cells(&self) -> bool {
        self.decimal_comma
            || self.separator == Separator::Blanks
            || !self.columns.filters.is_empty()
            || self.columns.time_unit.has_origin()
    }

    /// Converts the numbers of a row.
    #[inline]
    pub(super) fn convert(&self, values: &mut [f64]) {
        for (slot, value) in self.slots.iter().zip(values) {
            *value = slot.conversion.of(*value);
        }
    }

    /// The number in a cell of a text, in the unit of the log.
    ///
    /// # Errors
    /// What is wrong with the cell.
    #[inline]
    pub(super) fn value(&self, slot: &Slot, cell: &[u8]) -> Result<f64, (Reason, String)> {
        let unit = self.columns.time_unit;
        let value = match slot.kind {
            Kind::Time if unit.has_origin() => {
                let since = unit.nanoseconds(cell).zip(self.origin_ns);
                since.map(|(time, origin)| (time - origin) as f64 / 1e9)
            }
            Kind::Temp(_) if cell.is_empty() => return Ok(f64::NAN),
            _ => decimal::parse_with(cell, self.decimal_comma),
        };
        let expected = match (slot.kind, unit) {
            (Kind::Time, TimeUnit::Iso) => "a time by ISO 8601, such as 2023-03-04T09:00:00.5",
            (Kind::Time, TimeUnit::Ns) => "whole nanoseconds",
            _ => "a finite number",
        };
        let value = value
            .map(|value| slot.conversion.of(value))
            .ok_or_else(|| match cell {
                [] => (
                    Reason::EmptyCell,
                    format!("an empty cell: expected {expected}"),
                ),
                _ => {
                    let message = format!("`{}`: expected {expected}", excerpt_of_bytes(cell));
                    (Reason::NotANumber, message)
                }
            })?;
        let objection = Self::objection(slot.kind, value);
        objection.map_or(Ok(value), |message| Err((Reason::OutOfRange, message)))
    }

    /// An empty chunk with room for some rows.
    pub(super) fn chunk(&self, rows: usize) -> Chunk {
        let channels = &self.columns.channels;
        let axes = channels.iter().map(|channel| channel.axes.len()).sum();
        Chunk::with_capacity(channels.len(), axes, rows)
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

    /// Adds rows of checked values, row after row: sooner done than row by row.
    pub(super) fn extend(&self, chunk: &mut Chunk, rows: &[f64]) {
        for (number, slot) in self.slots.iter().enumerate() {
            let values = rows.iter().skip(number).step_by(self.slots.len());
            chunk.extend(slot.kind, values.copied());
        }
    }

    /// A number of a table in the unit of the log; NaN stands for a blank temperature.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn checked(slot: &Slot, found: f64) -> Result<f64, (Reason, String)> {
        let value = slot.conversion.of(found);
        if found.is_nan() && matches!(slot.kind, Kind::Temp(_)) {
            return Ok(value);
        }
        if !found.is_finite() {
            let message = format!("`{found}`: expected a finite number");
            return Err((Reason::NotANumber, message));
        }
        let objection = Self::objection(slot.kind, value);
        objection.map_or(Ok(value), |message| Err((Reason::OutOfRange, message)))
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

    /// Lowest and highest acceptable number in a cell, before it is converted.
    pub(super) fn limits(slot: &Slot) -> (f64, f64) {
        let (low, high) = match slot.kind {
            Kind::Temp(_) => (*PLAUSIBLE_TEMP_C.start(), *PLAUSIBLE_TEMP_C.end()),
            Kind::Time | Kind::Axis(_) => (-LARGEST_VALUE, LARGEST_VALUE),
        };
        let (low, high) = (slot.conversion.inverse(low), slot.conversion.inverse(high));
        (low.min(high), low.max(high))
    }

    /// The error of a row whose channel has no temperature.
    pub(super) fn blank_temp(&self, number: u64, channel: usize, time_s: f64) -> LogError {
        match (self.columns.channels[channel].temp, &self.joined) {
            (TempSource::Column(position), _) => {
                let message = format!(
                    "an empty cell, and no temperature in the {HOLD_S} s before: expected a finite \
                     number"
                );
                self.cell_error(number, position, message)
            }
            (TempSource::Joined(_), joined) => {
                let joined = joined.as_ref().map(Joined::describe).unwrap_or_default();
                let message =
                    format!("no temperature in the {HOLD_S} s before {time_s} s in {joined}");
                match self.row_kind {
                    RowKind::Line => LogError::line(&self.path, number, message),
                    RowKind::Row => LogError::file(&self.path, message),
                }
            }
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
