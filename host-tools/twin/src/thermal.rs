//! Heat flow: air to case, case to the cavity of each gyro.

/// Time constants of a unit's heat flow, each a first-order lag.
///
/// ```text
/// d(case)/dt   = (air  - case)   / case_time_constant_s
/// d(cavity)/dt = (case - cavity) / cavity_time_constant_s    for each axis
/// ```
///
/// The temperature sensor sits on the case. On a long ramp the case lags the air, and the cavity
/// the case, by rate x time constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThermalNetwork {
    /// Air to case, s, positive.
    pub case_time_constant_s: f64,
    /// Case to the cavity of the X, Y and Z gyro, s, positive.
    pub cavity_time_constant_s: [f64; 3],
}

/// Temperatures of the parts, degC.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ThermalState {
    pub(crate) case_c: f64,
    pub(crate) cavity_c: [f64; 3],
}

impl ThermalState {
    /// All parts at one temperature.
    pub(crate) fn uniform(temperature_c: f64) -> Self {
        Self {
            case_c: temperature_c,
            cavity_c: [temperature_c; 3],
        }
    }
}

impl ThermalNetwork {
    /// Rate of each cavity's temperature, degC/min.
    pub(crate) fn cavity_rate_c_per_min(&self, state: &ThermalState) -> [f64; 3] {
        core::array::from_fn(|axis| {
            60.0 * (state.case_c - state.cavity_c[axis]) / self.cavity_time_constant_s[axis]
        })
    }
}

/// Moves a [`ThermalState`] over one fixed time, exactly, while the air is linear.
///
/// With `e = case - air_lagged` and `f = cavity - air_lagged_twice`, the distances from the lines
/// that case and cavity follow on an endless ramp, a step of `h` gives
///
/// ```text
/// e1 = e0 exp(-h/ts)
/// f1 = f0 exp(-h/tc) + e0 (h/tc) exp(-h/tc) expm1(x)/x,   x = h (1/tc - 1/ts)
/// ```
///
/// The last factor is the convolution of the two exponentials in a form that stays accurate when
/// the time constants `ts` and `tc` are close or equal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Propagator {
    network: ThermalNetwork,
    duration_s: f64,
    case_decay: f64,
    cavity_decay: [f64; 3],
    case_to_cavity: [f64; 3],
}

impl Propagator {
    /// Works out the coefficients for a step of `duration_s`.
    pub(crate) fn new(network: &ThermalNetwork, duration_s: f64) -> Self {
        let case_s = network.case_time_constant_s;
        let cavity_decay = network
            .cavity_time_constant_s
            .map(|cavity_s| libm::exp(-duration_s / cavity_s));
        let case_to_cavity = core::array::from_fn(|axis| {
            let cavity_s = network.cavity_time_constant_s[axis];
            let x = duration_s * (1.0 / cavity_s - 1.0 / case_s);
            duration_s / cavity_s * cavity_decay[axis] * expm1_ratio(x)
        });
        Self {
            network: *network,
            duration_s,
            case_decay: libm::exp(-duration_s / case_s),
            cavity_decay,
            case_to_cavity,
        }
    }

    /// Moves the state; the air is at `air_c` when the step begins and changes by
    /// `slope_c_per_s` throughout it.
    pub(crate) fn advance(&self, state: &mut ThermalState, air_c: f64, slope_c_per_s: f64) {
        let rise_c = slope_c_per_s * self.duration_s;
        let case_line_c = air_c - slope_c_per_s * self.network.case_time_constant_s;
        let case_distance_c = state.case_c - case_line_c;
        for axis in 0..3 {
            let cavity_line_c =
                case_line_c - slope_c_per_s * self.network.cavity_time_constant_s[axis];
            state.cavity_c[axis] = cavity_line_c
                + rise_c
                + (state.cavity_c[axis] - cavity_line_c) * self.cavity_decay[axis]
                + case_distance_c * self.case_to_cavity[axis];
        }
        state.case_c = case_line_c + rise_c + case_distance_c * self.case_decay;
    }
}

/// `(exp(x) - 1) / x`, 1 at 0.
fn expm1_ratio(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { libm::expm1(x) / x }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NETWORK: ThermalNetwork = ThermalNetwork {
        case_time_constant_s: 360.0,
        // The second is equal to the case's, where the plain closed form divides 0 by 0.
        cavity_time_constant_s: [300.0, 360.0, 240.0],
    };

    fn advance_by(state: &mut ThermalState, step_s: f64, steps: u32, air_c: f64, slope: f64) {
        let propagator = Propagator::new(&NETWORK, step_s);
        for step in 0..steps {
            propagator.advance(state, air_c + slope * step_s * f64::from(step), slope);
        }
    }

    #[test]
    fn on_a_long_ramp_each_part_lags_by_rate_times_time_constant() {
        let slope = 1.0 / 60.0;
        let mut state = ThermalState::uniform(0.0);
        advance_by(&mut state, 0.5, 40_000, 0.0, slope);
        let air_c = slope * 20_000.0;
        assert!((air_c - state.case_c - slope * 360.0).abs() < 1e-9);
        for (axis, tau_s) in NETWORK.cavity_time_constant_s.into_iter().enumerate() {
            let lag_c = state.case_c - state.cavity_c[axis];
            assert!((lag_c - slope * tau_s).abs() < 1e-9, "axis {axis}: {lag_c}");
            let rate = NETWORK.cavity_rate_c_per_min(&state)[axis];
            assert!((rate - 1.0).abs() < 1e-9, "axis {axis}: {rate} degC/min");
        }
    }

    #[test]
    fn one_long_step_equals_many_short_ones() {
        let start = ThermalState {
            case_c: 30.0,
            cavity_c: [10.0, 50.0, 35.0],
        };
        let (mut coarse, mut fine) = (start, start);
        advance_by(&mut coarse, 1000.0, 1, 20.0, -0.02);
        advance_by(&mut fine, 0.25, 4000, 20.0, -0.02);
        assert!((coarse.case_c - fine.case_c).abs() < 1e-9);
        for axis in 0..3 {
            assert!((coarse.cavity_c[axis] - fine.cavity_c[axis]).abs() < 1e-9);
        }
    }

    #[test]
    fn agrees_with_a_numerical_integration() {
        let mut exact = ThermalState::uniform(20.0);
        advance_by(&mut exact, 600.0, 1, 50.0, 0.01);
        // Midpoint rule, error of the order of step^2.
        let step_s = 0.01;
        let mut state = ThermalState::uniform(20.0);
        for step in 0..60_000 {
            let air_c = 50.0 + 0.01 * step_s * (f64::from(step) + 0.5);
            let case_middle_c = state.case_c + 0.5 * step_s * (air_c - state.case_c) / 360.0;
            for (cavity_c, tau_s) in state
                .cavity_c
                .iter_mut()
                .zip(NETWORK.cavity_time_constant_s)
            {
                let middle_c = *cavity_c + 0.5 * step_s * (case_middle_c - *cavity_c) / tau_s;
                *cavity_c += step_s * (case_middle_c - middle_c) / tau_s;
            }
            state.case_c += step_s * (air_c - case_middle_c) / 360.0;
        }
        assert!((exact.case_c - state.case_c).abs() < 1e-6);
        for axis in 0..3 {
            assert!((exact.cavity_c[axis] - state.cavity_c[axis]).abs() < 1e-5);
        }
    }

    #[test]
    fn stays_at_rest_in_still_air() {
        let mut state = ThermalState::uniform(20.0);
        advance_by(&mut state, 0.5, 1000, 20.0, 0.0);
        assert_eq!(state, ThermalState::uniform(20.0));
    }
}
