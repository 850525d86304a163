//! Files of PX4: ULog.
//!
//! Format: <https://docs.px4.io/main/en/dev_log/ulog_file_format>. A header of 16 bytes, then
//! records: size (u16), type (u8), content. There is no checksum: what is checked is that records
//! follow each other, and that their sizes are those of their formats.

use std::collections::{BTreeSet, HashMap};
use std::io::{self, Read};

use super::table::{Field, Number, RowFormat, Table};
use super::window::Window;

/// The first bytes of a file; the next one is the version.
const MAGIC: [u8; 7] = *b"ULog\x01\x12\x35";

const HEADER_BYTES: usize = 16;

/// Size and type before the content of a record \[bytes\].
const RECORD_HEADER_BYTES: usize = 3;

/// The topic that is read.
pub(super) const TOPIC: &str = "sensor_gyro";

/// Formats within formats; PX4 has two.
const MOST_LEVELS: usize = 8;

/// The only feature in a file that a reader must know: records after the end, written in a crash.
const APPENDED: u8 = 1;

/// The rows of gyros in a file; the first damaged part ends them.
///
/// # Errors
/// Those of reading.
pub(super) fn read<R: Read>(window: &mut Window<R>) -> io::Result<Table> {
    let mut reader = Reader::default();
    let what = reader.records(window)?;
    let mut table = reader.table;
    if let Err(what) = what {
        // The row before may have lost bytes, and taken some of the next record.
        let suspect = reader.last_row.map_or(0, |(source, size)| {
            table.pop(source);
            size
        });
        let offset = window.offset() - suspect;
        let bytes = window.pass_all()? + suspect;
        table.damaged(offset, bytes, what);
    }
    table.topics = reader.with_rows.into_iter().collect();
    Ok(table)
}

#[derive(Default)]
struct Reader {
    table: Table,
    /// Fields of each format, as they are written.
    formats: HashMap<String, Vec<FieldText>>,
    /// Topics of the numbers that rows begin with.
    topics: HashMap<u16, Topic>,
    /// Where records that were appended begin \[bytes\].
    appended: Vec<u64>,
    /// Source and size \[bytes\] of the row that the last record was.
    last_row: Option<(u32, u64)>,
    /// Topics that have rows.
    with_rows: BTreeSet<String>,
}

/// A field: its type, how many there are, and its name.
#[derive(Clone, PartialEq)]
struct FieldText {
    kind: String,
    count: Option<usize>,
    name: String,
}

struct Topic {
    name: String,
    format: RowFormat,
    /// Size of a row without the padding at its end, which is not written \[bytes\].
    least_size: usize,
    source: u32,
    is_known: bool,
}

impl Reader {
    /// Reads all records; the inner error is what is wrong where the window stands.
    fn records<R: Read>(&mut self, window: &mut Window<R>) -> io::Result<Result<(), String>> {
        let header = window.peek(HEADER_BYTES)?;
        if header.len() < HEADER_BYTES {
            return Ok(Err(cut(HEADER_BYTES, header.len())));
        }
        if !header.starts_with(&MAGIC) {
            return Ok(Err("the header of a ULog file was expected".to_owned()));
        }
        window.pass(HEADER_BYTES);
        loop {
            let offset = window.offset();
            let found = window.peek(RECORD_HEADER_BYTES)?;
            let size = match *found {
                [] => return Ok(Ok(())),
                [low, high, _] => {
                    RECORD_HEADER_BYTES + usize::from(u16::from_le_bytes([low, high]))
                }
                _ => return Ok(Err(cut(RECORD_HEADER_BYTES, found.len()))),
            };
            let record = window.peek(size)?;
            // A record may be cut off where the appended ones begin.
            let next = offset..offset + size as u64;
            let begin = self.appended.iter().find(|&begin| next.contains(begin));
            if let Some(begin) = begin.filter(|&&begin| begin > offset) {
                let left = (begin - offset) as usize;
                if record.len() >= left {
                    window.pass(left);
                    continue;
                }
            }
            if record.len() < size {
                return Ok(Err(cut(size, record.len())));
            }
            if let Err(what) = self.record(record[2], &record[RECORD_HEADER_BYTES..]) {
                return Ok(Err(what));
            }
            window.pass(size);
        }
    }

