//! The coefficient table: the bias model as cells of equal width over the calibrated range.

use crate::error::is_within;
use crate::settings::PLAYS;
use crate::terms::{are_usable, first_unusable};
use crate::thermal::clamp;
use crate::{Status, TableError, Terms, Thermal, ThermalPoint};

/// The most cells a table can have.
pub const MAX_CELLS: usize = 1024;
/// The most axes of a unit, all temperature channels together, in images, over the link and in logs.
pub const MAX_AXES: usize = 6;

/// A checked coefficient table for `AXES` axes that share one temperature.
///
/// The cells are borrowed: they can be a const in flash or a buffer on a host. A fit's segments,
/// of whatever widths, are represented by cells of one width, which makes finding the cell one
/// multiplication (and its cost independent of the temperature).
///
/// Every table has the same shape: terms that a fit does not use are zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table<'a, const AXES: usize> {
    thermal: Thermal,
    /// Cold edge of the first cell \[degC\].
    first_edge_c: f32,
    /// Rounded down so far that the hot edge of the last cell still falls into it.
    cells_per_c: f32,
    t_min_c: f32,
    t_max_c: f32,
    cells: &'a [[Terms; AXES]],
    coldest: &'a [Terms; AXES],
    /// For each play and axis \[unit of the axis per degC\].
    play_gains: [[f32; AXES]; PLAYS],
}

/// Where a lag-compensated temperature falls in a table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Place {
    /// Number of the cell, 0 for the coldest.
    pub cell: usize,
    /// Place within the cell, 0 to below 1.
    pub z: f32,
    /// [`Status::TEMPERATURE_CLAMPED`] or nothing.
    pub status: Status,
}

impl<'a, const AXES: usize> Table<'a, AXES> {
    /// Makes a table of `cells` of equal width from `first_edge_c` to `last_edge_c` \[degC\],
    /// calibrated all over. See [`calibrated`](Self::calibrated) for a narrower range.
    ///
    /// In a const a bad table stops the build; see the example of the crate.
    ///
    /// # Errors
    /// A range that is empty, not finite or beyond -273.15..1000 degC, no cells or more than
    /// [`MAX_CELLS`], or a coefficient that is not finite or beyond 1e20.
    pub const fn new(
        thermal: Thermal,
        first_edge_c: f32,
        last_edge_c: f32,
        cells: &'a [[Terms; AXES]],
    ) -> Result<Self, TableError> {
        if !is_within(first_edge_c, -273.15, 1e3) {
            return Err(TableError::Setting("first_edge_c"));
        }
        if !is_within(last_edge_c, first_edge_c + 1e-3, 1e3) {
            return Err(TableError::Setting("last_edge_c"));
        }
        let Some((coldest, _)) = cells.split_first() else {
            return Err(TableError::CellCount);
        };
        if cells.len() > MAX_CELLS {
            return Err(TableError::CellCount);
        }
        if let Some(at) = first_unusable(cells.as_flattened()) {
            let (cell, axis) = (at / AXES, at % AXES);
            return Err(TableError::Coefficient { cell, axis });
        }
        let count = cells.len() as f32;
        let mut cells_per_c = count / (last_edge_c - first_edge_c);
        while (last_edge_c - first_edge_c) * cells_per_c >= count {
            cells_per_c = cells_per_c.next_down();
        }
        Ok(Self {
            thermal,
            first_edge_c,
            cells_per_c,
            t_min_c: first_edge_c,
            t_max_c: last_edge_c,
            cells,
            coldest,
            play_gains: [[0.0; AXES]; PLAYS],
        })
    }

    /// Adds the gains of the plays: for each play and axis \[unit of the axis per degC\].
    ///
    /// # Errors
    /// A gain that is not finite or beyond 1e20.
    pub const fn with_plays(self, play_gains: [[f32; AXES]; PLAYS]) -> Result<Self, TableError> {
        if !are_usable(play_gains.as_flattened()) {
            return Err(TableError::Setting("play_gains"));
        }
        Ok(Self { play_gains, ..self })
    }

