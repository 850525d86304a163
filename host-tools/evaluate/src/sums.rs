//! What the figures need of a log, gathered part by part.
//!
//! ```text
//! rows -+-> means over each averaging time: axes before and after, temperatures, rates
//!       +-> bins of temperature: heating and cooling apart
//!       +-> Allan sums over the longest stretch without a gap
//!       +-> rows with each flag, and outside of the calibrated range
//! ```
//!
//! Memory does not grow with the rows but by the means: a number per averaging time and series.

use tempco::{Status, Terms};
use tempco_set::CoefficientSet;
use tempco_set::run::{Applied, AxisOutput, Part};

use crate::Outside;
use crate::allan::{LongestStretch, Stretch};
use crate::hysteresis::Bins;
use crate::means::{Means, Stretches};

/// A log, as far as its rows have come.
pub(super) struct LogSums {
    /// For each averaging time, raw and compensated of each axis.
    axes: Vec<Stretches>,
    /// For each averaging time, each axis of the set that is compared.
    compared: Vec<Stretches>,
    /// Lag-compensated temperature and rate of each channel.
    thermal: Stretches,
    bins: Vec<Bins>,
    allan: LongestStretch,
    status_rows: [usize; Status::NAMES.len()],
    /// What puts a row outside of the calibrated range.
    outside_flags: Status,
    outside: Option<Outside>,
}

/// What was gathered of a log.
pub(super) struct Gathered {
    /// For each averaging time, raw and compensated of each axis.
    pub(super) axes: Vec<Vec<Means>>,
    /// For each averaging time, each axis of the set that is compared.
    pub(super) compared: Vec<Vec<Means>>,
    /// Lag-compensated temperature and rate of each channel.
    pub(super) thermal: Vec<Means>,
    pub(super) bins: Vec<Bins>,
    pub(super) allan: Stretch,
    /// For each flag that occurred, the number of rows with it.
    pub(super) status_rows: Vec<(&'static str, usize)>,
    pub(super) outside: Option<Outside>,
}

impl LogSums {
    /// Nothing yet of a log whose rows are `interval_s` apart. Axes have means over all of `taus_s`,
    /// temperatures over `tau_s`.
    pub(super) fn new(
        set: &CoefficientSet,
        compared: Option<&CoefficientSet>,
        interval_s: f64,
        (taus_s, tau_s): (&[f64], f64),
    ) -> Self {
        let of_taus = |series: usize| {
            let stretches = taus_s.iter();
            let stretches = stretches.map(|&tau_s| Stretches::new(series, interval_s, tau_s));
            stretches.collect()
        };
        let axes = set.axes().count();
        let channels = set.channels.iter();
        let bins = channels.map(|channel| {
            let tau_s = channel.table.thermal.tau_s.into();
            Bins::new(channel.axes.len(), interval_s, tau_s)
        });
        Self {
            axes: of_taus(2 * axes),
            compared: of_taus(compared.map_or(0, |set| set.axes().count())),
            thermal: Stretches::new(2 * set.channels.len(), interval_s, tau_s),
            bins: bins.collect(),
            allan: LongestStretch::new(interval_s, 2 * axes),
            status_rows: [0; Status::NAMES.len()],
            outside_flags: outside_flags(set),
            outside: None,
        }
    }

    /// Takes the next rows.
    pub(super) fn push(&mut self, part: &Part) {
        let Part {
            time_s, applied, ..
        } = part;
        let Applied { axes, points, .. } = applied;
        // Means: raw and compensated by turns, as temperature and rate.
        let of_axis = |series: usize, row: usize| {
            let AxisOutput {
                raw, compensated, ..
            } = &axes[series / 2];
            f64::from([raw, compensated][series % 2][row])
        };
        self.axes.iter_mut().for_each(|of| of.push(time_s, of_axis));
        if let Some(compared) = &part.compared {
            let of_axis = |axis: usize, row: usize| compared.axes[axis].compensated[row].into();
            let stretches = self.compared.iter_mut();
            stretches.for_each(|of| of.push(time_s, of_axis));
        }
        // The rate is the core's before it is clamped to the calibrated range: what the figures say
        // of the log does not depend on the set's limits.
        self.thermal.push(time_s, |series, row| {
            let point = &points[series / 2][row];
            f64::from([point.effective_c, point.rate_c_per_min][series % 2])
        });
        let mut of_channels = &axes[..];
        for (bins, points) in self.bins.iter_mut().zip(points) {
            let of_channel;
            (of_channel, of_channels) = of_channels.split_at(bins.axes());
            bins.push(points, of_channel);
        }
        for (row, (&time_s, &status)) in time_s.iter().zip(&applied.status).enumerate() {
            let both = |axis: &AxisOutput| [axis.raw[row], axis.compensated[row]].map(f64::from);
            self.allan.push(time_s, axes.iter().flat_map(both));
            self.count(time_s, status);
        }
    }

    /// Counts a row by its flags.
    fn count(&mut self, time_s: f64, status: Status) {
        if status == Status::OK {
            return;
        }
        for (rows, (flag, _)) in self.status_rows.iter_mut().zip(Status::NAMES) {
            *rows += usize::from(status.contains(flag));
        }
        if status.intersects(self.outside_flags) {
            let outside = self.outside.get_or_insert(Outside {
                rows: 0,
                from_s: time_s,
                to_s: time_s,
            });
            outside.rows += 1;
            outside.to_s = time_s;
        }
    }

    pub(super) fn finish(self) -> Gathered {
        let means = |of: Vec<Stretches>| of.into_iter().map(Stretches::finish).collect();
        let status_rows = Status::NAMES.into_iter().zip(self.status_rows);
        let status_rows = status_rows.map(|((_, name), rows)| (name, rows));
        Gathered {
            axes: means(self.axes),
            compared: means(self.compared),
            thermal: self.thermal.finish(),
            bins: self.bins,
            allan: self.allan.finish(),
            status_rows: status_rows.filter(|&(_, rows)| rows > 0).collect(),
            outside: self.outside,
        }
    }
}

/// The flags of a row outside of the calibrated range: of the rate too, in a set with rate terms.
fn outside_flags(set: &CoefficientSet) -> Status {
    let cells = set.channels.iter().flat_map(|channel| &channel.table.cells);
    let has_rate_terms = cells.flatten().any(|terms| terms.r != [0.0; Terms::RATE]);
    if has_rate_terms {
        Status::TEMPERATURE_CLAMPED | Status::RATE_CLAMPED
    } else {
        Status::TEMPERATURE_CLAMPED
    }
}