    /// Reads a record.
    ///
    /// # Errors
    /// What is wrong with it.
    fn record(&mut self, kind: u8, content: &[u8]) -> Result<(), String> {
        let before = self.last_row.take();
        let found = self.content(kind, content);
        if found.is_err() {
            self.last_row = before;
        }
        found
    }

    fn content(&mut self, kind: u8, content: &[u8]) -> Result<(), String> {
        // Least and greatest size of what is not needed: a spoilt size or type shows in it.
        let sizes = match kind {
            b'B' => return self.flags(content),
            b'F' => return self.format(content),
            b'A' => return self.topic(content),
            b'D' => return self.row(content),
            b'R' => 2..=2,
            b'S' => 8..=8,
            b'O' => 2..=2,
            b'L' => 9..=usize::MAX,
            b'C' => 11..=usize::MAX,
            b'I' | b'P' => 2..=usize::MAX,
            b'M' | b'Q' => 3..=usize::MAX,
            other => {
                return Err(format!(
                    "a record of the unknown type `{}`",
                    other.escape_ascii()
                ));
            }
        };
        // The text of a key, after its length.
        let key = match kind {
            b'I' | b'P' => Some(0),
            b'M' | b'Q' => Some(1),
            _ => None,
        };
        let has_key = key.is_none_or(|at| {
            let length = content.get(at).map_or(0, |&length| usize::from(length));
            let key = content.get(at + 1..at + 1 + length).unwrap_or_default();
            key.contains(&b' ')
                && key
                    .iter()
                    .all(|byte| byte.is_ascii_graphic() || *byte == b' ')
        });
        let has_level = !matches!(kind, b'L' | b'C')
            || content
                .first()
                .is_some_and(|level| (b'0'..=b'7').contains(level));
        if !sizes.contains(&content.len()) || !has_key || !has_level {
            return Err(format!(
                "a spoilt record of the type `{}`",
                kind.escape_ascii()
            ));
        }
        Ok(())
    }

    fn flags(&mut self, content: &[u8]) -> Result<(), String> {
        let (Some(flags), Some(offsets)) = (content.get(8..16), content.get(16..40)) else {
            return Err(cut(40, content.len()));
        };
        if flags[0] & !APPENDED != 0 || flags[1..].iter().any(|&flag| flag != 0) {
            return Err("features of a later version of ULog: expected flags 0 or 1".to_owned());
        }
        if flags[0] & APPENDED != 0 {
            let (offsets, _) = offsets.as_chunks();
            let offsets = offsets.iter().map(|&bytes| u64::from_le_bytes(bytes));
            self.appended = offsets.filter(|&offset| offset > 0).collect();
        }
        Ok(())
    }

    /// `NAME:TYPE FIELD;TYPE[COUNT] FIELD;`
    fn format(&mut self, content: &[u8]) -> Result<(), String> {
        let spoilt = || {
            format!(
                "a spoilt format `{}`",
                super::super::excerpt::excerpt_of_bytes(content)
            )
        };
        let text = str::from_utf8(content).ok().filter(|text| text.is_ascii());
        let (name, fields) = text
            .and_then(|text| text.split_once(':'))
            .ok_or_else(spoilt)?;
        let fields = fields
            .split(';')
            .filter(|field| !field.is_empty())
            .map(field);
        let fields = fields.collect::<Option<Vec<_>>>().ok_or_else(spoilt)?;
        if !is_name(name) || fields.is_empty() {
            return Err(spoilt());
        }
        match self.formats.insert(name.to_owned(), fields.clone()) {
            Some(before) if before != fields => Err(format!("a second format of `{name}`")),
            _ => Ok(()),
        }
    }

    fn topic(&mut self, content: &[u8]) -> Result<(), String> {
        let (Some(&[source, low, high]), Some(name)) = (content.first_chunk(), content.get(3..))
        else {
            return Err(cut(4, content.len()));
        };
        let name = str::from_utf8(name).unwrap_or_default();
        let mut format = RowFormat::default();
        let padding = self.resolve(name, "", &mut format, 0);
        let padding = padding.filter(|_| format.size > 0);
        let padding = padding
            .ok_or_else(|| format!("a topic of the unknown format `{}`", name.escape_debug()))?;
        let is_known = name == TOPIC;
        let topic = Topic {
            name: name.to_owned(),
            least_size: format.size - padding,
            format,
            source: source.into(),
            is_known,
        };
        if is_known && self.table.format.fields.is_empty() {
            self.table.format = RowFormat {
                size: topic.least_size,
                ..topic.format.clone()
            };
        }
        let number = u16::from_le_bytes([low, high]);
        match self.topics.insert(number, topic) {
            Some(before) if (&before.name[..], before.source) != (name, source.into()) => {
                Err(format!("a second topic with the number {number}"))
            }
            _ => Ok(()),
        }
    }

