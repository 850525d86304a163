//! The thermal path of a channel over a log, by the core that flies.

use tempco::{Interval, Status, TableError, Thermal, ThermalPoint, ThermalSettings, ThermalState};
use tempco_log::Log;

use super::updates::{Updates, thermal_period_s};

/// Rows whose temperature was not accepted are not fitted.
const UNUSABLE: [Status; 4] = [
    Status::TEMPERATURE_INVALID,
    Status::TEMPERATURE_SPIKE,
    Status::TEMPERATURE_LOST,
    Status::INTERVAL_INVALID,
];

/// Runs a channel's temperatures through the core, starting as firmware does after power-on.
pub fn thermal_points(log: &Log, channel: usize, thermal: &Thermal) -> Vec<ThermalPoint> {
    let temps_c = &log.channels[channel].temp_c;
    let mut state = ThermalState::new(thermal);
    let mut point = state.start(thermal, temps_c[0]);
    let mut intervals = IntervalCache::new(thermal, 0.0);
    let mut updates = Updates::of_log(log, thermal_period_s(log.interval_s));
    let rows = log.time_s.iter().zip(temps_c);
    let points = rows.map(|(&time_s, &temp_c)| {
        if let Some(dt_s) = updates.due(time_s) {
            point = state.update(thermal, &intervals.of(thermal, dt_s), temp_c);
        }
        point
    });
    points.collect()
}

/// The core's interval of the last row. Most rows of a log are as far apart, and it is not made again.
#[derive(Clone, Copy, Debug)]
pub struct IntervalCache {
    dt_s: f32,
    interval: Interval,
}

impl IntervalCache {
    /// Starts with an interval of `dt_s` \[s\].
    pub const fn new(thermal: &Thermal, dt_s: f32) -> Self {
        let interval = Interval::new(thermal, dt_s);
        Self { dt_s, interval }
    }

    /// The interval of `dt_s` \[s\], for the same settings.
    #[inline]
    pub fn of(&mut self, thermal: &Thermal, dt_s: f32) -> Interval {
        if dt_s != self.dt_s {
            *self = Self::new(thermal, dt_s);
        }
        self.interval
    }
}

/// The thermal path with limits that no rate and no second lag reaches.
///
/// # Errors
/// Settings that the core refuses.
pub fn with_every_rate(settings: ThermalSettings) -> Result<Thermal, TableError> {
    let lag2_c = if settings.has_lag2() { 1e3 } else { 0.0 };
    Thermal::new(ThermalSettings {
        rate_min_c_per_min: -1e4,
        rate_max_c_per_min: 1e4,
        lag2_min_c: -lag2_c,
        lag2_max_c: lag2_c,
        ..settings
    })
}

/// Whether a row may enter a fit.
#[inline]
pub fn is_usable(point: &ThermalPoint) -> bool {
    !UNUSABLE.iter().any(|flag| point.status.intersects(*flag))
}
