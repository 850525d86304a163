//! What a bias remembers: the paths its temperature has taken.

use serde::Deserialize;

use crate::check::{Invalid, Range};

/// Element of a Prandtl-Ishlinskii model of hysteresis: play of a half-width `w`, weighted.
///
/// ```text
/// p    = clamp(p before, T - w, T + w)       moves only when pushed
/// part = gain (T - p)                        within -gain w to gain w
/// ```
///
/// Such sums are a Preisach model: they depend on the order of turning points and not on time, loops
/// between the same two temperatures close, and a larger swing wipes out what smaller ones left.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Play {
    /// Half-width w, degC: of swings below twice as much nothing is remembered.
    pub half_width_c: f64,
    /// Rate unit per degC.
    pub gain: f64,
}

/// Steps of the path-length control of a ring laser.
///
/// The control keeps the laser on one longitudinal mode while the block expands, until its
/// transducer is at the end of its travel; then it moves to the next mode, and the bias steps. Modes
/// are `spacing_c` apart; the control stays on one until `overlap_c` beyond the middle between two.
/// Every other mode has the bias of the step. Within a mode the bias may drift with the temperature;
/// a hop then takes it back, and over several modes it is a sawtooth.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModeSteps {
    /// Temperature from one mode to the next, degC.
    pub spacing_c: f64,
    /// How far beyond the middle between two modes the control stays, degC; below half the spacing.
    pub overlap_c: f64,
    /// Bias of every other mode, rate unit.
    #[serde(default)]
    pub step: f64,
    /// Bias per degC from the middle of the mode, rate unit per degC.
    #[serde(default)]
    pub slope_per_c: f64,
}

impl Play {
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        Range::WIDTH.check("half_width_c", self.half_width_c)?;
        Range::SIGNED.check("gain", self.gain)
    }
}

impl ModeSteps {
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        Range::new(0.1, 300.0).check("spacing_c", self.spacing_c)?;
        Range::new(0.0, 0.499 * self.spacing_c).check("overlap_c", self.overlap_c)?;
        Range::SIGNED.check("step", self.step)?;
        Range::SIGNED.check("slope_per_c", self.slope_per_c)
    }
}

/// State of a [`Play`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlayState {
    play: Play,
    position_c: f64,
}

impl PlayState {
    /// In the middle of its play.
    pub(crate) fn new(play: Play, temperature_c: f64) -> Self {
        Self {
            play,
            position_c: temperature_c,
        }
    }

    /// Follows the temperature and returns the part of the bias.
    pub(crate) fn follow(&mut self, temperature_c: f64) -> f64 {
        let w = self.play.half_width_c;
        self.position_c = self.position_c.clamp(temperature_c - w, temperature_c + w);
        self.play.gain * (temperature_c - self.position_c)
    }
}

/// State of the path-length control.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ModeState {
    modes: ModeSteps,
    mode: f64,
}

impl ModeState {
    /// On the mode nearest to a temperature.
    pub(crate) fn new(modes: ModeSteps, temperature_c: f64) -> Self {
        Self {
            modes,
            mode: (temperature_c / modes.spacing_c + 0.5).floor(),
        }
    }

