//! How a text is divided into cells: its separator, its header, and lines before the header.

use memchr::memchr2_iter;

use super::decimal;
use super::known::FLYSIGHT_ROW;
use super::names;
use super::records::{MOST_CELLS, Records};

/// Lines that are looked at for a header and a row of numbers.
const LINES: usize = 400;

/// A header stands at most so many lines before the first row of numbers.
const LINES_BACK: usize = 8;

/// What separates the cells of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    Comma,
    Semicolon,
    Tab,
    Bar,
    /// Blanks and tabs, as many as there are.
    Blanks,
}

impl Separator {
    /// In the order in which they are tried: the first of equals is taken.
    const ALL: [Self; 5] = [
        Self::Comma,
        Self::Semicolon,
        Self::Tab,
        Self::Bar,
        Self::Blanks,
    ];

    /// The byte, if it is one byte.
    pub(super) fn byte(self) -> Option<u8> {
        match self {
            Self::Comma => Some(b','),
            Self::Semicolon => Some(b';'),
            Self::Tab => Some(b'\t'),
            Self::Bar => Some(b'|'),
            Self::Blanks => None,
        }
    }

    /// The byte for a reader of records, which gives a whole row where blanks separate.
    pub(super) fn record_byte(self) -> u8 {
        const NOT_IN_A_TEXT: u8 = 0x1e;
        self.byte().unwrap_or(NOT_IN_A_TEXT)
    }

    /// The separator as a message shows it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Comma => "`,`",
            Self::Semicolon => "`;`",
            Self::Tab => "tab",
            Self::Bar => "`|`",
            Self::Blanks => "blanks",
        }
    }
}

/// The header of a text and what was found on the way to it.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) names: Vec<Vec<u8>>,
    pub(super) separator: Separator,
    /// Line of the header, the first being 0.
    pub(super) line: u32,
    /// Lines before it that are not blank.
    pub(super) preamble: Vec<Vec<u8>>,
    /// Cells of the first rows.
    pub(super) sample: Vec<Vec<Vec<u8>>>,
    /// Bytes up to the end of the header.
    pub(super) length: usize,
    /// Lines up to there.
    pub(super) lines: u32,
}

/// Cells of a row that is divided by blanks.
pub(super) fn split_blanks(row: &[u8]) -> impl Iterator<Item = &[u8]> {
    row.split(|&byte| matches!(byte, b' ' | b'\t'))
        .filter(|cell| !cell.is_empty())
}

/// A line that is not blank, with its number and where it starts.
struct Line<'a> {
    number: u32,
    start: usize,
    text: &'a [u8],
}

/// The first whole lines of a text that are not blank; at its end, the last one needs no line end.
fn first_lines(text: &[u8], is_at_end: bool) -> Vec<Line<'_>> {
    let (mut found, mut number, mut start) = (Vec::new(), 0, 0);
    while start < text.len() && found.len() < LINES {
        let rest = &text[start..];
        let Some(length) = line_length(rest).or(is_at_end.then_some(rest.len())) else {
            break;
        };
        let line = &rest[..length];
        if !line.trim_ascii().is_empty() {
            found.push(Line {
                number,
                start,
                text: line,
            });
        }
        let end = match rest[length..] {
            [b'\r', b'\n', ..] => 2,
            _ => 1,
        };
        start += length + end;
        number += 1 + line.iter().filter(|byte| **byte == b'\n').count() as u32;
    }
    found
}

/// Bytes up to the end of the first line. Cells in quotes may hold the ends of some lines; a quote
/// that none of them closes is a letter like others.
fn line_length(text: &[u8]) -> Option<usize> {
    const MOST_LINES: usize = 16;
    let mut ends = memchr2_iter(b'\n', b'\r', text);
    let first = ends.next()?;
    let mut ends = std::iter::once(first).chain(ends).take(MOST_LINES);
    Some(
        ends.find(|&end| !ends_in_quotes(&text[..end]))
            .unwrap_or(first),
    )
}

/// Whether the last cell in quotes is not closed.
fn ends_in_quotes(line: &[u8]) -> bool {
    let (mut is_open, mut before) = (false, b',');
    for &byte in line {
        // A quote opens a cell at its start, and again where two of them stand for one.
        let can_open = matches!(before, b',' | b';' | b'\t' | b'|' | b'"');
        if byte == b'"' {
            is_open = !is_open && can_open;
        }
        before = byte;
    }
    is_open
}

