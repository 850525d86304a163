//! The coefficient table in integers, made from a table of the f32 core.

use tempco::{Status, Table};

use crate::format::{ONE, from_f32, power_of_two, round};
use crate::history::{self, FixedHistory, full_scale};
use crate::mask::{Mask, upper};
use crate::{FixedError, FixedPoint, FixedThermal};

/// The coefficients of one axis in one cell, in units of the axis's last place and scaled so that
/// every product of the evaluation is the upper word of a multiplication.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FixedTerms {
    /// `a0`, `2 a1`, `4 a2`.
    pub a: [i32; 3],
    /// `2 R r0`, `4 R r1`, with the rate's full scale `R`.
    pub r: [i32; 2],
}

impl FixedTerms {
    /// The bias at place `z` \[2^-31\] and rate \[2^-31 of the full scale\].
    #[inline]
    pub const fn bias(&self, z: i32, rate: i32) -> i32 {
        let [a0, a1, a2] = self.a;
        let [r0, r1] = self.r;
        let rising = a1.wrapping_add(upper(a2, z));
        let per_rate = r0.wrapping_add(upper(r1, z));
        a0.wrapping_add(upper(rising, z))
            .wrapping_add(upper(per_rate, rate))
    }
}

/// The integer counterpart of a checked [`tempco::Table`], with its own cells.
///
/// The number of cells is part of the type, so that the conversion can be a constant:
///
/// ```
/// # use tempco::{Table, Terms, Thermal, ThermalSettings};
/// # use tempco_fixed::FixedTable;
/// # const CELLS: [[Terms; 1]; 2] = [[Terms { a: [-0.4, 0.6, 0.0], r: [0.5, 0.0] }]; 2];
/// # const THERMAL: Thermal = match Thermal::new(ThermalSettings::DEFAULT) {
/// #     Ok(thermal) => thermal,
/// #     Err(error) => panic!("{}", error.message()),
/// # };
/// # static TABLE: Table<1> = match Table::new(THERMAL, -40.0, 80.0, &CELLS) {
/// #     Ok(table) => table,
/// #     Err(error) => panic!("{}", error.message()),
/// # };
/// static FIXED: FixedTable<1, { TABLE.cells().len() }> = match FixedTable::new(&TABLE) {
///     Ok(table) => table,
///     Err(error) => panic!("{}", error.message()),
/// };
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FixedTable<
    const AXES: usize,
    const CELLS: usize,
    const PLAYS: usize = 0,
    const SLOW: usize = 0,
> {
    thermal: FixedThermal,
    first_edge: i32,
    t_min: i32,
    t_max: i32,
    /// Cells per last place of the temperature \[2^-64\], so far below that the hot edge of the
    /// last cell still falls into it.
    cells_per_place: u64,
    /// Makes the rate a fraction of its full scale \[2^-31\].
    rate_shift: u32,
    exponents: [i32; AXES],
    error_bounds: [f64; AXES],
    cells: [[FixedTerms; AXES]; CELLS],
    history: FixedHistory<AXES, PLAYS, SLOW>,
}

/// Exponents stay in this range, also where an axis is zero throughout.
const EXPONENTS: (i32, i32) = (-62, 62);

const fn abs(value: f32) -> f64 {
    value.abs() as f64
}

const fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

