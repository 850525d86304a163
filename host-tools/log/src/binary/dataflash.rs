//! Files of ArduPilot: DataFlash.
//!
//! Format: <https://ardupilot.org/copter/docs/logmessages.html> and the firmware's AP_Logger.
//! Messages: 0xA3 0x95, type (u8), content. Messages FMT say the size and the fields of each type.
//! There is no checksum. A message counts only where another one, or the end of the file, follows.

use std::collections::BTreeMap;
use std::io::{self, Read};

use super::table::{Field, Number, RowFormat, Table};
use super::window::Window;

/// The messages that are read.
pub(super) const TOPIC: &str = "IMU";

/// The first bytes of a message.
const MAGIC: [u8; 2] = [0xa3, 0x95];

/// Magic and type before the content \[bytes\].
const HEADER_BYTES: usize = 3;

/// Type of the messages that describe the others.
const FMT: u8 = 0x80;

/// Size of such a message \[bytes\].
const FMT_BYTES: usize = 89;

/// Greatest size of a message, and the header of the next one \[bytes\].
const LOOK_AHEAD: usize = 255 + HEADER_BYTES;

/// The rows of IMUs in a file; damaged parts are left out.
///
/// # Errors
/// Those of reading.
pub(super) fn read<R: Read>(window: &mut Window<R>) -> io::Result<Table> {
    let mut reader = Reader {
        table: Table::default(),
        kinds: [const { None }; 256],
        names: BTreeMap::new(),
    };
    reader.kinds[usize::from(FMT)] = Some(Kind {
        size: FMT_BYTES,
        job: Job::Format,
    });
    loop {
        let offset = window.offset();
        let bytes = window.peek(LOOK_AHEAD)?;
        if bytes.is_empty() {
            break;
        }
        let what = match reader.message(bytes) {
            Ok(size) => {
                window.pass(size);
                continue;
            }
            Err(what) => what,
        };
        // The next place at which a message begins that another one follows.
        window.pass(1);
        while !window.peek(LOOK_AHEAD)?.is_empty()
            && reader.whole(window.peek(LOOK_AHEAD)?).is_err()
        {
            window.pass(1);
        }
        reader.table.damaged(offset, window.offset() - offset, what);
    }
    reader.table.topics = reader.names.into_keys().collect();
    Ok(reader.table)
}

struct Reader {
    table: Table,
    /// What is known of each type.
    kinds: [Option<Kind>; 256],
    /// The types by name.
    names: BTreeMap<String, u8>,
}

struct Kind {
    /// Size with the header \[bytes\].
    size: usize,
    job: Job,
}

/// What a message is for.
enum Job {
    Format,
    /// A row of the sources that the field numbers, or of this one.
    Row {
        numbered_by: Option<Field>,
        source: u32,
        time: Option<Field>,
    },
    /// A parameter, with the places of its name and value.
    Parameter {
        name: usize,
        value: Field,
    },
    None,
}

impl Reader {
    /// Reads the message at the start of some bytes; returns its size.
    ///
    /// # Errors
    /// What is wrong with it.
    fn message(&mut self, bytes: &[u8]) -> Result<usize, String> {
        let begins = bytes.starts_with(&[MAGIC[0], MAGIC[1], FMT]);
        if let Some(content) = bytes.get(HEADER_BYTES..FMT_BYTES).filter(|_| begins) {
            // Before the next one is looked at: it may be the first of its type.
            self.format(content)?;
        }
        let size = self.whole(bytes)?;
        let content = &bytes[HEADER_BYTES..size];
        match self.kinds[usize::from(bytes[2])]
            .as_ref()
            .map(|kind| &kind.job)
        {
            Some(Job::Row {
                numbered_by,
                source,
                time,
            }) => {
                let number = |field: &Field| field.number.of(&content[field.offset..]) as u32;
                let source = numbered_by.as_ref().map_or(*source, number);
                self.table.push(source, content, time.as_ref());
            }
            Some(Job::Parameter { name, value }) => {
                let name = text(&content[*name..*name + 16]);
                let value = value.number.of(&content[value.offset..]);
                self.parameter(&name, value);
            }
            _ => {}
        }
        Ok(size)
    }

    /// The size of the message at the start of some bytes, if another one or the end follows.
    ///
    /// # Errors
    /// What is wrong with it.
    fn whole(&self, bytes: &[u8]) -> Result<usize, String> {
        let size = self.size(bytes)?;
        match bytes.get(size..) {
            None => Err(format!(
                "{} bytes left of {size} (was it cut off?)",
                bytes.len()
            )),
            Some([]) => Ok(size),
            Some(next) => match self.size(next) {
                Ok(_) => Ok(size),
                Err(what) => Err(format!("after a message of {size} bytes: {what}")),
            },
        }
    }

    /// The size of the message that begins here.
    fn size(&self, bytes: &[u8]) -> Result<usize, String> {
        match *bytes {
            [first, second, kind, ..] if [first, second] == MAGIC => {
                let of = self.kinds[usize::from(kind)].as_ref();
                of.map(|kind| kind.size)
                    .ok_or_else(|| format!("a message of the unknown type {kind}"))
            }
            _ if MAGIC.starts_with(&bytes[..bytes.len().min(2)]) && bytes.len() < HEADER_BYTES => {
                Err(format!(
                    "{} bytes left of a message (was it cut off?)",
                    bytes.len()
                ))
            }
            _ => Err("no message begins here".to_owned()),
        }
    }

