//! The rows of one source of a binary log, as numbers.

use std::path::Path;
use std::sync::Arc;

use super::super::doubt::DoubtKind;
use super::super::layout::{Finder, Found, Layout, RowKind};
use super::super::order::{Bad, Parsed};
use super::super::skipped::Reason;
use super::super::slot::Kind;
use super::super::source::{Format, Source};
use super::super::{AxisUnit, ColumnUnit, LogError};
use super::table::{Field, RowFormat, Table};
use super::window::Window;
use super::{dataflash, ulog};

/// Gyros of autopilots end at 70 rad/s. What is beyond this \[rad/s\] is damage.
const FASTEST_RADPS: f64 = 100.0;

/// The rows of a source, some at a time.
pub(in super::super) struct BinaryRows {
    layout: Arc<Layout>,
    format: RowFormat,
    /// For each slot, its field.
    fields: Vec<Field>,
    /// All rows as they stand in the file.
    bytes: Vec<u8>,
    /// Rows read so far.
    row: usize,
    rows_at_a_time: usize,
    skip_bad_rows: bool,
    /// Damaged parts that were left out and are not counted yet.
    damaged_parts: usize,
    sha256: String,
}

impl BinaryRows {
    /// Reads the file and chooses a source.
    ///
    /// # Errors
    /// A damaged file, unless bad rows are skipped; no rows of gyros; several sources of which none
    /// was chosen; an autopilot that corrects its gyros for temperature.
    pub(in super::super) fn open(
        source: Source,
        finder: &Finder,
        skip_bad_rows: bool,
        rows_at_a_time: usize,
    ) -> Result<(Self, Arc<Layout>), LogError> {
        let (path, format) = (finder.path, source.format);
        let failed = |cause| format.error(path, cause);
        let mut window = Window::new(source.text());
        let (table, topic) = match format {
            Format::Ulog => (ulog::read(&mut window), ulog::TOPIC),
            _ => (dataflash::read(&mut window), dataflash::TOPIC),
        };
        let mut table = table.map_err(failed)?;
        let sha256 = window.into_inner().sha256().map_err(failed)?;
        if !skip_bad_rows {
            refuse_damage(path, &table)?;
        }
        if table.sources.is_empty() {
            return Err(LogError::file(path, no_rows(topic, &table)));
        }

        let header = table.format.fields.iter().map(|field| field.name.clone());
        let found = Found {
            preamble: &[],
            sample: &[],
            row_kind: RowKind::Row,
            topic: Some(topic),
        };
        let refused = |message: String| LogError::file(path, message);
        let mut layout = Layout::new(header.collect(), &found, finder).map_err(refused)?;
        let source = choose(path, &layout, &table)?;
        let bytes = table.sources.remove(&source).unwrap_or_default();
        check_correction(path, source, &table, &mut layout)?;
        if let Some(joined) = &mut layout.joined {
            joined
                .align(layout.columns.time_unit, None)
                .map_err(refused)?;
        }
        if let Some(damage) = &table.damage {
            let (parts, lost) = (table.damaged_parts, table.damaged_bytes);
            let offset = damage.offset;
            let notes = &mut layout.columns.reading.notes;
            notes.push(match format {
                Format::Ulog => {
                    format!("damaged at byte {offset}: the {lost} bytes from there on are not read")
                }
                _ => format!(
                    "damaged parts left out: {parts}, of {lost} bytes, the first at byte {offset}"
                ),
            });
        }
        let fields = layout.slots.iter();
        let fields = fields
            .map(|slot| table.format.fields[slot.position].clone())
            .collect();
        let layout = Arc::new(layout);
        let rows = Self {
            fields,
            format: table.format,
            layout: Arc::clone(&layout),
            bytes,
            row: 0,
            rows_at_a_time,
            skip_bad_rows,
            damaged_parts: table.damaged_parts,
            sha256,
        };
        rows.refuse_no_temperature()?;
        Ok((rows, layout))
    }

    /// The next rows, or the hash of the file at its end.
    pub(in super::super) fn next(&mut self) -> Result<Parsed, String> {
        let left = self.bytes.len() / self.format.size - self.row;
        if left == 0 {
            return Err(std::mem::take(&mut self.sha256));
        }
        let rows = left.min(self.rows_at_a_time);
        let first = self.row;
        self.row += rows;
        let place = (first as u64 + 1, rows);
        let mut parsed =
            Parsed::of_table(&self.layout, place, self.skip_bad_rows, |row, values| {
                self.values(first + row, values).map(|()| true)
            });
        parsed.skipped.damaged = std::mem::take(&mut self.damaged_parts);
        Ok(parsed)
    }