    /// Narrows the calibrated range to `t_min_c..=t_max_c` \[degC\]: where cells reach beyond the
    /// temperatures that were measured, they are not used.
    ///
    /// # Errors
    /// A limit outside the cells, or an empty range.
    pub const fn calibrated(self, t_min_c: f32, t_max_c: f32) -> Result<Self, TableError> {
        if !is_within(t_min_c, self.t_min_c, self.t_max_c) {
            return Err(TableError::Setting("t_min_c"));
        }
        if !is_within(t_max_c, t_min_c, self.t_max_c) {
            return Err(TableError::Setting("t_max_c"));
        }
        Ok(Self {
            t_min_c,
            t_max_c,
            ..self
        })
    }

    /// The settings of the thermal path.
    pub const fn thermal(&self) -> &Thermal {
        &self.thermal
    }

    /// Cold end of the calibrated range \[degC\].
    pub const fn t_min_c(&self) -> f32 {
        self.t_min_c
    }

    /// Hot end of the calibrated range \[degC\].
    pub const fn t_max_c(&self) -> f32 {
        self.t_max_c
    }

    /// Cold edge of the first cell \[degC\].
    pub const fn first_edge_c(&self) -> f32 {
        self.first_edge_c
    }

    /// Cells per degC, as [`place`](Self::place) uses it: rounded down so far that the hot edge of
    /// the last cell still falls into it.
    pub const fn cells_per_c(&self) -> f32 {
        self.cells_per_c
    }

