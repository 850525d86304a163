//! Columns of a Parquet file that hold times by their type: timestamps, times of day, durations.
//!
//! Parquet itself has no type for durations. Arrow writes its own schema into the file, a
//! FlatBuffer in base64, and there they are named. What is needed of it is read here.

use data_encoding::BASE64;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type as PhysicalType};
use parquet::file::metadata::FileMetaData;
use parquet::schema::types::ColumnDescriptor;

/// How integers of a column become seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TimeType {
    /// Units in a second.
    pub(super) per_second: i64,
    /// Whether they are points in time, to be counted from the first row.
    pub(super) is_instant: bool,
}

/// The type of each column; `None` if it holds no times.
pub(super) fn time_types(metadata: &FileMetaData) -> Vec<Option<TimeType>> {
    let durations = arrow_durations(metadata).unwrap_or_default();
    let of_column = |column: &std::sync::Arc<ColumnDescriptor>| {
        let duration = durations.iter().find(|(name, _)| name == column.name());
        let duration = duration.filter(|_| {
            column.path().parts().len() == 1 && column.physical_type() == PhysicalType::INT64
        });
        let per_second = duration.map(|&(_, per_second)| per_second);
        let is_instant = false;
        of_parquet(column).or(per_second.map(|per_second| TimeType {
            per_second,
            is_instant,
        }))
    };
    metadata
        .schema_descr()
        .columns()
        .iter()
        .map(of_column)
        .collect()
}

/// What the Parquet schema says.
fn of_parquet(column: &ColumnDescriptor) -> Option<TimeType> {
    let units = |unit: &TimeUnit| match unit {
        TimeUnit::MILLIS => 1_000,
        TimeUnit::MICROS => 1_000_000,
        TimeUnit::NANOS => 1_000_000_000,
    };
    let (per_second, is_instant) = match (column.logical_type_ref(), column.converted_type()) {
        (Some(LogicalType::Timestamp(of)), _) => (units(&of.unit), true),
        (Some(LogicalType::Time(of)), _) => (units(&of.unit), false),
        (None, ConvertedType::TIMESTAMP_MILLIS) => (1_000, true),
        (None, ConvertedType::TIMESTAMP_MICROS) => (1_000_000, true),
        (None, ConvertedType::TIME_MILLIS) => (1_000, false),
        (None, ConvertedType::TIME_MICROS) => (1_000_000, false),
        _ => return None,
    };
    Some(TimeType {
        per_second,
        is_instant,
    })
}

/// Names of the columns that are durations to Arrow, each with its units in a second; `None` if
/// there is no schema of Arrow that can be read.
///
/// The numbers of fields and types are those of `Message.fbs` and `Schema.fbs` of the Arrow format.
fn arrow_durations(metadata: &FileMetaData) -> Option<Vec<(String, i64)>> {
    const DURATION: u8 = 18;
    let pairs = metadata.key_value_metadata()?;
    let schema = pairs.iter().find(|pair| pair.key == "ARROW:schema")?;
    let bytes = BASE64.decode(schema.value.as_ref()?.as_bytes()).ok()?;
    // A mark of four bytes and a length come before the message; old writers leave out the mark.
    let start = if bytes.starts_with(&[0xff; 4]) { 8 } else { 4 };
    let bytes = bytes.get(start..)?;
    let message = Table::at(bytes, 0)?.follow(bytes)?;
    let schema = message.table(bytes, 2)?;
    let fields = schema.field(bytes, 1)?.checked_add(0)?;
    let fields = fields.checked_add(u32_at(bytes, fields)? as usize)?;
    let count = u32_at(bytes, fields)? as usize;
    let mut found = Vec::new();
    for number in 0..count.min(bytes.len() / 4) {
        let field = Table::at(bytes, fields + 4 + 4 * number)?.follow(bytes)?;
        if field.byte(bytes, 2) != Some(DURATION) {
            continue;
        }
        // Milliseconds are the default of the format, and then not written.
        let unit = field.table(bytes, 3)?.byte(bytes, 0).unwrap_or(1);
        let per_second = 1_000_i64.pow(unit.min(3).into());
        found.push((field.text(bytes, 0)?, per_second));
    }
    Some(found)
}

/// A table of a FlatBuffer, by its place.
#[derive(Clone, Copy)]
struct Table(usize);

impl Table {
    fn at(bytes: &[u8], at: usize) -> Option<Self> {
        (at < bytes.len()).then_some(Self(at))
    }

    /// The table that an offset leads to.
    fn follow(self, bytes: &[u8]) -> Option<Self> {
        Self::at(bytes, self.0.checked_add(u32_at(bytes, self.0)? as usize)?)
    }

    /// Place of a field; `None` if it has its default.
    fn field(self, bytes: &[u8], number: usize) -> Option<usize> {
        let back = u32_at(bytes, self.0)? as i32;
        let fields = usize::try_from(self.0 as i64 - i64::from(back)).ok()?;
        let place = fields + 4 + 2 * number;
        let len = u16_at(bytes, fields)?;
        if place + 2 > fields + usize::from(len) {
            return None;
        }
        match u16_at(bytes, place)? {
            0 => None,
            offset => Some(self.0 + usize::from(offset)),
        }
    }

    fn byte(self, bytes: &[u8], number: usize) -> Option<u8> {
        bytes.get(self.field(bytes, number)?).copied()
    }

    fn table(self, bytes: &[u8], number: usize) -> Option<Self> {
        Self(self.field(bytes, number)?).follow(bytes)
    }

    fn text(self, bytes: &[u8], number: usize) -> Option<String> {
        let Self(at) = self.table(bytes, number)?;
        let len = u32_at(bytes, at)? as usize;
        let text = bytes.get(at + 4..)?.get(..len)?;
        String::from_utf8(text.to_vec()).ok()
    }
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(
        bytes.get(at..)?.get(..2)?.try_into().ok()?,
    ))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(
        bytes.get(at..)?.get(..4)?.try_into().ok()?,
    ))
}