    /// The values of a row, in the order of the slots.
    fn values(&self, row: usize, values: &mut [f64]) -> Result<(), Box<Bad>> {
        let bytes = &self.bytes[row * self.format.size..];
        let mut time_s = None;
        let slots = self.layout.slots.iter().zip(&self.fields).zip(values);
        for ((slot, field), value) in slots {
            let checked = Layout::checked(slot, field.number.of(&bytes[field.offset..]));
            let checked = checked.and_then(|value| match slot.kind {
                Kind::Axis(axis) => match too_fast(&self.layout, axis, value) {
                    Some(message) => Err((Reason::OutOfRange, message)),
                    None => Ok(value),
                },
                _ => Ok(value),
            });
            *value = checked.map_err(|objection| {
                let row = (row as u64 + 1, time_s);
                Bad::of_cell(&self.layout, row, slot.position, objection)
            })?;
            time_s.get_or_insert(*value);
        }
        Ok(())
    }

    /// Some chips have no thermometer.
    fn refuse_no_temperature(&self) -> Result<(), LogError> {
        for (slot, field) in self.layout.slots.iter().zip(&self.fields) {
            let mut rows = self.bytes.chunks_exact(self.format.size);
            if matches!(slot.kind, Kind::Temp(_))
                && rows.all(|row| field.number.of(&row[field.offset..]).is_nan())
            {
                let message = format!(
                    "no row has a temperature in `{}`: the chip has no thermometer. Expected \
                     temperatures by --join FILE, or another --instance",
                    field.name
                );
                return Err(LogError::file(&self.layout.path, message));
            }
        }
        Ok(())
    }
}

/// Refuses a damaged file with the place and the way on.
fn refuse_damage(path: &Path, table: &Table) -> Result<(), LogError> {
    let Some(damage) = &table.damage else {
        return Ok(());
    };
    let after = match damage.after_s {
        Some(time_s) => format!("the last good row before it is at {time_s} s"),
        None => "there is no good row before it".to_owned(),
    };
    let more = match table.damaged_parts {
        1 => String::new(),
        parts => format!(", and {} more parts are damaged", parts - 1),
    };
    Err(LogError::file(
        path,
        format!(
            "damaged at byte {}: {}; {after}{more}. --skip-bad-rows reads what is sound: the rows \
             before it of a .ulg, all but the damaged parts of a .bin",
            damage.offset, damage.what
        ),
    ))
}

fn no_rows(topic: &str, table: &Table) -> String {
    let found = match &table.topics[..] {
        [] => "no other rows".to_owned(),
        topics => format!("rows of {}", super::super::list_names(topics)),
    };
    format!("no rows of `{topic}`: expected a log with them; it has {found}")
}

/// The source that was named, by `--instance` or `--where`, or the only one.
fn choose(path: &Path, layout: &Layout, table: &Table) -> Result<u32, LogError> {
    let instances: Vec<u32> = table.sources.keys().copied().collect();
    let mut filters = layout.columns.filters.iter();
    let filter = filters.next().map(|filter| {
        let value = str::from_utf8(&filter.value)
            .ok()
            .and_then(|text| text.parse().ok());
        value.filter(|_| Some(filter.position) == layout.columns.source_position)
    });
    let chosen = match (layout.columns.instance, filter, filters.next()) {
        (chosen, None, _) => chosen,
        (None, Some(Some(chosen)), None) => Some(chosen),
        _ => {
            let message = "--where: expected --instance N, or a log as text";
            return Err(LogError::file(path, message));
        }
    };
    match (chosen, &instances[..]) {
        (Some(chosen), _) if instances.contains(&chosen) => Ok(chosen),
        (Some(chosen), _) => {
            let message = format!("no instance {chosen}; there are {}", in_words(&instances));
            Err(LogError::file(path, message))
        }
        (None, &[only]) => Ok(only),
        (None, _) => {
            let message = format!(
                "the instances {} of the sensor are in it: choose one by --instance {}",
                in_words(&instances),
                instances[0]
            );
            Err(LogError::sources(path, None, instances, message))
        }
    }
}

fn in_words(instances: &[u32]) -> String {
    let names: Vec<String> = instances.iter().map(u32::to_string).collect();
    names.join(", ")
}

/// Refuses rows that the autopilot corrected; says nothing of that where it did not.
fn check_correction(
    path: &Path,
    source: u32,
    table: &Table,
    layout: &mut Layout,
) -> Result<(), LogError> {
    match table.corrected.get(&source) {
        Some(true) => {
            let number = source + 1;
            let message = format!(
                "INS_TCAL{number}_ENABLE is 1: the autopilot corrected the gyros of instance \
                 {source} for temperature already. Expected a log with INS_TCAL{number}_ENABLE at 0"
            );
            Err(LogError::file(path, message))
        }
        Some(false) => {
            let doubts = &mut layout.columns.reading.doubts;
            doubts.retain(|doubt| doubt.kind != DoubtKind::OwnCorrection);
            Ok(())
        }
        None => Ok(()),
    }
}

fn too_fast(layout: &Layout, axis: usize, value: f64) -> Option<String> {
    let mut axes = layout
        .columns
        .channels
        .iter()
        .flat_map(|channel| &channel.axes);
    let is_rate = axes.nth(axis)?.unit == ColumnUnit::Direct(AxisUnit::Radps);
    (is_rate && value.abs() > FASTEST_RADPS)
        .then(|| format!("{value}: expected {FASTEST_RADPS} rad/s at most (is the file damaged?)"))
}
