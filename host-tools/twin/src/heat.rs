//! The temperatures of a unit on its way through a profile.

use crate::air::Air;
use crate::propagator::{Propagator, Settled};
use crate::thermal::{ThermalNetwork, ThermalState};

/// The temperatures of a unit, moved along the air.
#[derive(Debug, Clone)]
pub(crate) struct Heat {
    network: ThermalNetwork,
    settled: Settled,
    whole_interval: Propagator,
    state: ThermalState,
    /// Time up to which `state` has been moved, s.
    time_s: f64,
    /// Stretch of the air at `time_s`.
    leg: usize,
}

impl Heat {
    /// At time 0 in a state. Most moves are over `interval_s`.
    pub(crate) fn new(network: ThermalNetwork, state: ThermalState, interval_s: f64) -> Self {
        Self {
            settled: Settled::new(&network),
            whole_interval: Propagator::new(&network, interval_s),
            network,
            state,
            time_s: 0.0,
            leg: 0,
        }
    }

    pub(crate) fn state(&self) -> &ThermalState {
        &self.state
    }

    /// Moves the state, split where the air bends so that each part is exact.
    pub(crate) fn advance_to(&mut self, air: &Air, time_s: f64) {
        let begin_s = self.time_s;
        while self.time_s < time_s {
            let leg = &air.legs[self.leg];
            if leg.end_s <= self.time_s {
                self.leg += 1;
                continue;
            }
            let part_end_s = time_s.min(leg.end_s);
            let part;
            let propagator = if self.time_s == begin_s && part_end_s == time_s {
                &self.whole_interval
            } else {
                part = Propagator::new(&self.network, part_end_s - self.time_s);
                &part
            };
            let since_s = self.time_s - leg.start_s;
            propagator.advance(&mut self.state, &self.settled, &leg.course, since_s);
            self.time_s = part_end_s;
        }
    }
}
