//! What is gathered of a temperature channel.

use std::collections::BTreeMap;

use tempco::ThermalPoint;
use tempco_set::ChannelSet;

use super::MOST_TIMES;
use super::axis::{AxisSums, Direction};
use super::bins::Bins;
use super::spread::Spread;

/// Change that separates heating and cooling from the sensor's noise \[degC\], within one time constant
/// of the rate estimator; as in the hysteresis of an evaluation.
const LEAST_CHANGE_C: f64 = 0.05;

/// Cells of the map over the calibrated range, each way.
const MAP_CELLS: f64 = 32.0;

/// Sums of a channel over one log.
#[derive(Clone, Debug)]
pub(super) struct ChannelSums {
    pub(super) axes: Vec<AxisSums>,
    least_rate: f64,
    sum_temp_c: f64,
    sum_rate: f64,
    temps_c: Bins<Spread>,
    map: Map,
}

/// Time spent by temperature and rate.
#[derive(Clone, Debug)]
pub(crate) struct Map {
    pub(crate) cell_c: f64,
    pub(crate) cell_c_per_min: f64,
    /// Time in each cell \[s\]; the cell `(i, j)` begins at `i cell_c` and `j cell_c_per_min`.
    pub(crate) time_s: BTreeMap<(i32, i32), f64>,
    /// Neighbouring rows are mostly in one cell.
    last: ((i32, i32), f64),
}

/// A channel as it is drawn.
#[derive(Clone, Debug)]
pub(crate) struct GatheredChannel {
    /// Lag-compensated temperature by time \[h, degC\].
    pub(crate) temps_c: Vec<(f64, Spread)>,
    pub(crate) map: Map,
}

impl ChannelSums {
    pub(super) fn new(channel: &ChannelSet, tau_s: f64) -> Self {
        let (table, thermal) = (&channel.table, &channel.table.thermal);
        let span = |low: f32, high: f32, least: f64| {
            (f64::from(high) - f64::from(low)).max(least) / MAP_CELLS
        };
        Self {
            axes: vec![AxisSums::new(tau_s); channel.axes.len()],
            least_rate: LEAST_CHANGE_C / (f64::from(thermal.tau_s) / 60.0),
            sum_temp_c: 0.0,
            sum_rate: 0.0,
            temps_c: Bins::new(1.0, MOST_TIMES),
            map: Map {
                cell_c: span(table.t_min_c, table.t_max_c, 1.0),
                cell_c_per_min: span(thermal.rate_min_c_per_min, thermal.rate_max_c_per_min, 0.2),
                time_s: BTreeMap::new(),
                last: ((0, 0), 0.0),
            },
        }
    }

    #[inline]
    pub(super) fn push(&mut self, point: &ThermalPoint, interval_s: f64, since_s: f64) {
        let (temp_c, rate) = (
            f64::from(point.effective_c),
            f64::from(point.rate_c_per_min),
        );
        self.sum_temp_c += temp_c;
        self.sum_rate += rate;
        self.temps_c.at(since_s).add(temp_c);
        self.map.add(temp_c, rate, interval_s);
    }

    /// Ends a stretch of `rows`; its middle is `None` where it has too few of them.
    pub(super) fn close_stretch(&mut self, middle_s: Option<f64>, rows: f64) {
        let (temp_c, rate) = (self.sum_temp_c / rows, self.sum_rate / rows);
        let direction = match rate {
            rate if rate >= self.least_rate => Direction::Heating,
            rate if rate <= -self.least_rate => Direction::Cooling,
            _ => Direction::Steady,
        };
        for axis in &mut self.axes {
            axis.close_stretch(middle_s, rows, temp_c, rate, direction);
        }
        (self.sum_temp_c, self.sum_rate) = (0.0, 0.0);
    }

    /// The channel as it is drawn, in a log that begins at `start_h`, and its axes.
    pub(super) fn finish(mut self, start_h: f64) -> (GatheredChannel, Vec<AxisSums>) {
        self.map.flush();
        let hours = |(since_s, spread): (f64, &Spread)| (start_h + since_s / 3600.0, *spread);
        let shown = GatheredChannel {
            temps_c: self.temps_c.iter().map(hours).collect(),
            map: self.map,
        };
        (shown, self.axes)
    }
}

impl GatheredChannel {
    pub(super) fn append(&mut self, later: Self) {
        self.temps_c.extend(later.temps_c);
        for (cell, time_s) in later.map.time_s {
            *self.map.time_s.entry(cell).or_default() += time_s;
        }
    }
}

impl Map {
    #[inline]
    fn add(&mut self, temp_c: f64, rate: f64, interval_s: f64) {
        let cell = (
            (temp_c / self.cell_c).floor() as i32,
            (rate / self.cell_c_per_min).floor() as i32,
        );
        if cell != self.last.0 {
            self.flush();
            self.last.0 = cell;
        }
        self.last.1 += interval_s;
    }

    fn flush(&mut self) {
        let (cell, time_s) = self.last;
        if time_s > 0.0 {
            *self.time_s.entry(cell).or_default() += time_s;
        }
        self.last.1 = 0.0;
    }
}
