//! The layout of a text: its names, separator, decimal sign, and the origin of its times.

use super::LogError;
use super::decimal_comma::has_decimal_comma;
use super::dialect::{Header, Separator};
use super::encoding::Encoding;
use super::excerpt::excerpt_of_bytes;
use super::layout::{Finder, Found, Layout, RowKind};
use super::slot::Conversion;

impl Layout {
    /// Of a text.
    ///
    /// # Errors
    /// Those of [`new`](Self::new); numbers of which some have a decimal comma and some a point.
    pub(super) fn of_text(
        header: Header,
        encoding: Encoding,
        finder: &Finder,
    ) -> Result<Self, LogError> {
        let path = finder.path;
        let line = u64::from(header.line) + 1;
        let mut notes = Vec::new();
        let names = header.names.iter().map(|name| text_of(name));
        let names = names.collect::<Option<Vec<String>>>();
        let names = names.ok_or_else(|| LogError::line(path, line, NO_TEXT))?;
        let refused = |message: String| LogError::line(path, line, message);
        let found = Found {
            preamble: &header.preamble,
            sample: &header.sample,
            row_kind: RowKind::Line,
            topic: None,
        };
        let mut layout = Self::new(names, &found, finder).map_err(refused)?;
        if let Some((instances, message)) = layout.columns.several.take() {
            return Err(LogError::sources(path, Some(line), instances, message));
        }
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
        layout.columns.reading.notes = notes;
        let unit = layout.columns.time_unit;
        if unit.has_origin() {
            let cells = header.sample.iter();
            let mut cells = cells.filter_map(|row| unit.nanoseconds(row.get(layout.columns.time)?));
            layout.origin_ns = cells.next();
            layout.slots[0].conversion = Conversion::None;
            layout.converts = layout.has_conversion();
        }
        if let Some(joined) = &mut layout.joined {
            joined
                .align(unit, layout.origin_ns)
                .map_err(|message| LogError::file(path, message))?;
        }
        Ok(layout)
    }
}

const NO_TEXT: &str = "the header is no text: expected column names such as `time_s,temp_c,x_dph`";

/// A name as text. Bytes that are not UTF-8 are Latin-1, in which spreadsheets write `°`; a control
/// character among them says that they are no text.
fn text_of(name: &[u8]) -> Option<String> {
    let text = match str::from_utf8(name) {
        Ok(text) => text.to_owned(),
        Err(_) => {
            let text: String = name.iter().map(|&byte| char::from(byte)).collect();
            if text.contains(char::is_control) {
                return None;
            }
            text
        }
    };
    Some(text.trim().to_owned())
}
