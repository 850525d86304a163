//! The table of a channel as data: what JSON holds, what the core borrows, what the CRC covers.

use crate::history::{PlayData, SlowPartData};
use serde::{Deserialize, Serialize};
use tempco::{Table, TableError, Terms, Thermal, ThermalSettings};
use tempco_image::CRC;

/// A table of the core with as many cells and axes as needed; [`use_tables`](crate::use_tables) makes
/// the core's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableData {
    /// Settings of the thermal path.
    pub thermal: ThermalSettings,
    /// Cold edge of the first cell \[degC\].
    pub first_edge_c: f32,
    /// Hot edge of the last cell \[degC\].
    pub last_edge_c: f32,
    /// Cold end of the calibrated range \[degC\].
    pub t_min_c: f32,
    /// Hot end of the calibrated range \[degC\].
    pub t_max_c: f32,
    /// Coefficients by cell and axis, in the basis of the cell (0 at its cold edge, 1 at its hot
    /// edge); in JSON as arrays in the order of [`Terms::NAMES`].
    pub cells: Vec<Vec<Terms>>,
    /// Hysteresis terms, at most two.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plays: Vec<PlayData>,
    /// Second lags, at most one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slow_parts: Vec<SlowPartData>,
}

impl TableData {
    /// Number of axes.
    pub(crate) fn axes(&self) -> usize {
        self.cells.first().map_or(0, Vec::len)
    }

    /// The cells of `AXES` axes from the first of `axes` on, as the core borrows them.
    ///
    /// # Panics
    /// If the table has fewer axes.
    pub fn terms<const AXES: usize>(&self, first_axis: usize) -> Vec<[Terms; AXES]> {
        let cells = self.cells.iter();
        cells
            .map(|cell| std::array::from_fn(|axis| cell[first_axis + axis]))
            .collect()
    }

    /// The core's table over `cells` from [`terms`](Self::terms), without history terms.
    ///
    /// # Errors
    /// What the core refuses.
    pub fn table_over<'a, const AXES: usize>(
        &self,
        cells: &'a [[Terms; AXES]],
    ) -> Result<Table<'a, AXES>, TableError> {
        let thermal = Thermal::new(self.thermal)?;
        Table::new(thermal, self.first_edge_c, self.last_edge_c, cells)?
            .calibrated(self.t_min_c, self.t_max_c)
    }

    /// Runs `read` on a one-axis table of the core without history terms.
    pub(crate) fn with_axis<R>(
        &self,
        axis: usize,
        read: impl FnOnce(&Table<1>) -> R,
    ) -> Result<R, TableError> {
        let cells = self.terms::<1>(axis);
        Ok(read(&self.table_over(&cells)?))
    }

    /// Temperatures that show the whole static curve: the edges and three places in each cell,
    /// within the calibrated range.
    fn sample_temps_c(&self) -> Vec<f32> {
        let count = 4 * self.cells.len();
        let step_c = (self.last_edge_c - self.first_edge_c) / count as f32;
        (0..=count)
            .map(|i| self.first_edge_c + step_c * i as f32)
            .map(|temp_c| temp_c.clamp(self.t_min_c, self.t_max_c))
            .collect()
    }

    /// Whether an axis has a constant bias: neither temperature nor rate nor history changes it.
    pub fn is_constant(&self, axis: usize) -> bool {
        let first = self.cells.first().map(|cell| cell[axis].a[0]);
        let mut cells = self.cells.iter().map(|cell| &cell[axis]);
        let gains = self.plays.iter().map(|play| play.gain[axis]);
        let mut gains = gains.chain(self.slow_parts.iter().map(|part| part.gain[axis]));
        cells.all(|Terms { a, r }| {
            first == Some(a[0]) && a[1..].iter().chain(r).all(|term| *term == 0.0)
        }) && gains.all(|gain| gain == 0.0)
    }

    /// Whether some play or second lag of the table is in use.
    pub fn has_history(&self) -> bool {
        self.plays.iter().any(|play| play.half_width_c > 0.0)
            || self.slow_parts.iter().any(|part| part.limit_c > 0.0)
    }

    /// Range of an axis's static bias over the calibrated temperatures \[unit of the axis\].
    pub fn static_range(&self, axis: usize) -> f64 {
        let range = self.with_axis(axis, |table| {
            let biases = self.sample_temps_c().into_iter().map(|effective_c| {
                let point = tempco::ThermalPoint {
                    effective_c,
                    ..Default::default()
                };
                f64::from(table.bias(&point).0[0])
            });
            biases.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), bias| {
                (low.min(bias), high.max(bias))
            })
        });
        range.map_or(0.0, |(low, high)| high - low)
    }

    /// Jumps of an axis at the edges between cells, as the core's arithmetic makes them: the
    /// temperature and the largest jump at zero, lowest and highest rate.
    pub fn jumps(&self, axis: usize) -> Vec<(f32, f32)> {
        let width_c = (self.last_edge_c - self.first_edge_c) / self.cells.len() as f32;
        let cells = self.terms::<1>(axis);
        let thermal = &self.thermal;
        let edges = cells.windows(2).enumerate();
        edges
            .map(|(cell, pair)| {
                let rates = [0.0, thermal.rate_min_c_per_min, thermal.rate_max_c_per_min];
                let jump = rates
                    .map(|rate| (pair[1][0].bias(0.0, rate) - pair[0][0].bias(1.0, rate)).abs())
                    .into_iter()
                    .fold(0.0, f32::max);
                (self.first_edge_c + width_c * (cell + 1) as f32, jump)
            })
            .collect()
    }

    /// The largest of the [`jumps`](Self::jumps).
    pub fn max_jump(&self, axis: usize) -> f32 {
        self.jumps(axis)
            .into_iter()
            .map(|(_, jump)| jump)
            .fold(0.0, f32::max)
    }
}

/// CRC-32P4 over the numbers of the tables: for each, the thermal settings, the four temperatures, the
/// numbers of cells and axes as u32, then the cells; where there are any plays or second lags, their
/// numbers as u32, then the numbers of each play and each second lag. All little-endian.
pub(crate) fn crc32<'a>(tables: impl Iterator<Item = &'a TableData>) -> u32 {
    let mut digest = CRC.digest();
    for table in tables {
        let temps = [
            table.first_edge_c,
            table.last_edge_c,
            table.t_min_c,
            table.t_max_c,
        ];
        for value in table.thermal.to_array().into_iter().chain(temps) {
            digest.update(&value.to_le_bytes());
        }
        for count in [table.cells.len(), table.axes()] {
            digest.update(&(count as u32).to_le_bytes());
        }
        for value in table.cells.iter().flatten().flat_map(Terms::to_array) {
            digest.update(&value.to_le_bytes());
        }
        if table.plays.is_empty() && table.slow_parts.is_empty() {
            continue;
        }
        for count in [table.plays.len(), table.slow_parts.len()] {
            digest.update(&(count as u32).to_le_bytes());
        }
        let plays = table.plays.iter().flat_map(PlayData::numbers);
        let slow_parts = table.slow_parts.iter().flat_map(SlowPartData::numbers);
        for value in plays.chain(slow_parts) {
            digest.update(&value.to_le_bytes());
        }
    }
    digest.finalize()
}