    /// Adds the fields of a format to a row; returns the size of the padding at its end, or `None`
    /// if the format is not sound.
    fn resolve(
        &self,
        name: &str,
        prefix: &str,
        row: &mut RowFormat,
        level: usize,
    ) -> Option<usize> {
        let mut padding = 0;
        for field in self.formats.get(name).filter(|_| level < MOST_LEVELS)? {
            let from = row.size;
            for number in 0..field.count.unwrap_or(1) {
                let name = match field.count {
                    Some(_) => format!("{prefix}{}[{number}]", field.name),
                    None => format!("{prefix}{}", field.name),
                };
                match number_type(&field.kind) {
                    Some(number) => {
                        let offset = row.size;
                        row.size += number.size();
                        row.fields.push(Field {
                            name,
                            number,
                            offset,
                        });
                    }
                    None => {
                        self.resolve(&field.kind, &format!("{name}."), row, level + 1)?;
                    }
                }
                // More than a record can hold.
                if row.size > usize::from(u16::MAX) {
                    return None;
                }
            }
            let is_padding = field.name.starts_with("_padding");
            padding = if is_padding { row.size - from } else { 0 };
        }
        row.fields.retain(|field| !field.name.contains("_padding"));
        Some(padding)
    }

    fn row(&mut self, content: &[u8]) -> Result<(), String> {
        let Some((&[low, high], row)) = content.split_first_chunk() else {
            return Err(cut(2, content.len()));
        };
        let number = u16::from_le_bytes([low, high]);
        let topic = self.topics.get(&number);
        let topic = topic.ok_or_else(|| format!("a row of the unknown topic {number}"))?;
        if row.len() != topic.format.size && row.len() != topic.least_size {
            return Err(format!(
                "a row of {} bytes: expected {} of `{}`",
                row.len(),
                topic.least_size,
                topic.name
            ));
        }
        if topic.is_known {
            let size = RECORD_HEADER_BYTES + content.len();
            self.last_row = Some((topic.source, size as u64));
            let row = &row[..topic.least_size];
            self.table
                .push(topic.source, row, topic.format.field("timestamp"));
        }
        if !self.with_rows.contains(&topic.name) {
            self.with_rows.insert(topic.name.clone());
        }
        Ok(())
    }
}

fn cut(expected: usize, found: usize) -> String {
    format!("{found} bytes left of {expected} (was it cut off?)")
}

fn is_name(name: &str) -> bool {
    let is_in_name = |letter: char| letter.is_ascii_alphanumeric() || "_-/".contains(letter);
    !name.is_empty() && name.chars().all(is_in_name)
}

/// `TYPE NAME` or `TYPE[COUNT] NAME`.
fn field(text: &str) -> Option<FieldText> {
    let (kind, name) = text.split_once(' ')?;
    let (kind, count) = match kind.split_once('[') {
        Some((kind, count)) => (
            kind,
            Some(
                count
                    .strip_suffix(']')?
                    .parse()
                    .ok()
                    .filter(|count| *count > 0)?,
            ),
        ),
        None => (kind, None),
    };
    (is_name(kind) && is_name(name)).then(|| FieldText {
        kind: kind.to_owned(),
        count,
        name: name.to_owned(),
    })
}

fn number_type(kind: &str) -> Option<Number> {
    Some(match kind {
        "int8_t" => Number::I8,
        "uint8_t" | "bool" | "char" => Number::U8,
        "int16_t" => Number::I16,
        "uint16_t" => Number::U16,
        "int32_t" => Number::I32,
        "uint32_t" => Number::U32,
        "int64_t" => Number::I64,
        "uint64_t" => Number::U64,
        "float" => Number::F32,
        "double" => Number::F64,
        _ => return None,
    })
}