    /// The cells, coldest first.
    pub const fn cells(&self) -> &'a [[Terms; AXES]] {
        self.cells
    }

    /// The gains of the plays, for each play and axis \[unit of the axis per degC\].
    pub const fn play_gains(&self) -> &[[f32; AXES]; PLAYS] {
        &self.play_gains
    }

    /// Finds the cell of a lag-compensated temperature, which must not be NaN; outside the calibrated
    /// range, the cell of its nearest end.
    #[inline(always)]
    pub fn place(&self, effective_c: f32) -> Place {
        let (temp_c, status) = clamp(
            effective_c,
            self.t_min_c,
            self.t_max_c,
            Status::TEMPERATURE_CLAMPED,
        );
        let place = (temp_c - self.first_edge_c) * self.cells_per_c;
        let cell = place as u32;
        Place {
            cell: cell as usize,
            z: place - cell as f32,
            status,
        }
    }

    /// The bias of every axis at a thermal point, none of whose figures may be NaN \[unit of each
    /// axis\].
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline(always)]
    pub fn bias(&self, point: &ThermalPoint) -> ([f32; AXES], Status) {
        let place = self.place(point.effective_c);
        // `place` never exceeds the last cell, so the alternative is never taken; it is there so
        // that the compiler need not provide for a panic.
        let cell = self.cells.get(place.cell).unwrap_or(self.coldest);
        let mut bias = core::array::from_fn(|axis| {
            cell[axis].bias(place.z, point.rate_c_per_min, point.lag2_c)
        });
        for (gains, play_c) in self.play_gains.iter().zip(point.plays_c) {
            for (bias, gain) in bias.iter_mut().zip(gains) {
                *bias += gain * play_c;
            }
        }
        (bias, point.status | place.status)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ThermalSettings;

    const LINE: Terms = Terms::new([1.0, 2.0, 0.0], [0.5, 0.25]);

    fn thermal() -> Thermal {
        Thermal::new(ThermalSettings::DEFAULT).unwrap()
    }

    #[test]
    fn every_temperature_has_its_cell_and_the_ends_are_held() {
        let cells = [[LINE]; 19];
        let table = Table::new(thermal(), -15.0, 80.0, &cells).unwrap();
        for (temp, expected) in [(-15.0, 0.0), (-10.0, 1.0), (-12.5, 0.5), (77.5, 18.5)] {
            let place = table.place(temp);
            let position = place.cell as f32 + place.z;
            assert!((position - expected).abs() < 1e-5, "{temp}");
            assert_eq!(place.status, Status::OK, "{temp}");
        }
        let top = table.place(80.0);
        assert_eq!((top.cell, top.status), (18, Status::OK));
        assert!(top.z > 0.99999 && top.z < 1.0);
        for outside in [-15.001, -1e30, f32::NEG_INFINITY] {
            let place = table.place(outside);
            assert_eq!((place.cell, place.z), (0, 0.0));
            assert_eq!(place.status, Status::TEMPERATURE_CLAMPED);
        }
        for outside in [80.001, 3e38, f32::INFINITY] {
            let place = table.place(outside);
            assert_eq!((place.cell, place.z), (18, top.z));
            assert_eq!(place.status, Status::TEMPERATURE_CLAMPED);
        }
    }

    #[test]
    fn the_hottest_temperature_of_any_grid_falls_into_the_last_cell() {
        for count in (1..=MAX_CELLS).step_by(if cfg!(miri) { 341 } else { 1 }) {
            for (first_edge_c, last_edge_c) in [(-17.6, 73.97), (-40.0, 85.0), (0.1, 0.3)] {
                let cells = [[LINE]; MAX_CELLS];
                let cells = &cells[..count];
                let table = Table::new(thermal(), first_edge_c, last_edge_c, cells).unwrap();
                let place = table.place(last_edge_c);
                assert_eq!((place.cell, place.status), (count - 1, Status::OK));
                assert!(place.z > 0.999 && place.z < 1.0);
            }
        }
    }

    #[test]
    fn a_narrower_range_is_held_at_its_ends() {
        let cells = [[LINE]; 19];
        let table = Table::new(thermal(), -15.0, 80.0, &cells).unwrap();
        let table = table.calibrated(-12.0, 80.0).unwrap();
        assert_eq!(table.place(-14.0).cell, 0);
        assert!((table.place(-14.0).z - 0.6).abs() < 1e-6);
        assert_eq!(table.place(-14.0).status, Status::TEMPERATURE_CLAMPED);
        assert_eq!(table.place(-12.0).status, Status::OK);
    }

    #[test]
    fn bad_tables_are_refused_by_name() {
        let good = [[LINE; 2]; 3];
        let refused = |t_min, t_max, cells: &[[Terms; 2]]| {
            Table::new(thermal(), t_min, t_max, cells).unwrap_err()
        };
        assert_eq!(
            refused(f32::NAN, 80.0, &good),
            TableError::Setting("first_edge_c")
        );
        assert_eq!(
            refused(10.0, 10.0, &good),
            TableError::Setting("last_edge_c")
        );
        assert_eq!(
            refused(10.0, f32::INFINITY, &good),
            TableError::Setting("last_edge_c")
        );
        let table = Table::new(thermal(), 10.0, 20.0, &good).unwrap();
        for (t_min_c, t_max_c, name) in [
            (9.9, 15.0, "t_min_c"),
            (f32::NAN, 15.0, "t_min_c"),
            (12.0, 20.1, "t_max_c"),
            (12.0, 11.0, "t_max_c"),
            (12.0, f32::NAN, "t_max_c"),
        ] {
            let error = table.calibrated(t_min_c, t_max_c).unwrap_err();
            assert_eq!(error, TableError::Setting(name));
        }
        assert_eq!(refused(10.0, 20.0, &[]), TableError::CellCount);
        assert_eq!(
            refused(10.0, 20.0, &[[LINE; 2]; MAX_CELLS + 1]),
            TableError::CellCount
        );
        for bad in [f32::NAN, f32::INFINITY, -2e20] {
            for place in 0..Terms::COUNT {
                let mut cells = good;
                let mut values = LINE.to_array();
                values[place] = bad;
                cells[1][1] = Terms::from_array(values);
                assert_eq!(
                    refused(10.0, 20.0, &cells),
                    TableError::Coefficient { cell: 1, axis: 1 }
                );
            }
        }
    }
}
