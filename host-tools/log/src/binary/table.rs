//! The rows of one topic of a binary log, by source.

use std::collections::BTreeMap;

/// A type of numbers, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number at the start of some bytes, of which there are enough.
    pub(super) fn of(self, bytes: &[u8]) -> f64 {
        /// As many bytes as a type has.
        fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
            *bytes.first_chunk().expect("a row has all its fields")
        }
        match self {
            Self::I8 => i8::from_le_bytes(first(bytes)).into(),
            Self::U8 => u8::from_le_bytes(first(bytes)).into(),
            Self::I16 => i16::from_le_bytes(first(bytes)).into(),
            Self::U16 => u16::from_le_bytes(first(bytes)).into(),
            Self::I32 => i32::from_le_bytes(first(bytes)).into(),
            Self::U32 => u32::from_le_bytes(first(bytes)).into(),
            Self::I64 => i64::from_le_bytes(first(bytes)) as f64,
            Self::U64 => u64::from_le_bytes(first(bytes)) as f64,
            Self::F32 => f32::from_le_bytes(first(bytes)).into(),
            Self::F64 => f64::from_le_bytes(first(bytes)),
        }
    }
}

/// A field of a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) number: Number,
    /// Its place in the row \[bytes\].
    pub(super) offset: usize,
}

/// What the rows of a topic look like.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct RowFormat {
    /// The fields that are numbers.
    pub(super) fields: Vec<Field>,
    /// Size of a row \[bytes\].
    pub(super) size: usize,
}

impl RowFormat {
    pub(super) fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.name == name)
    }
}

/// A part of a file that is not as its format says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Damage {
    /// Where it begins \[bytes\].
    pub(super) offset: u64,
    /// What is wrong there.
    pub(super) what: String,
    /// Time of the last row before it \[s\].
    pub(super) after_s: Option<f64>,
}

/// The rows of a topic, as they stand in the file. So they take less room than numbers.
#[derive(Debug, Default)]
pub(super) struct Table {
    pub(super) format: RowFormat,
    /// For each source, its rows one after the other.
    pub(super) sources: BTreeMap<u32, Vec<u8>>,
    /// The first damaged part.
    pub(super) damage: Option<Damage>,
    /// Number of damaged parts.
    pub(super) damaged_parts: usize,
    /// Bytes in them.
    pub(super) damaged_bytes: u64,
    /// Topics with rows, for a file without rows of this one.
    pub(super) topics: Vec<String>,
    /// For each source that the log's parameters speak of, whether the autopilot corrects it for
    /// temperature.
    pub(super) corrected: BTreeMap<u32, bool>,
    /// Times of the last two rows of any source, the last one first \[s\].
    last_s: [Option<f64>; 2],
}

impl Table {
    /// Adds a row to a source.
    pub(super) fn push(&mut self, source: u32, row: &[u8], time: Option<&Field>) {
        let us = time.map(|field| field.number.of(&row[field.offset..]));
        self.last_s = [us.map(|us| us / 1e6), self.last_s[0]];
        self.sources
            .entry(source)
            .or_default()
            .extend_from_slice(row);
    }

    /// Takes the last row of a source back.
    pub(super) fn pop(&mut self, source: u32) {
        if let Some(rows) = self.sources.get_mut(&source) {
            rows.truncate(rows.len() - self.format.size);
            if rows.is_empty() {
                self.sources.remove(&source);
            }
            self.last_s = [self.last_s[1], None];
        }
    }

    /// Notes a damaged part.
    pub(super) fn damaged(&mut self, offset: u64, bytes: u64, what: String) {
        self.damaged_parts += 1;
        self.damaged_bytes += bytes;
        let after_s = self.last_s[0];
        self.damage.get_or_insert(Damage {
            offset,
            what,
            after_s,
        });
    }
}