impl<const AXES: usize, const CELLS: usize, const PLAYS: usize, const SLOW: usize>
    FixedTable<AXES, CELLS, PLAYS, SLOW>
{
    /// Converts a table, every axis with the finest last place its coefficients allow.
    ///
    /// # Errors
    /// Another number of cells than the type's, cells or rates beyond the formats, or
    /// coefficients beyond 1e18.
    pub const fn new(table: &Table<'_, AXES, PLAYS, SLOW>) -> Result<Self, FixedError> {
        let mut exponents = [0; AXES];
        let mut axis = 0;
        while axis < AXES {
            exponents[axis] = finest_exponent(table, axis);
            axis += 1;
        }
        Self::with_exponents(table, exponents)
    }

    /// Converts a table with chosen last places: a bias of 1 is `2^exponent` of the axis's unit.
    /// For gyro samples that come in such a format.
    ///
    /// # Errors
    /// As [`new`](Self::new), and an exponent with which an axis's coefficients do not fit.
    pub const fn with_exponents(
        table: &Table<'_, AXES, PLAYS, SLOW>,
        exponents: [i32; AXES],
    ) -> Result<Self, FixedError> {
        let thermal = match FixedThermal::new(table.thermal()) {
            Ok(thermal) => thermal,
            Err(error) => return Err(error),
        };
        if table.cells().len() != CELLS {
            return Err(FixedError::CellCount);
        }
        let first_edge = from_f32(table.first_edge_c());
        let t_max = from_f32(table.t_max_c());
        if table.cells_per_c() > 65_536.0 {
            return Err(FixedError::CellWidth);
        }
        let mut result = Self {
            thermal,
            first_edge,
            t_min: from_f32(table.t_min_c()),
            t_max,
            cells_per_place: cells_per_place(table.cells_per_c(), t_max - first_edge, CELLS),
            rate_shift: history::shift(fastest(&thermal)),
            exponents,
            error_bounds: [0.0; AXES],
            cells: [[FixedTerms {
                a: [0; 3],
                r: [0; 2],
            }; AXES]; CELLS],
            history: FixedHistory::new(table.history(), &exponents),
        };
        let mut axis = 0;
        while axis < AXES {
            let finest = finest_exponent(table, axis);
            if exponents[axis] < finest || exponents[axis] > EXPONENTS.1 {
                return Err(FixedError::Exponent { axis });
            }
            result.error_bounds[axis] = result.convert_axis(table, axis);
            axis += 1;
        }
        Ok(result)
    }

    /// Fills in the cells of an axis and returns its error bound.
    const fn convert_axis(&mut self, table: &Table<'_, AXES, PLAYS, SLOW>, axis: usize) -> f64 {
        let last_place = power_of_two(self.exponents[axis]);
        let per_place = power_of_two(-self.exponents[axis]);
        let full_scale = full_scale(self.rate_shift);
        let (mut steepest, mut per_rate) = (0.0, 0.0);
        let mut cell = 0;
        while cell < CELLS {
            let terms = &table.cells()[cell][axis];
            let [a0, a1, a2] = terms.a;
            let [r0, r1] = terms.r;
            self.cells[cell][axis] = FixedTerms {
                a: [
                    round(a0 as f64 * per_place),
                    round(a1 as f64 * 2.0 * per_place),
                    round(a2 as f64 * 4.0 * per_place),
                ],
                r: [
                    round(r0 as f64 * 2.0 * full_scale * per_place),
                    round(r1 as f64 * 4.0 * full_scale * per_place),
                ],
            };
            let slope = abs(a1) + 2.0 * abs(a2) + full_scale * abs(r1);
            steepest = larger(steepest, slope * table.cells_per_c() as f64);
            per_rate = larger(per_rate, abs(r0) + abs(r1));
            cell += 1;
        }
        let past = table.history();
        let terms = (PLAYS + SLOW) as f64;
        (8.0 + 1.25 * terms) * last_place
            + (2.0 * (steepest + history::gains(past, axis)) + per_rate) / ONE
    }

    /// The settings of the thermal path.
    pub const fn thermal(&self) -> &FixedThermal {
        &self.thermal
    }

    /// The exponents of the axes: biases and gyro samples are in `2^exponent` of the axis's unit.
    pub const fn exponents(&self) -> &[i32; AXES] {
        &self.exponents
    }

    /// The cells, coldest first.
    pub const fn cells(&self) -> &[[FixedTerms; AXES]; CELLS] {
        &self.cells
    }

    /// The largest difference of an axis's bias from the model in exact arithmetic, over all
    /// temperatures and calibrated rates \[unit of the axis\]; derived in the crate's docs.
    pub const fn error_bounds(&self) -> &[f64; AXES] {
        &self.error_bounds
    }

    pub(crate) const fn history(&self) -> &FixedHistory<AXES, PLAYS, SLOW> {
        &self.history
    }

    /// The bias of every axis at a thermal point, in the axis's last places; without the terms of
    /// the thermal history.
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline]
    pub fn bias(&self, point: &FixedPoint) -> ([i32; AXES], Status) {
        let cold = Mask::less(point.effective, self.t_min);
        let hot = Mask::less(self.t_max, point.effective);
        let temp = cold.pick(self.t_min, point.effective);
        let temp = hot.pick(self.t_max, temp);
        let offset = (temp - self.first_edge) as u64;
        let factor = (
            self.cells_per_place >> 32,
            self.cells_per_place & 0xffff_ffff,
        );
        // Number of the cell in the upper word, place within it in the lower.
        let place = offset * factor.0 + ((offset * factor.1) >> 32);
        let z = (place as u32 >> 1) as i32;
        let rate = point.rate << self.rate_shift;
        // The place never exceeds the last cell, so the alternative is never taken; it is there
        // so that the compiler need not provide for a panic.
        let bias = match self.cells.get((place >> 32) as usize) {
            Some(cell) => core::array::from_fn(|axis| cell[axis].bias(z, rate)),
            None => [0; AXES],
        };
        (
            bias,
            point.status | cold.or(hot).flags(Status::TEMPERATURE_CLAMPED),
        )
    }
}

