//! The exact solution of the equations of heat flow, step by step.

use crate::expm::exp_of_flow;
use crate::legs::Course;
use crate::thermal::{NODES, ThermalNetwork, ThermalState};

/// Moves a [`ThermalState`] over one fixed time, exactly, while the air follows one [`Course`].
///
/// Once settled on a course every part follows a curve of its own: the line of the air, shifted by
/// the time constants before it, or a sine wave, weakened and turned. The distances from these curves
/// decay by the exponential of the matrix of heat flow.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Propagator {
    duration_s: f64,
    /// Column by column.
    decay: [[f64; NODES]; NODES],
}

/// What the parts follow once they have settled; worked out once per network.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settled {
    time_constants_s: [f64; NODES],
    parents: [Option<usize>; NODES],
    lags_s: [f64; NODES],
    rises_c: [f64; NODES],
}

impl Settled {
    pub(crate) fn new(network: &ThermalNetwork) -> Self {
        Self {
            time_constants_s: network.lags().map(|lag| lag.time_constant_s),
            parents: network.lags().map(|lag| lag.parent),
            lags_s: network.sums(|lag| lag.time_constant_s),
            rises_c: network.rises_c(),
        }
    }

    /// Settled temperatures at a time since the course's beginning.
    fn at(&self, course: &Course, time_s: f64) -> [f64; NODES] {
        match *course {
            Course::Line {
                start_c,
                slope_c_per_s,
            } => core::array::from_fn(|node| {
                let line_c = start_c + slope_c_per_s * (time_s - self.lags_s[node]);
                line_c + self.rises_c[node]
            }),
            Course::Sine {
                mean_c,
                amplitude_c,
                rad_per_s,
            } => {
                let (sin, cos) = libm::sincos(rad_per_s * time_s);
                // Sine and cosine part of each node, from the node it follows: a lag
                // divides by 1 + i x.
                let mut waves = [(sin * amplitude_c, cos * amplitude_c); NODES];
                for node in 0..NODES {
                    let (s, c) = self.parents[node].map_or(waves[node], |parent| waves[parent]);
                    let x = rad_per_s * self.time_constants_s[node];
                    let square = 1.0 + x * x;
                    waves[node] = ((s - x * c) / square, (c + x * s) / square);
                }
                core::array::from_fn(|node| mean_c + self.rises_c[node] + waves[node].0)
            }
        }
    }
}

impl Propagator {
    /// Works out the decay over `duration_s`.
    pub(crate) fn new(network: &ThermalNetwork, duration_s: f64) -> Self {
        let lags = network.lags();
        // A part without a time constant is where the part is that it follows.
        let solid = |node: usize| match lags[node].parent {
            Some(parent) if lags[node].time_constant_s == 0.0 => parent,
            _ => node,
        };
        let mut flow = [[0.0; NODES]; NODES];
        for (node, lag) in lags.iter().enumerate() {
            if lag.time_constant_s > 0.0 {
                flow[node][node] = -1.0 / lag.time_constant_s;
                if let Some(parent) = lag.parent {
                    flow[node][solid(parent)] = 1.0 / lag.time_constant_s;
                }
            }
        }
        let exponential = exp_of_flow(&flow, duration_s);
        let row = |node: usize| exponential[solid(solid(node))];
        Self {
            duration_s,
            decay: core::array::from_fn(|column| core::array::from_fn(|node| row(node)[column])),
        }
    }

