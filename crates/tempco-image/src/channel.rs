//! One temperature channel of an image: settings, grid and cells.

use tempco::{MAX_AXES, Table, TableError, Terms, Thermal, ThermalSettings};

use crate::{ChannelHistory, ImageError, MAX_PLAYS, MAX_SLOW_PARTS, Unit};

/// A bias may jump by this share of the magnitudes that are added up for it and still count as
/// continuous: coefficients in f32 cannot all meet exactly.
const JUMP_TOLERANCE: f32 = 1.0 / (1 << 20) as f32;

/// The axes that share a temperature; not validated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel<'a> {
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
    /// Unit of each axis, then `None`.
    pub units: [Option<Unit>; MAX_AXES],
    /// The axes of the coldest cell, then all axes of the next.
    pub cells: &'a [Terms],
    /// Terms of the thermal history.
    pub history: ChannelHistory,
}

impl<'a> Channel<'a> {
    /// Number of axes.
    pub fn axes(&self) -> usize {
        self.units.iter().map_while(|unit| *unit).count()
    }

    /// The core's table of this channel, number `channel`, with the cells borrowed; history terms
    /// that it does not have become ones without gain.
    ///
    /// # Errors
    /// As [`Image::table`](crate::Image::table), but for jumps.
    pub(crate) fn table<const AXES: usize, const PLAYS: usize, const SLOW: usize>(
        &self,
        channel: usize,
    ) -> Result<Table<'a, AXES, PLAYS, SLOW>, ImageError> {
        let (cells, rest) = self.cells.as_chunks::<AXES>();
        if self.axes() != AXES || !rest.is_empty() {
            return Err(ImageError::Shape);
        }
        let (plays, slow_parts) = self.history.counts();
        if plays > PLAYS || slow_parts > SLOW {
            return Err(ImageError::History { plays, slow_parts });
        }
        self.table_of(cells)
            .map_err(|error| ImageError::Table { channel, error })
    }

    fn table_of<const AXES: usize, const PLAYS: usize, const SLOW: usize>(
        &self,
        cells: &'a [[Terms; AXES]],
    ) -> Result<Table<'a, AXES, PLAYS, SLOW>, TableError> {
        let thermal = Thermal::new(self.thermal)?;
        Table::new(thermal, self.first_edge_c, self.last_edge_c, cells)?
            .calibrated(self.t_min_c, self.t_max_c)?
            .with_history(
                self.history.core_plays(),
                self.history.core_slow_parts(self.thermal.tau_s),
            )
    }

    /// The first cell, with the axis, behind which the bias jumps: at its hot edge, at the lowest,
    /// zero or highest rate, by more than rounding of the coefficients to f32 can explain.
    pub fn jump(&self) -> Option<(usize, usize)> {
        let axes = self.axes();
        let neighbours = self.cells.iter().zip(self.cells.get(axes..)?);
        let position = neighbours.into_iter().position(|(cold, hot)| {
            let rates = [
                0.0,
                self.thermal.rate_min_c_per_min,
                self.thermal.rate_max_c_per_min,
            ];
            rates.into_iter().any(|rate| jumps(cold, hot, rate))
        })?;
        Some((position.checked_div(axes)?, position.checked_rem(axes)?))
    }

    /// As [`table`](Self::table), for any number of axes and history terms: what it would refuse.
    pub(crate) fn check(&self, channel: usize) -> Result<(), ImageError> {
        match self.axes() {
            1 => self.check_axes::<1>(channel),
            2 => self.check_axes::<2>(channel),
            3 => self.check_axes::<3>(channel),
            4 => self.check_axes::<4>(channel),
            5 => self.check_axes::<5>(channel),
            6 => self.check_axes::<6>(channel),
            _ => Err(ImageError::Shape),
        }
    }

    fn check_axes<const AXES: usize>(&self, channel: usize) -> Result<(), ImageError> {
        self.table::<AXES, MAX_PLAYS, MAX_SLOW_PARTS>(channel)
            .map(drop)
    }
}

fn jumps(cold: &Terms, hot: &Terms, rate_c_per_min: f32) -> bool {
    let magnitude = |terms: &Terms| {
        let sum = |values: &[f32]| values.iter().map(|value| value.abs()).sum::<f32>();
        sum(&terms.a) + rate_c_per_min.abs() * sum(&terms.r)
    };
    let jump = hot.bias(0.0, rate_c_per_min) - cold.bias(1.0, rate_c_per_min);
    let limit = JUMP_TOLERANCE * (magnitude(cold) + magnitude(hot));
    jump.abs() > limit
}
