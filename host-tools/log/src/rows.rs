//! Rows of text become numbers.

use memchr::{memchr, memchr2};

use super::LogError;
use super::blocks::Block;
use super::decimal;
use super::dialect::{Separator, split_blanks};
use super::filter_columns::several_sources;
use super::layout::Layout;
use super::order::{Bad, Parsed};
use super::records::{MOST_CELLS, Records};
use super::skipped::Reason;
use super::slot::{Kind, Slot};

/// Bytes that a row takes at least, about: room is made for so many rows.
const BYTES_PER_ROW: usize = 16;

/// Reads the rows of a block; stops at the first bad one unless bad rows are skipped.
pub(super) fn parse(layout: &Layout, block: &Block, skip_bad_rows: bool) -> Parsed {
    let capacity = block.text().len() / (BYTES_PER_ROW.max(4 * layout.header.len())) + 1;
    let mut rows = Rows {
        layout,
        plan: plan(layout),
        first_line: block.first_line,
        values: vec![0.0; ROWS_AT_A_TIME * layout.slots.len()],
        kept: 0,
        skip_bad_rows,
        parsed: Parsed::with_capacity(layout, capacity),
    };
    let text = block.text();
    match layout.separator {
        _ if !block.is_plain => rows.quoted(text),
        _ if layout.needs_cells() => rows.unusual(text),
        Separator::Comma => rows.plain::<b','>(text),
        Separator::Semicolon => rows.plain::<b';'>(text),
        Separator::Tab => rows.plain::<b'\t'>(text),
        Separator::Bar => rows.plain::<b'|'>(text),
        Separator::Blanks => rows.unusual(text),
    }
    rows.flush();
    rows.parsed
}

/// Rows that are parsed before they are divided into columns.
const ROWS_AT_A_TIME: usize = 64;

/// A column of the file.
struct Column {
    /// The slots that it fills; none if it is not read.
    slots: Vec<usize>,
    /// Lowest and highest number that all of them accept.
    limits: (f64, f64),
    /// Whether its cells may be blank: it is read for temperatures alone.
    may_be_blank: bool,
}

fn plan(layout: &Layout) -> Vec<Column> {
    let column = |position: usize| {
        let slots = layout.slots.iter().enumerate();
        let slots = slots.filter(|(_, slot)| slot.position == position);
        let limits = |(low, high): (f64, f64), (_, slot): (usize, &Slot)| {
            let (least, most) = Layout::limits(slot);
            (low.max(least), high.min(most))
        };
        Column {
            slots: slots.clone().map(|(number, _)| number).collect(),
            may_be_blank: slots
                .clone()
                .all(|(_, slot)| matches!(slot.kind, Kind::Temp(_))),
            limits: slots.fold((f64::MIN, f64::MAX), limits),
        }
    };
    (0..layout.header.len()).map(column).collect()
}

struct Rows<'a> {
    layout: &'a Layout,
    plan: Vec<Column>,
    /// Number of the line that the block begins with.
    first_line: u64,
    /// Some rows, and room for the one being read: nothing is kept of a row with a bad cell.
    values: Vec<f64>,
    /// Values of the rows that are kept.
    kept: usize,
    skip_bad_rows: bool,
    parsed: Parsed,
}

