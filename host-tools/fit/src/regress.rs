//! Regressors of a log, computed by the core that flies.

use tempco::{Interval, Status, TableError, Thermal, ThermalPoint, ThermalSettings, ThermalState};

use crate::log::Log;

/// Rows whose temperature was not believed are not fitted.
const UNUSABLE: [Status; 4] = [
    Status::TEMPERATURE_INVALID,
    Status::TEMPERATURE_SPIKE,
    Status::TEMPERATURE_LOST,
    Status::INTERVAL_INVALID,
];

/// Runs a channel's temperatures through the core, starting as firmware does after power-on.
pub fn thermal_points(log: &Log, channel: usize, thermal: &Thermal) -> Vec<ThermalPoint> {
    points_of(log, &log.channels[channel].temp_c, thermal)
}

/// Runs one temperature of each row through the core.
pub(crate) fn points_of(log: &Log, temps_c: &[f32], thermal: &Thermal) -> Vec<ThermalPoint> {
    let mut state = ThermalState::new(thermal);
    state.start(thermal, temps_c[0]);
    log.intervals_s()
        .zip(temps_c)
        .map(|(dt_s, &temp_c)| state.update(thermal, &Interval::new(thermal, dt_s), temp_c))
        .collect()
}

/// The thermal path with limits that no rate reaches.
///
/// # Errors
/// Settings that the core refuses.
pub(crate) fn with_every_rate(settings: ThermalSettings) -> Result<Thermal, TableError> {
    Thermal::new(ThermalSettings {
        rate_min_c_per_min: -1e4,
        rate_max_c_per_min: 1e4,
        ..settings
    })
}

/// Whether a row may enter a fit.
pub(crate) fn is_usable(point: &ThermalPoint) -> bool {
    !UNUSABLE.iter().any(|flag| point.status.intersects(*flag))
}

/// The rows of one channel in all logs, with the core's regressors.
pub(crate) struct ChannelData<'a> {
    pub(crate) logs: &'a [Log],
    pub(crate) channel: usize,
    pub(crate) points: Vec<Vec<ThermalPoint>>,
    /// For each log and row, whether it may enter a fit.
    pub(crate) keep: Vec<Vec<bool>>,
    /// For each log and axis, how far its constant bias is from the mean of the logs
    /// \[unit of the axis\]; 0 until it is known.
    pub(crate) constants: Vec<Vec<f64>>,
}

impl<'a> ChannelData<'a> {
    pub(crate) fn new(logs: &'a [Log], channel: usize, thermal: &Thermal) -> Self {
        let points: Vec<Vec<ThermalPoint>> = logs
            .iter()
            .map(|log| thermal_points(log, channel, thermal))
            .collect();
        let keep = points
            .iter()
            .map(|points| points.iter().map(is_usable).collect())
            .collect();
        let axes = logs[0].channels[channel].axes.len();
        Self {
            logs,
            channel,
            points,
            keep,
            constants: vec![vec![0.0; axes]; logs.len()],
        }
    }

    /// The same rows with the regressors of other settings; rows that these make unusable go.
    pub(crate) fn with(&self, thermal: &Thermal) -> Self {
        let mut data = Self::new(self.logs, self.channel, thermal);
        for (keep, kept) in data.keep.iter_mut().zip(&self.keep) {
            for (keep, kept) in keep.iter_mut().zip(kept) {
                *keep &= kept;
            }
        }
        data.constants.clone_from(&self.constants);
        data
    }

    /// Kept rows: the point and the values of all axes, less the constant of their log.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (&ThermalPoint, impl Iterator<Item = f64>)> {
        self.timed_rows().map(|(_, point, raw)| (point, raw))
    }

    /// Kept rows with the interval of their log \[s\].
    pub(crate) fn timed_rows(
        &self,
    ) -> impl Iterator<Item = (f64, &ThermalPoint, impl Iterator<Item = f64>)> {
        self.logs
            .iter()
            .zip(&self.points)
            .zip(self.keep.iter().zip(&self.constants))
            .flat_map(|((log, points), (keep, constants))| {
                let axes = &log.channels[self.channel].axes;
                let kept = points.iter().enumerate().filter(|(row, _)| keep[*row]);
                kept.map(move |(row, point)| {
                    let raw = axes.iter().zip(constants);
                    let raw = raw.map(move |(axis, constant)| axis.raw[row] - constant);
                    (log.interval_s, point, raw)
                })
            })
    }

    pub(crate) fn axes(&self) -> usize {
        self.logs[0].channels[self.channel].axes.len()
    }

    /// Lowest and highest of a figure of the kept rows.
    pub(crate) fn range(&self, figure: impl Fn(&ThermalPoint) -> f32) -> (f32, f32) {
        self.rows()
            .map(|(point, _)| figure(point))
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            })
    }
}