/// A line in cells; quotes are read, and marks of comments before a header taken off.
fn cells(line: &[u8], separator: Separator) -> Vec<Vec<u8>> {
    let cell = |cell: &[u8]| cell.trim_ascii().to_vec();
    match separator.byte() {
        // A reader of records takes longer to make than a line to divide.
        Some(byte) if !line.is_empty() && !line.contains(&b'"') => {
            let cells = line.split(|other| *other == byte).take(MOST_CELLS);
            cells.map(cell).collect()
        }
        Some(byte) => Records::new(line, byte)
            .next()
            .map(|(_, cells)| cells.into_iter().map(cell).collect())
            .unwrap_or_default(),
        None => split_blanks(line).map(cell).collect(),
    }
}

/// A header in cells. Blanks divide no unit in brackets from its name.
fn header_cells(line: &[u8], separator: Separator) -> Vec<Vec<u8>> {
    let line = without_comment_mark(line);
    let mut names: Vec<Vec<u8>> = Vec::new();
    for cell in cells(line, separator) {
        let is_open = |name: &Vec<u8>| {
            let count = |bytes: &[u8]| name.iter().filter(|b| bytes.contains(b)).count();
            count(b"[(") > count(b"])")
        };
        let is_part = separator == Separator::Blanks
            && (cell.starts_with(b"[")
                || cell.starts_with(b"(")
                || names.last().is_some_and(is_open));
        match names.last_mut().filter(|_| is_part) {
            Some(name) => {
                name.push(b' ');
                name.extend(cell);
            }
            None => names.push(cell),
        }
    }
    names
}

/// Marks that begin a comment.
const COMMENT_MARKS: [&[u8]; 3] = [b"#", b"%", b"//"];

fn without_comment_mark(line: &[u8]) -> &[u8] {
    let marks = COMMENT_MARKS.iter();
    let mut without = marks.filter_map(|mark| line.trim_ascii_start().strip_prefix(*mark));
    without.next().unwrap_or(line)
}

/// Whether a cell is a number, with either decimal sign, or a date or time of day.
fn is_value(cell: &[u8]) -> bool {
    let has_comma = cell.contains(&b',');
    let is_number = !cell.ends_with(b",") && decimal::parse_with(cell, has_comma).is_some();
    is_number || is_clock(cell)
}

/// Whether a cell may be a date or a time of day.
pub(super) fn is_clock(cell: &[u8]) -> bool {
    cell.first().is_some_and(u8::is_ascii_digit) && cell.contains(&b':')
}

/// Whether a cell may be a name: it has letters, and is no word for a missing number.
fn is_name(cell: &[u8]) -> bool {
    let missing = [&b"nan"[..], b"inf", b"-inf", b"null", b"none", b"na"];
    let is_missing = missing.iter().any(|word| cell.eq_ignore_ascii_case(word));
    let is_letter = |byte: &u8| byte.is_ascii_alphabetic() || *byte >= 0x80;
    !is_missing && !is_value(cell) && cell.iter().any(is_letter)
}

/// Cells of a line without an empty one at its end.
fn trimmed(cells: &[Vec<u8>]) -> usize {
    cells.len() - usize::from(cells.last().is_some_and(Vec::is_empty))
}

/// A header for a row of numbers: the nearest line before it that names the time, else the nearest.
/// Returns its place among the lines and its names, as many as the row has cells.
fn header_of(
    lines: &[Line],
    row: &[Vec<u8>],
    separator: Separator,
) -> Option<(usize, Vec<Vec<u8>>)> {
    let fits = |names: &[Vec<u8>]| {
        let has_names = names.iter().all(|name| name.is_empty() || is_name(name));
        let fits =
            names.len() == row.len() || names.len() == trimmed(row) || trimmed(names) == row.len();
        has_names && fits && names.len() > 1
    };
    let candidates = lines.iter().enumerate().rev().take(LINES_BACK);
    let candidates = candidates.filter_map(|(place, line)| {
        let names = header_cells(line.text, separator);
        fits(&names).then_some((place, names))
    });
    let mut candidates: Vec<_> = candidates.collect();
    let with_time = candidates
        .iter()
        .position(|(_, names)| names.iter().any(|name| names::may_be_time(name)));
    if candidates.is_empty() {
        return None;
    }
    let (place, mut names) = candidates.swap_remove(with_time.unwrap_or(0));
    // An empty cell at the end stands in the header as in the rows.
    names.resize(row.len(), Vec::new());
    Some((place, names))
}

