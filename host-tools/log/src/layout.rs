//! What the columns of one log mean, and what their cells must hold.

use std::path::{Path, PathBuf};

use super::LogError;
use super::chunk::Chunk;
use super::columns::{Columns, Mapping};
use super::decimal;
use super::dialect::{Header, Separator, is_clock};
use super::encoding::Encoding;
use super::excerpt::{excerpt, excerpt_of_bytes};
use super::reading::Reading;

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
    pub(super) separator: Separator,
    /// Whether numbers have a decimal comma.
    pub(super) decimal_comma: bool,
    pub(super) reading: Reading,
}

impl Layout {
    /// Of a text.
    ///
    /// # Errors
    /// Those of [`new`](Self::new); numbers of which some have a decimal comma and some a point.
    pub(super) fn of_text(
        path: &Path,
        header: Header,
        encoding: Encoding,
        mapping: &Mapping,
    ) -> Result<Self, LogError> {
        let line = u64::from(header.line) + 1;
        let mut notes = Vec::new();
        let names = header.names.iter().map(|name| text_of(name));
        let names = names.collect::<Option<Vec<String>>>();
        let names = names.ok_or_else(|| LogError::line(path, line, NO_TEXT))?;
        let refused = |message: String| LogError::line(path, line, message);
        let mut layout = Self::new(path, names, mapping, RowKind::Line).map_err(refused)?;
        if encoding != Encoding::Utf8 {
            notes.push("UTF-16".to_owned());
        } else if header
            .names
            .iter()
            .any(|name| str::from_utf8(name).is_err())
        {
            notes.push("names in Latin-1".to_owned());
        }
        if header.separator != Separator::Comma {
            notes.push(format!("cells separated by {}", header.separator.name()));
        }
        layout.separator = header.separator;
        let positions: Vec<usize> = layout.slots.iter().map(|slot| slot.position).collect();
        layout.decimal_comma = has_decimal_comma(&header, &positions)
            .map_err(|(row, message)| LogError::line(path, line + row, message))?;
        if layout.decimal_comma {
            notes.push("decimal comma".to_owned());
        }
        if let Some(first) = header.preamble.first() {
            notes.push(format!(
                "{} lines before the header passed over, from `{}` on",
                header.preamble.len(),
                excerpt_of_bytes(first)
            ));
        }
        layout.reading.notes = notes;
        Ok(layout)
    }

    /// Finds the columns of a header.
    ///
    /// # Errors
    /// A header that does not name time, temperature and axes with their units.
    pub(super) fn new(
        path: &Path,
        header: Vec<String>,
        mapping: &Mapping,
        row_kind: RowKind,
    ) -> Result<Self, String> {
        let columns = Columns::find(&header, mapping)?;
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
            separator: Separator::Comma,
            decimal_comma: false,
            reading: Reading::default(),
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

const NO_TEXT: &str = "the header is no text: expected column names such as `time_s,temp_c,x_dph`";

/// A name as text. Bytes that are not UTF-8 are Latin-1, in which spreadsheets write `°`.
fn text_of(name: &[u8]) -> Option<String> {
    let text = match str::from_utf8(name) {
        Ok(text) => text.to_owned(),
        Err(_) => name.iter().map(|&byte| char::from(byte)).collect(),
    };
    let is_text = !text
        .chars()
        .any(|letter| letter.is_control() && letter != '\t' && letter != '\n' && letter != '\r');
    is_text.then(|| text.trim().to_owned())
}

/// Whether the numbers of the first rows, in the columns that are read, have a decimal comma.
///
/// # Errors
/// Two signs, or commas that may stand between thousands; with the place of the row.
fn has_decimal_comma(header: &Header, positions: &[usize]) -> Result<bool, (u64, String)> {
    let (mut point, mut comma, mut is_certain) = (None, None, false);
    for (row, cells) in header.sample.iter().enumerate() {
        for cell in positions.iter().filter_map(|&position| cells.get(position)) {
            if is_clock(cell) {
                continue;
            }
            if decimal::parse(cell).is_some() && cell.contains(&b'.') {
                point.get_or_insert(cell);
            } else if decimal::parse_with(cell, true).is_some() && cell.contains(&b',') {
                comma.get_or_insert((row as u64 + 1, cell));
                is_certain |= !may_be_thousands(cell);
            }
        }
    }
    let Some((row, cell)) = comma else {
        return Ok(false);
    };
    let cell = excerpt_of_bytes(cell);
    match point {
        Some(point) => Err((
            row,
            format!(
                "`{cell}` has a decimal comma and `{}` a decimal point: expected one of them",
                excerpt_of_bytes(point)
            ),
        )),
        None if !is_certain => Err((
            row,
            format!(
                "`{cell}` may have a decimal comma, or a comma between thousands: expected a \
                 decimal point"
            ),
        )),
        None => Ok(true),
    }
}

/// Whether a comma may stand before three digits of a larger number: `1,234`, not `0,123`.
fn may_be_thousands(cell: &[u8]) -> bool {
    let cell = cell.strip_prefix(b"-").unwrap_or(cell);
    let comma = cell.iter().position(|&byte| byte == b',').unwrap_or(0);
    let (whole, decimals) = (&cell[..comma], &cell[comma + 1..]);
    let is_number = |text: &[u8]| text.iter().all(u8::is_ascii_digit);
    (1..=3).contains(&whole.len()) && whole[0] != b'0' && decimals.len() == 3 && is_number(decimals)
}
