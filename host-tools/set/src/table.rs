//! The table of a channel as data: what JSON holds, what the core borrows, what the CRC covers.

use serde::{Deserialize, Serialize};
use tempco::{PLAYS, Table, TableError, Terms, Thermal, ThermalPoint, ThermalSettings};
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
    /// Gains of the plays by axis \[unit of the axis per degC\].
    pub play_gains: Vec<[f32; PLAYS]>,
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

    /// The core's table over `cells` from [`terms`](Self::terms), with the same `first_axis`.
    ///
    /// # Errors
    /// What the core refuses.
    ///
    /// # Panics
    /// If the table has fewer axes.
    pub fn table_over<'a, const AXES: usize>(
        &self,
        first_axis: usize,
        cells: &'a [[Terms; AXES]],
    ) -> Result<Table<'a, AXES>, TableError> {
        let thermal = Thermal::new(self.thermal)?;
        let gain = |play: usize, axis: usize| self.play_gains[first_axis + axis][play];
        let gains = |play| std::array::from_fn(|axis| gain(play, axis));
        Table::new(thermal, self.first_edge_c, self.last_edge_c, cells)?
            .calibrated(self.t_min_c, self.t_max_c)?
            .with_plays(std::array::from_fn(gains))
    }

    /// Runs `read` on a one-axis table of the core.
    pub(crate) fn with_axis<R>(
        &self,
        axis: usize,
        read: impl FnOnce(&Table<1>) -> R,
    ) -> Result<R, TableError> {
        let cells = self.terms::<1>(axis);
        Ok(read(&self.table_over(axis, &cells)?))
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
        cells.all(|Terms { a, r, s }| {
            let mut others = a[1..].iter().chain(r).chain(s);
            first == Some(a[0]) && others.all(|term| *term == 0.0)
        }) && self.play_gains[axis] == [0.0; PLAYS]
    }

    /// Half widths of the plays \[degC\]; 0 of one that is not used.
    pub const fn half_widths_c(&self) -> [f32; PLAYS] {
        [self.thermal.half_width1_c, self.thermal.half_width2_c]
    }

    /// Whether the table has a second lag.
    pub fn has_second_lag(&self) -> bool {
        self.thermal.has_lag2()
    }

    /// Whether the table has plays or a second lag.
    pub fn has_history(&self) -> bool {
        self.half_widths_c() != [0.0; PLAYS] || self.has_second_lag()
    }

    /// Range of an axis's static bias over the calibrated temperatures \[unit of the axis\].
    pub fn static_range(&self, axis: usize) -> f64 {
        let range = self.with_axis(axis, |table| {
            let biases = self.sample_temps_c().into_iter().map(|effective_c| {
                let point = ThermalPoint {
                    effective_c,
                    ..ThermalPoint::default()
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
    /// temperature and the largest jump at zero, lowest and highest rate and second lag.
    pub fn jumps(&self, axis: usize) -> Vec<(f32, f32)> {
        let width_c = (self.last_edge_c - self.first_edge_c) / self.cells.len() as f32;
        let cells = self.terms::<1>(axis);
        let thermal = &self.thermal;
        let edges = cells.windows(2).enumerate();
        edges
            .map(|(cell, pair)| {
                let [[cold], [hot]] = [pair[0], pair[1]];
                let jump =
                    |rate, lag2| (hot.bias(0.0, rate, lag2) - cold.bias(1.0, rate, lag2)).abs();
                let rates = [0.0, thermal.rate_min_c_per_min, thermal.rate_max_c_per_min];
                let lags = [0.0, thermal.lag2_min_c, thermal.lag2_max_c];
                let jumps = rates
                    .iter()
                    .flat_map(|&rate| lags.map(|lag2| jump(rate, lag2)));
                let jump = jumps.fold(0.0, f32::max);
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

/// The settings that version 0.1 had, which come first.
const FIRST_SETTINGS: usize = 11;

/// CRC-32P4 over the numbers of the tables: for each, the thermal settings, the four temperatures, the
/// numbers of cells and axes as u32, the cells, and the gains of the plays by axis. All
/// little-endian.
///
/// Tables that version 0.1 could hold keep their CRC. It had the first eleven settings and five
/// coefficients in a cell, and at the end, where there were plays, the number of them, a 0 (both
/// as u32), and of each the half width and the gains.
pub(crate) fn crc32<'a>(tables: impl Iterator<Item = &'a TableData> + Clone) -> u32 {
    let is_first_form = tables.clone().all(TableData::is_of_first_form);
    let plays = tables.clone().map(TableData::plays).max().unwrap_or(0);
    let mut digest = CRC.digest();
    for table in tables {
        let settings = table.thermal.to_array();
        let (settings, terms) = if is_first_form {
            (&settings[..FIRST_SETTINGS], Terms::STATIC + Terms::RATE)
        } else {
            (&settings[..], Terms::COUNT)
        };
        let temps = [
            table.first_edge_c,
            table.last_edge_c,
            table.t_min_c,
            table.t_max_c,
        ];
        for value in settings.iter().chain(&temps) {
            digest.update(&value.to_le_bytes());
        }
        for count in [table.cells.len(), table.axes()] {
            digest.update(&(count as u32).to_le_bytes());
        }
        for cell in table.cells.iter().flatten() {
            for value in &cell.to_array()[..terms] {
                digest.update(&value.to_le_bytes());
            }
        }
        let gains = |play: usize| table.play_gains.iter().map(move |of_axis| of_axis[play]);
        let first_form = (0..plays)
            .flat_map(|play| std::iter::once(table.half_widths_c()[play]).chain(gains(play)));
        let numbers: Vec<f32> = if is_first_form {
            first_form.collect()
        } else {
            table.play_gains.iter().flatten().copied().collect()
        };
        if is_first_form && plays > 0 {
            digest.update(&(plays as u32).to_le_bytes());
            digest.update(&0_u32.to_le_bytes());
        }
        for value in numbers {
            digest.update(&value.to_le_bytes());
        }
    }
    digest.finalize()
}

/// The same settings without second lag, plays and rules for the start.
pub(crate) fn without_history(of: &ThermalSettings) -> ThermalSettings {
    let mut settings = ThermalSettings::DEFAULT.to_array();
    settings[..FIRST_SETTINGS].copy_from_slice(&of.to_array()[..FIRST_SETTINGS]);
    ThermalSettings::from_array(settings)
}

impl TableData {
    /// The number of plays that are used; the first one is used first.
    fn plays(&self) -> usize {
        let used = self
            .half_widths_c()
            .into_iter()
            .rposition(|width_c| width_c > 0.0);
        used.map_or(0, |last| last + 1)
    }

    /// Whether version 0.1 could hold the table: no second lag, plays that the lag-compensated
    /// temperature drags, and no start rules.
    fn is_of_first_form(&self) -> bool {
        let of = &self.thermal;
        let first_form = ThermalSettings {
            half_width1_c: of.half_width1_c,
            half_width2_c: of.half_width2_c,
            play_kappa: if self.plays() > 0 { of.kappa } else { 0.0 },
            ..without_history(of)
        };
        let mut terms = self.cells.iter().flatten();
        *of == first_form && terms.all(|terms| terms.s == [0.0; Terms::LAG])
    }
}
