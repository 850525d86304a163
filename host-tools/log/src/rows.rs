//! Rows of text become numbers.

use memchr::{memchr_iter, memchr2};

use super::LogError;
use super::blocks::Block;
use super::decimal;
use super::dialect::{Separator, split_blanks};
use super::excerpt::excerpt_of_bytes;
use super::layout::{Layout, Slot};
use super::order::{Bad, Parsed};
use super::records::{MOST_CELLS, Records};

/// Bytes that a row takes at least, about: room is made for so many rows.
const BYTES_PER_ROW: usize = 16;

/// Reads the rows of a block; stops at the first bad one unless bad rows are skipped.
pub(super) fn parse(layout: &Layout, block: &Block, skip_bad_rows: bool) -> Parsed {
    let capacity = block.text().len() / (BYTES_PER_ROW.max(4 * layout.header.len())) + 1;
    let mut rows = Rows {
        layout,
        plan: plan(layout),
        values: vec![0.0; layout.slots.len()],
        skip_bad_rows,
        parsed: Parsed {
            chunk: layout.chunk(capacity),
            base: block.first_line,
            numbers: Vec::with_capacity(capacity),
            skipped: 0,
            bad: None,
        },
    };
    let text = block.text();
    match (block.is_plain, layout.decimal_comma, layout.separator) {
        (false, ..) => rows.quoted(text),
        (_, true, _) | (.., Separator::Blanks) => rows.unusual(text),
        (.., Separator::Comma) => rows.plain::<b','>(text),
        (.., Separator::Semicolon) => rows.plain::<b';'>(text),
        (.., Separator::Tab) => rows.plain::<b'\t'>(text),
        (.., Separator::Bar) => rows.plain::<b'|'>(text),
    }
    rows.parsed
}

/// A column of the file.
struct Column {
    /// The slots that it fills; none if it is not read.
    slots: Vec<usize>,
    /// Lowest and highest value that all of them accept.
    limits: (f64, f64),
}

fn plan(layout: &Layout) -> Vec<Column> {
    let column = |position: usize| {
        let slots = layout.slots.iter().enumerate();
        let slots = slots.filter(|(_, slot)| slot.position == position);
        let limits = |(low, high): (f64, f64), (_, slot): (usize, &Slot)| {
            let (least, most) = Layout::limits(slot.kind);
            (low.max(least), high.min(most))
        };
        Column {
            slots: slots.clone().map(|(number, _)| number).collect(),
            limits: slots.fold((f64::MIN, f64::MAX), limits),
        }
    };
    (0..layout.header.len()).map(column).collect()
}

struct Rows<'a> {
    layout: &'a Layout,
    plan: Vec<Column>,
    /// The row being read: nothing is kept of a row with a bad cell.
    values: Vec<f64>,
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
        for end in memchr_iter(b'\n', text) {
            if self.row::<SEPARATOR>(text, start) == Some(end) {
                self.keep(line);
            } else if !self.divided(line, &text[start..end], &mut cells) {
                return;
            }
            start = end + 1;
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
        for (position, column) in self.plan.iter().enumerate() {
            if column.slots.is_empty() {
                at += memchr2(SEPARATOR, b'\n', &text[at..])?;
            } else {
                let (value, end) = cell::<SEPARATOR>(text, at)?;
                at = end;
                if value < column.limits.0 || value > column.limits.1 {
                    return None;
                }
                for &slot in &column.slots {
                    self.values[slot] = value;
                }
            }
            let separator = if position == last { b'\n' } else { SEPARATOR };
            if text[at] != separator {
                return None;
            }
            at += 1;
        }
        Some(at - 1)
    }

    /// Keeps the row that was read.
    #[inline]
    fn keep(&mut self, line: u32) {
        self.layout.push(&mut self.parsed.chunk, &self.values);
        self.parsed.numbers.push(line);
    }

    /// Takes a row by its cells; returns whether to go on.
    fn cells(&mut self, line: u32, cells: &[&[u8]]) -> bool {
        match self.checked(line, cells) {
            Ok(()) => self.keep(line),
            Err(_) if self.skip_bad_rows => self.parsed.skipped += 1,
            Err(bad) => {
                self.parsed.bad = Some(*bad);
                return false;
            }
        }
        true
    }

    fn checked(&mut self, line: u32, cells: &[&[u8]]) -> Result<(), Box<Bad>> {
        let layout = self.layout;
        let number = self.parsed.base + u64::from(line);
        let mut time_s = None;
        let bad = |time_s, error| {
            Err(Box::new(Bad {
                number,
                time_s,
                error,
            }))
        };
        if cells.len() != layout.header.len() {
            let message = format!(
                "{} cells, but the header has {} (a decimal comma, or a cut line?)",
                cells.len(),
                layout.header.len()
            );
            return bad(None, LogError::line(&layout.path, number, message));
        }
        for (value, slot) in self.values.iter_mut().zip(&layout.slots) {
            let cell = cells[slot.position].trim_ascii();
            let objection = match decimal::parse_with(cell, layout.decimal_comma) {
                Some(parsed) => {
                    *value = parsed;
                    Layout::objection(slot.kind, parsed)
                }
                None => Some(not_a_number(cell)),
            };
            if let Some(message) = objection {
                return bad(time_s, layout.cell_error(number, slot.position, message));
            }
            time_s.get_or_insert(*value);
        }
        Ok(())
    }
}

/// Reads the cell at `at` of `text`; returns its value and where it ends.
#[inline(always)]
fn cell<const SEPARATOR: u8>(text: &[u8], at: usize) -> Option<(f64, usize)> {
    if let Some((value, end)) = decimal::short(text, at)
        && matches!(text.get(end), Some(&byte) if byte == SEPARATOR || byte == b'\n')
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

fn not_a_number(cell: &[u8]) -> String {
    match cell {
        [] => "an empty cell: expected a finite number".to_owned(),
        _ => format!("`{}`: expected a finite number", excerpt_of_bytes(cell)),
    }
}