    /// Moves the state along a course, from `time_s` after the course's beginning.
    pub(crate) fn advance(
        &self,
        state: &mut ThermalState,
        settled: &Settled,
        course: &Course,
        time_s: f64,
    ) {
        let before = settled.at(course, time_s);
        let mut after = settled.at(course, time_s + self.duration_s);
        for (column, decay) in self.decay.iter().enumerate() {
            let distance_c = state.0[column] - before[column];
            for (after_c, decay) in after.iter_mut().zip(decay) {
                *after_c += distance_c * decay;
            }
        }
        state.0 = after;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thermal::{BLOCK, CASE, CAVITY, Part, SENSOR};

    const NETWORK: ThermalNetwork = ThermalNetwork {
        case_time_constant_s: 360.0,
        block_time_constant_s: 200.0,
        // The second is equal to the case's, where closed forms divide 0 by 0.
        cavity_time_constant_s: [300.0, 360.0, 240.0],
        sensor_time_constant_s: 15.0,
        sensor_on: Part::Block,
        case_rise_c: 4.0,
        block_rise_c: 2.0,
        cavity_rise_c: [1.0, 0.5, 0.0],
    };

    const STILL: Course = Course::Line {
        start_c: 20.0,
        slope_c_per_s: 0.0,
    };

    /// Moves a state from the beginning of a course.
    fn advance(
        network: &ThermalNetwork,
        state: &mut ThermalState,
        course: &Course,
        step_s: f64,
        steps: u32,
    ) {
        let propagator = Propagator::new(network, step_s);
        let settled = Settled::new(network);
        for step in 0..steps {
            propagator.advance(state, &settled, course, step_s * f64::from(step));
        }
    }

    fn assert_close(state: &ThermalState, expected: &ThermalState, tolerance_c: f64) {
        for (node, (found, expected)) in state.0.iter().zip(expected.0).enumerate() {
            let error_c = (found - expected).abs();
            assert!(error_c < tolerance_c, "part {node}: {found} {expected}");
        }
    }

    #[test]
    fn a_step_of_the_air_has_the_analytic_response() {
        let network = ThermalNetwork {
            case_rise_c: 0.0,
            block_rise_c: 0.0,
            cavity_rise_c: [0.0; 3],
            ..NETWORK
        };
        let mut state = network.at_rest(20.0);
        let course = Course::Line {
            start_c: 70.0,
            slope_c_per_s: 0.0,
        };
        let (propagator, settled) = (Propagator::new(&network, 7.0), Settled::new(&network));
        for step in 1..=300 {
            let time_s = 7.0 * f64::from(step);
            propagator.advance(&mut state, &settled, &course, time_s - 7.0);
            // Partial fractions of the lags in a row, for different time constants.
            let share = |taus: &[f64]| {
                let parts = taus.iter().map(|a| {
                    let others = taus.iter().filter(|b| *b != a);
                    others.map(|b| a / (a - b)).product::<f64>() * (-time_s / a).exp()
                });
                1.0 - parts.sum::<f64>()
            };
            for (node, taus) in [
                (CASE, &[360.0][..]),
                (BLOCK, &[360.0, 200.0]),
                (CAVITY, &[360.0, 200.0, 300.0]),
                (CAVITY + 2, &[360.0, 200.0, 240.0]),
                (SENSOR, &[360.0, 200.0, 15.0]),
            ] {
                let expected = 20.0 + 50.0 * share(taus);
                let error_c = (state.0[node] - expected).abs();
                assert!(error_c < 1e-10, "{time_s} s, part {node}: {error_c}");
            }
        }
    }

    #[test]
    fn power_warms_every_part_to_its_rise() {
        let mut state = NETWORK.unpowered().at_rest(20.0);
        assert_eq!(state.case_c(), 20.0);
        advance(&NETWORK, &mut state, &STILL, 0.5, 720);
        let expected_c = 20.0 + 4.0 * (1.0 - (-1.0_f64).exp());
        assert!((state.case_c() - expected_c).abs() < 1e-10);
        advance(&NETWORK, &mut state, &STILL, 10.0, 10_000);
        assert_close(&state, &NETWORK.at_rest(20.0), 1e-10);
        assert_eq!(NETWORK.at_rest(20.0).cavity_c(), [27.0, 26.5, 26.0]);
    }

    #[test]
    fn on_a_long_ramp_each_part_lags_by_rate_times_time_constant() {
        let slope = 1.0 / 60.0;
        let course = Course::Line {
            start_c: 0.0,
            slope_c_per_s: slope,
        };
        let mut state = NETWORK.at_rest(0.0);
        advance(&NETWORK, &mut state, &course, 0.5, 40_000);
        let air_c = slope * 20_000.0;
        for (node, lag_s, rise_c) in [
            (CASE, 360.0, 4.0),
            (BLOCK, 560.0, 6.0),
            (CAVITY, 860.0, 7.0),
            (CAVITY + 1, 920.0, 6.5),
            (SENSOR, 575.0, 6.0),
        ] {
            let expected_c = air_c - slope * lag_s + rise_c;
            assert!((state.0[node] - expected_c).abs() < 1e-8, "part {node}");
        }
        for rate in NETWORK.cavity_rate_c_per_min(&state) {
            assert!((rate - 1.0).abs() < 1e-8, "{rate} degC/min");
        }
    }

    #[test]
    fn one_long_step_equals_many_short_ones() {
        for course in [
            Course::Line {
                start_c: 20.0,
                slope_c_per_s: -0.02,
            },
            Course::Sine {
                mean_c: 30.0,
                amplitude_c: 20.0,
                rad_per_s: 0.01,
            },
        ] {
            let start = ThermalState([30.0, 32.0, 10.0, 50.0, 35.0, 20.0]);
            let (mut coarse, mut fine) = (start, start);
            advance(&NETWORK, &mut coarse, &course, 1000.0, 1);
            advance(&NETWORK, &mut fine, &course, 0.25, 4000);
            assert_close(&coarse, &fine, 1e-9);
        }
    }

    #[test]
    fn agrees_with_a_numerical_integration_of_the_equations() {
        let (amplitude_c, rad_per_s) = (15.0, 0.02);
        let air_c = |t: f64| 50.0 + amplitude_c * (rad_per_s * t).sin();
        let course = Course::Sine {
            mean_c: 50.0,
            amplitude_c,
            rad_per_s,
        };
        let mut exact = NETWORK.unpowered().at_rest(20.0);
        advance(&NETWORK, &mut exact, &course, 600.0, 1);
        let slopes = |s: &[f64; NODES], t: f64| {
            let cavity = |axis: usize| {
                (s[BLOCK] + NETWORK.cavity_rise_c[axis] - s[CAVITY + axis])
                    / NETWORK.cavity_time_constant_s[axis]
            };
            [
                (air_c(t) + 4.0 - s[CASE]) / 360.0,
                (s[CASE] + 2.0 - s[BLOCK]) / 200.0,
                cavity(0),
                cavity(1),
                cavity(2),
                (s[BLOCK] - s[SENSOR]) / 15.0,
            ]
        };
        // Midpoint rule, error of the order of step^2.
        let step_s = 0.01;
        let mut state = [20.0; NODES];
        for step in 0..60_000 {
            let t = step_s * f64::from(step);
            let first = slopes(&state, t);
            let middle = core::array::from_fn(|i| state[i] + 0.5 * step_s * first[i]);
            let second = slopes(&middle, t + 0.5 * step_s);
            state = core::array::from_fn(|i| state[i] + step_s * second[i]);
        }
        assert_close(&exact, &ThermalState(state), 1e-5);
    }

    #[test]
    fn parts_without_a_time_constant_are_where_they_sit() {
        let network = ThermalNetwork {
            block_time_constant_s: 0.0,
            block_rise_c: 0.0,
            sensor_time_constant_s: 0.0,
            ..NETWORK
        };
        let course = Course::Line {
            start_c: 20.0,
            slope_c_per_s: 0.03,
        };
        let mut state = network.at_rest(20.0);
        advance(&network, &mut state, &course, 3.0, 100);
        assert_eq!(state.0[BLOCK], state.case_c());
        assert_eq!(state.sensor_c(), state.case_c());
        assert!(state.case_c() > 25.0);
    }

    #[test]
    fn stays_at_rest_in_still_air() {
        let mut state = NETWORK.at_rest(20.0);
        let start = state;
        advance(&NETWORK, &mut state, &STILL, 0.5, 1000);
        assert_eq!(state, start);
    }
}
