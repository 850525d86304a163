//! Rows of a log, column by column.

use super::slot::Kind;

/// Some consecutive rows of a log.
///
/// Channel after channel, and the axes within each, in the order of [`Log`](super::Log).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chunk {
    /// Time of each row \[s\], strictly increasing, also from chunk to chunk.
    pub time_s: Vec<f64>,
    /// For each channel, the temperature of each row \[degC\], as the core sees it.
    pub temps_c: Vec<Vec<f32>>,
    /// For each axis of each channel, the value of each row in the unit of its column.
    pub axes: Vec<Vec<f64>>,
}

impl Chunk {
    pub(super) fn with_capacity(channels: usize, axes: usize, rows: usize) -> Self {
        Self {
            time_s: Vec::with_capacity(rows),
            temps_c: vec![Vec::with_capacity(rows); channels],
            axes: vec![Vec::with_capacity(rows); axes],
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.time_s.len()
    }

    /// Adds values to the column of a kind.
    pub(super) fn extend(&mut self, kind: Kind, values: impl Iterator<Item = f64>) {
        match kind {
            Kind::Time => self.time_s.extend(values),
            Kind::Temp(channel) => self.temps_c[channel].extend(values.map(|value| value as f32)),
            Kind::Axis(axis) => self.axes[axis].extend(values),
        }
    }

    /// Appends the rows of another chunk.
    pub fn append(&mut self, other: &Self) {
        self.time_s.extend_from_slice(&other.time_s);
        for (column, more) in self.temps_c.iter_mut().zip(&other.temps_c) {
            column.extend_from_slice(more);
        }
        for (column, more) in self.axes.iter_mut().zip(&other.axes) {
            column.extend_from_slice(more);
        }
    }

    /// Takes the rows from `row` on out of the chunk.
    pub(super) fn split_off(&mut self, row: usize) -> Self {
        Self {
            time_s: self.time_s.split_off(row),
            temps_c: self.temps_c.iter_mut().map(|c| c.split_off(row)).collect(),
            axes: self.axes.iter_mut().map(|c| c.split_off(row)).collect(),
        }
    }

    /// The bits of all temperatures and axes of a row.
    pub(super) fn bits(&self, row: usize) -> Vec<u64> {
        let temps = self.temps_c.iter().filter_map(|column| column.get(row));
        let axes = self.axes.iter().map(|column| column[row].to_bits());
        temps
            .map(|temp_c| temp_c.to_bits().into())
            .chain(axes)
            .collect()
    }

    /// Leaves out the rows that are not to be kept.
    pub(super) fn retain(&mut self, keep: &[bool]) {
        retain(&mut self.time_s, keep);
        self.temps_c.iter_mut().for_each(|c| retain(c, keep));
        self.axes.iter_mut().for_each(|c| retain(c, keep));
    }
}

/// Leaves out the values that are not to be kept.
fn retain<T>(column: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    column.retain(|_| keep.next().is_some_and(|&keep| keep));
}