/// Finds header and separator: by the first row of numbers that has a header before it, and by the
/// separator that makes most numbers of this row. `None` where the text must be longer for it, which
/// it cannot be if this is all that may be looked at.
///
/// # Errors
/// Two separators that do equally well.
pub(super) fn find_header(
    text: &[u8],
    is_at_end: bool,
    is_all: bool,
) -> Result<Option<Header>, String> {
    let lines = first_lines(text, is_at_end);
    if lines
        .first()
        .is_some_and(|line| line.text.starts_with(b"$FLYS"))
    {
        return Ok(flysight(&lines).or_else(|| without_rows(text, &lines).filter(|_| is_all)));
    }
    for (at, line) in lines.iter().enumerate() {
        let mut found: Option<(usize, Separator, usize, Vec<Vec<u8>>)> = None;
        for separator in Separator::ALL {
            let row = cells(line.text, separator);
            let values = row.iter().filter(|cell| is_value(cell)).count();
            let best = found.as_ref().map_or(1, |(best, ..)| *best);
            if values < best || values < 2 {
                continue;
            }
            let Some((place, names)) = header_of(&lines[..at], &row, separator) else {
                continue;
            };
            match &found {
                // Blanks divide what tabs divide.
                Some((best, ..)) if *best == values && separator == Separator::Blanks => {}
                Some((best, other, ..)) if *best == values => {
                    return Err(format!(
                        "line {}: as many numbers between {} as between {}: expected one separator",
                        line.number + 1,
                        other.name(),
                        separator.name()
                    ));
                }
                _ => found = Some((values, separator, place, names)),
            }
        }
        if let Some((_, separator, place, names)) = found {
            return Ok(Some(header(text, &lines, place, separator, names)));
        }
        if at + 1 == LINES {
            return Ok(without_rows(text, &lines));
        }
    }
    Ok(if is_all {
        without_rows(text, &lines)
    } else {
        None
    })
}

/// The header of FlySight 2, whose lines `$COL,IMU` and `$UNIT,IMU` name columns and units.
fn flysight(lines: &[Line]) -> Option<Header> {
    let end = lines
        .iter()
        .position(|line| line.text.trim_ascii() == b"$DATA")?;
    let of = |start: &[u8]| {
        let is_wanted = |line: &&Line| line.text.starts_with(start);
        let line = lines[..end].iter().find(is_wanted)?;
        Some(cells(&line.text[start.len()..], Separator::Comma))
    };
    let (columns, units) = (of(b"$COL,IMU,")?, of(b"$UNIT,IMU,").unwrap_or_default());
    let units = units.into_iter().chain(std::iter::repeat(Vec::new()));
    let named = columns
        .into_iter()
        .zip(units)
        .map(|(column, unit)| match &unit[..] {
            [] => column,
            unit => [&column[..], b" [", unit, b"]"].concat(),
        });
    let names = std::iter::once(FLYSIGHT_ROW.as_bytes().to_vec()).chain(named);
    let data = &lines[end];
    Some(Header {
        names: names.collect(),
        separator: Separator::Comma,
        line: data.number,
        preamble: Vec::new(),
        sample: Vec::new(),
        length: data.start + data.text.len(),
        lines: data.number,
    })
}

/// Without a row of numbers, the first line that is no comment is the header.
fn without_rows(text: &[u8], lines: &[Line]) -> Option<Header> {
    let is_comment = |line: &Line| without_comment_mark(line.text).len() != line.text.len();
    let place = lines.iter().position(|line| !is_comment(line)).unwrap_or(0);
    let line = lines.get(place)?;
    let count = |separator: Separator| header_cells(line.text, separator).len();
    let most = Separator::ALL[..4]
        .iter()
        .rev()
        .max_by_key(|separator| count(**separator));
    let separator = *most
        .filter(|separator| count(**separator) > 1)
        .unwrap_or(&Separator::Comma);
    // A name in quotes may hold the end of a line.
    let byte = separator.byte().unwrap_or(b',');
    let mut records = Records::new(&text[line.start..], byte);
    let names = records.next()?.1.into_iter().map(<[u8]>::to_vec).collect();
    Some(header(text, lines, place, separator, names))
}

/// Rows after the header that are kept, to see what their cells are.
const SAMPLE: usize = 100;

fn header(
    text: &[u8],
    lines: &[Line],
    place: usize,
    separator: Separator,
    names: Vec<Vec<u8>>,
) -> Header {
    let line = &lines[place];
    let preamble = lines[..place].iter();
    let sample = lines[place + 1..].iter().take(SAMPLE);
    // Quotes may hold the end of a line.
    let (length, of_header) = match separator.byte() {
        Some(byte) => {
            let mut records = Records::new(&text[line.start..], byte);
            records.next();
            (text.len() - records.rest().len(), records.line())
        }
        None => (line.start + line.text.len(), 0),
    };
    Header {
        names,
        separator,
        line: line.number,
        preamble: preamble.map(|line| line.text.to_vec()).collect(),
        sample: sample.map(|line| cells(line.text, separator)).collect(),
        length,
        lines: line.number + of_header,
    }
}