    /// Learns a type: its number, size, name of 4 letters, 16 types of fields, 64 letters of names.
    fn format(&mut self, content: &[u8]) -> Result<(), String> {
        let (number, size) = (content[0], usize::from(content[1]));
        let (name, types, labels) = (
            text(&content[2..6]),
            text(&content[6..22]),
            text(&content[22..86]),
        );
        let spoilt = || format!("a spoilt format of `{}`", name.escape_debug());
        let row = row_format(&types, &labels);
        let is_row = matches!(&name[..], "IMU" | "IMU2" | "IMU3");
        let is_sound = row
            .as_ref()
            .is_some_and(|row| row.size + HEADER_BYTES == size && (!is_row || has_types(row)));
        if size < HEADER_BYTES || name.is_empty() || (!is_sound && (is_row || name == "PARM")) {
            return Err(spoilt());
        }
        if let Some(known) = self.names.insert(name.clone(), number)
            && known != number
        {
            return Err(format!("two formats of `{}`", name.escape_debug()));
        }
        if number == FMT {
            return if size == FMT_BYTES {
                Ok(())
            } else {
                Err(spoilt())
            };
        }
        let job = match row {
            Some(row) if is_row => {
                let is_new = self.table.format.fields.is_empty();
                if is_new {
                    self.table.format = row.clone();
                } else if self.table.format != row {
                    return Err(format!("`{name}` has other fields than the IMU before"));
                }
                Job::Row {
                    numbered_by: row.field("I").cloned(),
                    source: name[3..].parse().map_or(0, |number: u32| number - 1),
                    time: row.field("TimeUS").cloned(),
                }
            }
            Some(row) if name == "PARM" => {
                match (place(&types, &labels, "Name", 'N'), row.field("Value")) {
                    (Some(name), Some(value)) => Job::Parameter {
                        name,
                        value: value.clone(),
                    },
                    _ => return Err(spoilt()),
                }
            }
            _ => Job::None,
        };
        match self.kinds[usize::from(number)].replace(Kind { size, job }) {
            Some(before) if before.size != size => Err(spoilt()),
            _ => Ok(()),
        }
    }

    /// `INS_TCALn_ENABLE` is 1 where IMU n is corrected, counted from 1. The parameters stand at the
    /// start of a log, and again where they change.
    fn parameter(&mut self, name: &str, value: f64) {
        let number = name
            .strip_prefix("INS_TCAL")
            .and_then(|rest| rest.strip_suffix("_ENABLE"));
        let number = number.and_then(|number| number.parse::<u32>().ok()?.checked_sub(1));
        if let Some(source) = number {
            *self.table.corrected.entry(source).or_default() |= value == 1.0;
        }
    }
}

/// Letters up to the first NUL.
fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&byte| byte == 0);
    String::from_utf8_lossy(&bytes[..end.unwrap_or(bytes.len())]).into_owned()
}

/// Size of a field \[bytes\], and its type if it is a number without a factor.
fn field_type(letter: char) -> Option<(usize, Option<Number>)> {
    let number = match letter {
        'b' => Number::I8,
        'B' | 'M' => Number::U8,
        'h' => Number::I16,
        'H' => Number::U16,
        'i' => Number::I32,
        'I' => Number::U32,
        'f' => Number::F32,
        'd' => Number::F64,
        'q' => Number::I64,
        'Q' => Number::U64,
        // Hundredths, degrees, text and lists.
        'c' | 'C' => return Some((2, None)),
        'e' | 'E' | 'L' | 'n' => return Some((4, None)),
        'N' => return Some((16, None)),
        'Z' | 'a' => return Some((64, None)),
        'g' => return Some((2, None)),
        _ => return None,
    };
    Some((number.size(), Some(number)))
}

/// The fields of a message; `None` if types and names do not fit.
fn row_format(types: &str, labels: &str) -> Option<RowFormat> {
    let mut row = RowFormat::default();
    let mut names = labels.split(',');
    for letter in types.chars() {
        let (size, number) = field_type(letter)?;
        let name = names.next().filter(|name| !name.is_empty())?;
        if let Some(number) = number {
            row.fields.push(Field {
                name: name.to_owned(),
                number,
                offset: row.size,
            });
        }
        row.size += size;
    }
    names.next().is_none().then_some(row)
}

/// Whether the fields of an IMU have the types that they always had. All IMUs that call their
/// temperature T have a number.
fn has_types(row: &RowFormat) -> bool {
    let is_expected = |field: &Field| match &field.name[..] {
        "TimeUS" => field.number == Number::U64,
        "TimeMS" => field.number == Number::U32,
        "I" => field.number == Number::U8,
        "GyrX" | "GyrY" | "GyrZ" | "AccX" | "AccY" | "AccZ" | "T" | "Temp" => {
            field.number == Number::F32
        }
        _ => true,
    };
    row.fields.iter().all(is_expected) && (row.field("T").is_none() || row.field("I").is_some())
}

/// The place of a field of a type in a message \[bytes\].
fn place(types: &str, labels: &str, wanted: &str, kind: char) -> Option<usize> {
    let mut offset = 0;
    for (letter, name) in types.chars().zip(labels.split(',')) {
        if name == wanted {
            return (letter == kind).then_some(offset);
        }
        offset += field_type(letter)?.0;
    }
    None
}
