//! One temperature channel of an image: settings, grid, axes and cells.

use core::array::from_fn;

use tempco::{MAX_AXES, PLAYS, Table, TableError, Terms, Thermal, ThermalSettings};

use crate::axis::is_usable;
use crate::{Axis, ImageError};

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
    /// Time between two temperatures that the fit used \[s\]; 0 where it is not known.
    pub period_s: f32,
    /// Each axis, then `None`.
    pub axes: [Option<Axis>; MAX_AXES],
    /// The axes of the coldest cell, then all axes of the next.
    pub cells: &'a [Terms],
}

impl<'a> Channel<'a> {
    /// Number of axes.
    pub fn axis_count(&self) -> usize {
        let end = self.axes.iter().position(Option::is_none);
        end.unwrap_or(MAX_AXES)
    }

    /// The core's table of this channel, number `channel`, with the cells borrowed.
    ///
    /// # Errors
    /// As [`Image::table`](crate::Image::table), but for jumps.
    pub(crate) fn table<const AXES: usize>(
        &self,
        channel: usize,
    ) -> Result<Table<'a, AXES>, ImageError> {
        let (cells, rest) = self.cells.as_chunks::<AXES>();
        if self.axis_count() != AXES || !rest.is_empty() {
            return Err(ImageError::Shape);
        }
        let table = self
            .table_of(cells)
            .map_err(|error| ImageError::Table { channel, error })?;
        for (axis, record) in self.axes.iter().enumerate() {
            if let Some(name) = record.as_ref().and_then(Axis::bad_number) {
                return Err(ImageError::Axis {
                    channel,
                    axis,
                    name,
                });
            }
        }
        Ok(table)
    }

    fn table_of<const AXES: usize>(
        &self,
        cells: &'a [[Terms; AXES]],
    ) -> Result<Table<'a, AXES>, TableError> {
        if !is_usable(self.period_s) {
            return Err(TableError::Setting("period_s"));
        }
        let gain = |play: usize, axis: usize| {
            let record = self.axes.get(axis)?.as_ref()?;
            record.play_gains.get(play).copied()
        };
        let thermal = Thermal::new(self.thermal)?;
        Table::new(thermal, self.first_edge_c, self.last_edge_c, cells)?
            .calibrated(self.t_min_c, self.t_max_c)?
            .with_plays(from_fn(|play| {
                from_fn(|axis| gain(play, axis).unwrap_or(0.0))
            }))
    }

    /// The first cell, with the axis, behind which the bias jumps: at its hot edge, by more than
    /// rounding of the coefficients to f32 can explain, with rate and second lag zero or one of
    /// them lowest or highest.
    pub fn jump(&self) -> Option<(usize, usize)> {
        let axes = self.axis_count();
        let neighbours = self.cells.iter().zip(self.cells.get(axes..)?);
        let position = neighbours.into_iter().position(|(cold, hot)| {
            let points = [
                (0.0, 0.0),
                (self.thermal.rate_min_c_per_min, 0.0),
                (self.thermal.rate_max_c_per_min, 0.0),
                (0.0, self.thermal.lag2_min_c),
                (0.0, self.thermal.lag2_max_c),
            ];
            points
                .into_iter()
                .any(|(rate, lag2_c)| jumps(cold, hot, rate, lag2_c))
        })?;
        Some((position.checked_div(axes)?, position.checked_rem(axes)?))
    }

    /// A bound of the bias of an axis: the magnitudes of its terms added up, at the largest rate and
    /// second lag, with every play at its end \[unit of the axis\].
    pub fn max_bias(&self, axis: usize) -> f32 {
        let s = &self.thermal;
        let rate_c_per_min = s.rate_min_c_per_min.abs().max(s.rate_max_c_per_min.abs());
        let lag2_c = s.lag2_min_c.abs().max(s.lag2_max_c.abs());
        let cells = self.cells.chunks(self.axis_count().max(1));
        let cells = cells.filter_map(|axes| axes.get(axis));
        let bounds = cells.map(|terms| magnitude(terms, rate_c_per_min, lag2_c));
        let gains = self.axes.get(axis).copied().flatten();
        let gains = gains.map_or([0.0; PLAYS], |record| record.play_gains);
        let plays = gains.into_iter().zip([s.half_width1_c, s.half_width2_c]);
        bounds.fold(0.0, f32::max)
            + plays
                .map(|(gain, width_c)| gain.abs() * width_c)
                .sum::<f32>()
    }

    /// As [`table`](Self::table), for any number of axes: what it would refuse.
    pub(crate) fn check(&self, channel: usize) -> Result<(), ImageError> {
        match self.axis_count() {
            1 => self.table::<1>(channel).map(drop),
            2 => self.table::<2>(channel).map(drop),
            3 => self.table::<3>(channel).map(drop),
            4 => self.table::<4>(channel).map(drop),
            5 => self.table::<5>(channel).map(drop),
            6 => self.table::<6>(channel).map(drop),
            _ => Err(ImageError::Shape),
        }
    }
}

/// The magnitudes that are added up for a bias.
fn magnitude(terms: &Terms, rate_c_per_min: f32, lag2_c: f32) -> f32 {
    let sum = |values: &[f32]| values.iter().map(|value| value.abs()).sum::<f32>();
    sum(&terms.a) + rate_c_per_min.abs() * sum(&terms.r) + lag2_c.abs() * sum(&terms.s)
}

fn jumps(cold: &Terms, hot: &Terms, rate_c_per_min: f32, lag2_c: f32) -> bool {
    let magnitude = |terms| magnitude(terms, rate_c_per_min, lag2_c);
    let jump = hot.bias(0.0, rate_c_per_min, lag2_c) - cold.bias(1.0, rate_c_per_min, lag2_c);
    let limit = JUMP_TOLERANCE * (magnitude(cold) + magnitude(hot));
    jump.abs() > limit
}