    /// Follows the temperature and returns the part of the bias.
    pub(crate) fn follow(&mut self, temperature_c: f64) -> f64 {
        let distance_c = temperature_c - self.mode * self.modes.spacing_c;
        if distance_c.abs() > 0.5 * self.modes.spacing_c + self.modes.overlap_c {
            *self = Self::new(self.modes, temperature_c);
        }
        // Halves of even numbers are whole.
        let half = 0.5 * self.mode;
        let step = if half.floor() == half {
            0.0
        } else {
            self.modes.step
        };
        let from_middle_c = temperature_c - self.mode * self.modes.spacing_c;
        step + self.modes.slope_per_c * from_middle_c
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAYS: [Play; 3] = [
        Play {
            half_width_c: 2.0,
            gain: 0.01,
        },
        Play {
            half_width_c: 8.0,
            gain: -0.004,
        },
        Play {
            half_width_c: 12.0,
            gain: 0.002,
        },
    ];

    /// Takes a sum of plays through turning points, in steps of 1/16 degC, and returns its value at
    /// every point passed.
    fn walk(states: &mut [PlayState; 3], from_c: f64, turning_c: &[f64]) -> Vec<(f64, f64)> {
        let mut passed = Vec::new();
        let mut t = from_c;
        for &to_c in turning_c {
            while t != to_c {
                t += 0.0625_f64.copysign(to_c - t);
                let sum = states.iter_mut().map(|state| state.follow(t)).sum();
                passed.push((t, sum));
            }
        }
        passed
    }

    fn fresh(at_c: f64) -> [PlayState; 3] {
        PLAYS.map(|play| PlayState::new(play, at_c))
    }

    #[test]
    fn loops_between_the_same_temperatures_close_and_are_open_inside() {
        let mut states = fresh(20.0);
        walk(&mut states, 20.0, &[70.0, -10.0]);
        let first = walk(&mut states, -10.0, &[70.0, -10.0]);
        let second = walk(&mut states, -10.0, &[70.0, -10.0]);
        assert_eq!(first, second);
        let at_20: Vec<f64> = first
            .iter()
            .filter(|(t, _)| *t == 20.0)
            .map(|(_, sum)| *sum)
            .collect();
        // Each play is at its stop both ways: twice the sum of gain times half-width.
        let open = 2.0 * (0.01 * 2.0 - 0.004 * 8.0 + 0.002 * 12.0);
        assert!((at_20[0] - at_20[1] - open).abs() < 1e-12, "{at_20:?}");
    }

    #[test]
    fn a_larger_swing_wipes_out_smaller_ones() {
        let (mut plain, mut wandering) = (fresh(20.0), fresh(20.0));
        walk(&mut plain, 20.0, &[70.0, -10.0]);
        walk(
            &mut wandering,
            20.0,
            &[25.0, 3.0, 55.0, 40.0, 41.0, 12.0, 70.0, 65.0, 68.0, -10.0],
        );
        assert_eq!(
            walk(&mut plain, -10.0, &[50.0]),
            walk(&mut wandering, -10.0, &[50.0])
        );
    }

    #[test]
    fn equal_swings_make_equal_loops_whatever_came_before() {
        // Congruency: minor loops between two temperatures have one shape, at two heights.
        let shape = |states: &mut [PlayState; 3], from_c: f64| {
            walk(states, from_c, &[30.0, 40.0]);
            let minor = walk(states, 40.0, &[30.0, 40.0]);
            let base = minor[0].1;
            minor
                .into_iter()
                .map(|(_, value)| value - base)
                .collect::<Vec<f64>>()
        };
        let (mut above, mut below) = (fresh(20.0), fresh(20.0));
        walk(&mut above, 20.0, &[75.0, 45.0]);
        walk(&mut below, 20.0, &[-15.0, 25.0]);
        let (first, second) = (shape(&mut above, 45.0), shape(&mut below, 25.0));
        for (a, b) in first.iter().zip(&second) {
            assert!((a - b).abs() < 1e-14);
        }
    }

    #[test]
    fn within_its_width_a_play_remembers_nothing() {
        let mut state = PlayState::new(PLAYS[1], 20.0);
        for t in [21.0, 27.9, 12.1, 20.0] {
            assert_eq!(state.follow(t), -0.004 * (t - 20.0));
        }
    }

    #[test]
    fn modes_step_later_than_the_middle_and_differ_up_and_down() {
        let modes = ModeSteps {
            spacing_c: 20.0,
            overlap_c: 3.0,
            step: 0.5,
            slope_per_c: 0.0,
        };
        let mut state = ModeState::new(modes, 1.0);
        let mut steps = Vec::new();
        let mut last = state.follow(1.0);
        let up = (1..=60).map(f64::from);
        for t in up.clone().chain(up.rev()) {
            let now = state.follow(t);
            if now != last {
                steps.push((t, now));
            }
            last = now;
        }
        assert_eq!(
            steps,
            [
                (14.0, 0.5),
                (34.0, 0.0),
                (54.0, 0.5),
                (46.0, 0.0),
                (26.0, 0.5),
                (6.0, 0.0)
            ]
        );
    }

    #[test]
    fn a_slope_within_modes_makes_a_sawtooth() {
        let modes = ModeSteps {
            spacing_c: 20.0,
            overlap_c: 3.0,
            step: 0.0,
            slope_per_c: 0.1,
        };
        let mut state = ModeState::new(modes, 0.0);
        for (temperature_c, expected) in [
            (0.0, 0.0),
            (13.0, 1.3),
            (14.0, -0.6),
            (33.0, 1.3),
            (34.0, -0.6),
            (27.0, -1.3),
            (26.0, 0.6),
        ] {
            let found = state.follow(temperature_c);
            assert!((found - expected).abs() < 1e-12, "{temperature_c}: {found}");
        }
    }
}