/// The f32 core's factor, but no more than keeps the hot end, `range` places from the first edge,
/// in the last cell.
const fn cells_per_place(per_c: f32, range: i32, cells: usize) -> u64 {
    let factor = (per_c as f64 * power_of_two(64) / ONE) as u64;
    let most = ((cells as u128) << 64) / (range as u128 + 1);
    if factor as u128 >= most {
        (most - 1) as u64
    } else {
        factor
    }
}

/// The largest magnitude of a calibrated rate.
const fn fastest(thermal: &FixedThermal) -> i32 {
    if thermal.rate_max > -thermal.rate_min {
        thermal.rate_max
    } else {
        -thermal.rate_min
    }
}

/// The smallest exponent with which nothing in the evaluation of an axis overflows, and no bias
/// exceeds 2^30 last places, so that two of them differ by less than an i32 holds.
const fn finest_exponent<const AXES: usize, const PLAYS: usize, const SLOW: usize>(
    table: &Table<'_, AXES, PLAYS, SLOW>,
    axis: usize,
) -> i32 {
    let settings = table.thermal().settings();
    let fastest = larger(
        abs(settings.rate_min_c_per_min),
        abs(settings.rate_max_c_per_min),
    );
    // As `rate_shift` has it: more than the fastest rate, with its rounding.
    let mut full_scale = 1.0;
    while full_scale <= fastest + 1.0 / ONE {
        full_scale *= 2.0;
    }
    let past = history::peak(table.history(), axis);
    let mut peak = 0.0;
    let mut cell = 0;
    while cell < table.cells().len() {
        let [a0, a1, a2] = table.cells()[cell][axis].a;
        let [r0, r1] = table.cells()[cell][axis].r;
        let bias = abs(a0) + abs(a1) + abs(a2) + full_scale * (abs(r0) + abs(r1)) + past;
        peak = larger(peak, 2.0 * bias);
        peak = larger(peak, 4.0 * larger(abs(a2), full_scale * abs(r1)));
        cell += 1;
    }
    let mut exponent = EXPONENTS.0;
    while peak > (i32::MAX - 16) as f64 * power_of_two(exponent) {
        exponent += 1;
    }
    exponent
}