impl Rows<'_> {
    /// Rows without quotes, each ended by a line feed.
    ///
    /// The line feeds are looked for ahead: where a row starts does not wait for the numbers of the
    /// row before, so that the processor works on both at a time.
    fn plain<const SEPARATOR: u8>(&mut self, text: &[u8]) {
        let (mut start, mut line) = (0, 0);
        let mut cells = Vec::new();
        while start < text.len() {
            start = if let Some(next) = self.row::<SEPARATOR>(text, start) {
                self.keep(line);
                next
            } else {
                let length = memchr(b'\n', &text[start..]).unwrap_or(text.len() - start);
                if !self.divided(line, &text[start..start + length], &mut cells) {
                    return;
                }
                start + length + 1
            };
            line += 1;
        }
    }

    /// The same for rows that are looked at cell by cell.
    fn unusual(&mut self, text: &[u8]) {
        let mut cells = Vec::new();
        for (line, row) in text.split(|&byte| byte == b'\n').enumerate() {
            if !self.divided(line as u32, row, &mut cells) {
                return;
            }
        }
    }

    /// Takes a row that is blank, bad or unusual; returns whether to go on.
    fn divided<'a>(&mut self, line: u32, row: &'a [u8], cells: &mut Vec<&'a [u8]>) -> bool {
        let row = row.strip_suffix(b"\r").unwrap_or(row);
        if row.is_empty() {
            return true;
        }
        cells.clear();
        match self.layout.separator.byte() {
            Some(separator) => cells.extend(row.split(|&byte| byte == separator).take(MOST_CELLS)),
            None => cells.extend(split_blanks(row).take(MOST_CELLS)),
        }
        self.cells(line, cells)
    }

    /// Rows of which some have quotes, or are ended by a carriage return alone.
    fn quoted(&mut self, text: &[u8]) {
        let separator = self.layout.separator;
        let mut records = Records::new(text, separator.record_byte());
        while let Some((line, mut cells)) = records.next() {
            if separator == Separator::Blanks {
                cells = cells.into_iter().flat_map(split_blanks).collect();
            }
            if !self.cells(line, &cells) {
                return;
            }
        }
    }

    /// Reads a good row at `at` of `text` into `values` and returns where its line feed is; `None`
    /// if there is none.
    #[inline]
    fn row<const SEPARATOR: u8>(&mut self, text: &[u8], mut at: usize) -> Option<usize> {
        let last = self.plan.len() - 1;
        let values = &mut self.values[self.kept..][..self.layout.slots.len()];
        for (position, column) in self.plan.iter().enumerate() {
            let separator = if position == last { b'\n' } else { SEPARATOR };
            if column.slots.is_empty() {
                at += memchr2(SEPARATOR, b'\n', &text[at..])?;
            } else {
                let (value, end) = match cell::<SEPARATOR>(text, at, separator) {
                    Some(found) => found,
                    None if column.may_be_blank && is_end::<SEPARATOR>(text, at) => {
                        self.parsed.has_blanks = true;
                        (f64::NAN, at)
                    }
                    None => return None,
                };
                at = end;
                if value < column.limits.0 || value > column.limits.1 {
                    return None;
                }
                for &slot in &column.slots {
                    values[slot] = value;
                }
            }
            if text[at] != separator {
                return None;
            }
            at += 1;
        }
        if self.layout.converts {
            self.layout.convert(values);
        }
        Some(at)
    }

    /// Keeps the row that was read.
    #[inline]
    fn keep(&mut self, line: u32) {
        self.kept += self.layout.slots.len();
        if self.kept == self.values.len() {
            self.flush();
        }
        let number = self.first_line + u64::from(line);
        self.parsed.numbers.push(number);
    }

    /// Divides the rows that were kept into columns.
    fn flush(&mut self) {
        let rows = &self.values[..self.kept];
        self.layout.extend(&mut self.parsed.chunk, rows);
        self.kept = 0;
    }

    /// Takes a row by its cells; returns whether to go on.
    fn cells(&mut self, line: u32, cells: &[&[u8]]) -> bool {
        match self.checked(line, cells) {
            Ok(true) => self.keep(line),
            Ok(false) => {}
            Err(bad) if self.skip_bad_rows && !bad.is_fatal => {
                self.parsed.skipped.count(bad.reason);
            }
            Err(bad) => {
                self.parsed.bad = Some(*bad);
                return false;
            }
        }
        true
    }

    /// Reads the cells of a row; whether it is one that is wanted.
    fn checked(&mut self, line: u32, cells: &[&[u8]]) -> Result<bool, Box<Bad>> {
        let layout = self.layout;
        let number = self.first_line + u64::from(line);
        let mut time_s = None;
        let bad = |time_s, reason, error| {
            Err(Box::new(Bad {
                number,
                time_s,
                reason,
                error,
                is_fatal: false,
            }))
        };
        // Other rows may be of another kind, with other cells.
        for filter in &layout.columns.filters {
            let cell = cells
                .get(filter.position)
                .map_or(&b""[..], |cell| cell.trim_ascii());
            if cell != filter.value && filter.is_only && !cell.is_empty() {
                let column = &layout.header[filter.position];
                let message = several_sources(column, &filter.value, cell);
                return Err(Box::new(Bad {
                    number,
                    time_s,
                    reason: Reason::OutOfRange,
                    error: LogError::line(&layout.path, number, message),
                    is_fatal: true,
                }));
            }
            if cell != filter.value {
                return Ok(false);
            }
        }
        if cells.len() != layout.header.len() {
            let message = format!(
                "{} cells, but the header has {} (a decimal comma, or a cut line?)",
                cells.len(),
                layout.header.len()
            );
            let error = LogError::line(&layout.path, number, message);
            return bad(None, Reason::CellCount, error);
        }
        for (value, slot) in self.values[self.kept..].iter_mut().zip(&layout.slots) {
            match layout.value(slot, cells[slot.position].trim_ascii()) {
                Ok(found) => *value = found,
                Err((reason, message)) => {
                    let error = layout.cell_error(number, slot.position, message);
                    return bad(time_s, reason, error);
                }
            }
            self.parsed.has_blanks |= value.is_nan();
            time_s.get_or_insert(*value);
        }
        Ok(true)
    }
}

/// Whether a cell ends at `at` of `text`.
#[inline(always)]
fn is_end<const SEPARATOR: u8>(text: &[u8], at: usize) -> bool {
    text.get(at)
        .is_some_and(|&byte| byte == SEPARATOR || byte == b'\n')
}

/// Reads the cell at `at` of `text`, which `separator` ends as a rule; returns its value and where it
/// ends.
#[inline(always)]
fn cell<const SEPARATOR: u8>(text: &[u8], at: usize, separator: u8) -> Option<(f64, usize)> {
    if let Some(start) = text[at..].first_chunk()
        && let Some((value, length)) = decimal::shortest(start)
        && start[length] == separator
    {
        return Some((value, at + length));
    }
    long_cell::<SEPARATOR>(text, at)
}

/// A cell of more digits.
#[inline(never)]
fn long_cell<const SEPARATOR: u8>(text: &[u8], at: usize) -> Option<(f64, usize)> {
    if let Some((value, end)) = decimal::short(text, at)
        && is_end::<SEPARATOR>(text, end)
    {
        return Some((value, end));
    }
    unusual_cell::<SEPARATOR>(text, at)
}

/// A cell with blanks, an exponent, many digits, before a carriage return, or near the ends of the
/// text.
#[cold]
fn unusual_cell<const SEPARATOR: u8>(text: &[u8], at: usize) -> Option<(f64, usize)> {
    let end = at + memchr2(SEPARATOR, b'\n', &text[at..])?;
    let cell = text[at..end].trim_ascii();
    let value = match decimal::prefix(cell) {
        Some((value, length)) if length == cell.len() => value,
        _ => decimal::parse(cell)?,
    };
    Some((value, end))
}
