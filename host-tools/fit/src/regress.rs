//! Regressors of a log, computed by the core that flies.

use tempco::{Interval, Status, Thermal, ThermalPoint, ThermalState};

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
    let temps_c = &log.channels[channel].temp_c;
    let mut state = ThermalState::new(thermal);
    state.start(thermal, temps_c[0]);
    log.intervals_s()
        .zip(temps_c)
        .map(|(dt_s, &temp_c)| state.update(thermal, &Interval::new(thermal, dt_s), temp_c))
        .collect()
}

/// Whether a row may enter a fit.
pub(crate) fn is_usable(point: &ThermalPoint) -> bool {
    !UNUSABLE.iter().any(|flag| point.status.intersects(*flag))
}
