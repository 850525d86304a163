//! The part of an axis's bias that temperature decides.

use crate::hysteresis::{ModeState, PlayState};
use crate::thermal::{ThermalNetwork, ThermalState};
use crate::unit::{Axis, Unit};

/// The bias that the temperatures of a unit and their history make, for one axis:
///
/// ```text
/// static(T) + g (1 + k (T - 25)) T' + h (case - T) + sum of plays + mode
/// ```
///
/// with T and T' of the cavity.
#[derive(Debug, Clone)]
pub(crate) struct ThermalBias {
    axis: Axis,
    plays: Vec<PlayState>,
    mode: Option<ModeState>,
}

impl ThermalBias {
    pub(crate) fn new(axis: &Axis, cavity_c: f64) -> Self {
        let play = |play: &_| PlayState::new(*play, cavity_c);
        Self {
            plays: axis.play.iter().map(play).collect(),
            mode: axis.modes.map(|modes| ModeState::new(modes, cavity_c)),
            axis: axis.clone(),
        }
    }

    /// Bias, rate unit.
    fn follow(&mut self, cavity_c: f64, rate_c_per_min: f64, case_c: f64) -> f64 {
        let axis = &self.axis;
        let factor = 1.0 + axis.rate_sensitivity_slope_per_c * (cavity_c - 25.0);
        let mut bias = axis.static_curve.value(cavity_c)
            + axis.rate_sensitivity * factor * rate_c_per_min
            + axis.gradient_sensitivity * (case_c - cavity_c);
        for play in &mut self.plays {
            bias += play.follow(cavity_c);
        }
        if let Some(mode) = &mut self.mode {
            bias += mode.follow(cavity_c);
        }
        bias
    }
}

/// The biases of all axes of a unit.
#[derive(Debug, Clone)]
pub(crate) struct ThermalBiases {
    network: ThermalNetwork,
    axes: [ThermalBias; 3],
}

impl ThermalBiases {
    pub(crate) fn new(unit: &Unit, state: &ThermalState) -> Self {
        let cavity_c = state.cavity_c();
        Self {
            network: unit.thermal,
            axes: core::array::from_fn(|axis| ThermalBias::new(&unit.axes[axis], cavity_c[axis])),
        }
    }

    /// Power comes on: the path-length control takes the mode nearest to the temperature.
    pub(crate) fn power_on(&mut self, state: &ThermalState) {
        for (axis, cavity_c) in self.axes.iter_mut().zip(state.cavity_c()) {
            axis.mode = axis.axis.modes.map(|modes| ModeState::new(modes, cavity_c));
        }
    }

    /// Bias of each axis, rate unit.
    pub(crate) fn follow(&mut self, state: &ThermalState) -> [f64; 3] {
        let rate_c_per_min = self.network.cavity_rate_c_per_min(state);
        let cavity_c = state.cavity_c();
        let case_c = state.case_c();
        core::array::from_fn(|axis| {
            self.axes[axis].follow(cavity_c[axis], rate_c_per_min[axis], case_c)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_part_grows_with_temperature() {
        let axis = &Unit::named("paper").unwrap().axes[0];
        let part = |cavity_c: f64, rate: f64| {
            let mut bias = ThermalBias::new(axis, cavity_c);
            bias.follow(cavity_c, rate, cavity_c) - bias.follow(cavity_c, 0.0, cavity_c)
        };
        assert!((part(25.0, -2.0) + 0.14).abs() < 1e-15);
        assert!((part(75.0, 1.0) - 0.084).abs() < 1e-15);
        assert_eq!(part(75.0, 0.0), 0.0);
    }

    #[test]
    fn the_gradient_part_is_of_the_difference_to_the_case() {
        let axis = Axis {
            gradient_sensitivity: 0.01,
            ..Unit::named("paper").unwrap().axes[1].clone()
        };
        let mut bias = ThermalBias::new(&axis, 30.0);
        let part = bias.follow(30.0, 0.0, 34.0) - bias.follow(30.0, 0.0, 30.0);
        assert!((part - 0.04).abs() < 1e-15);
    }

    #[test]
    fn power_takes_the_nearest_mode() {
        let unit = Unit::named("mode_hops").unwrap();
        let at = |temperature_c: f64| unit.thermal.unpowered().at_rest(temperature_c);
        let mut biases = ThermalBiases::new(&unit, &at(-15.0));
        // Modes of X are 22 degC apart, and the one at -22 degC reaches up to -7 degC.
        let kept = biases.follow(&at(-9.5))[0];
        biases.power_on(&at(-9.5));
        let taken = biases.follow(&at(-9.5))[0];
        assert!(
            (kept - taken - 22.0 * 0.0018).abs() < 1e-12,
            "{kept} {taken}"
        );
    }
}
