//! The floor: least squares on true states, from the same logs as the fit.
//!
//! What a fit cannot do better than: drift and noise remain. Mode hops are known, as plays are.

use nalgebra::{DMatrix, DVector};
use tempco_twin::{Axis, ModeSteps, Unit};

use crate::fitted::error;
use crate::run::Run;

/// Cells of the quadratic spline.
const CELLS: usize = 12;

/// Functions of the spline.
const SPLINES: usize = CELLS + 2;

/// Columns of the rate: T', T T' and T''.
const RATES: usize = 3;

/// Columns of the modes: every other one, and the distance from the middle of one.
const MODES: usize = 2;

/// Rows of a log that make one row of least squares.
const BLOCK_ROWS: usize = 10;

/// Keeps columns that are not in the logs at 0, as a share of the mean of the diagonal.
const RIDGE: f64 = 1e-10;

/// A model of an axis in the true temperature of its cavity.
pub(crate) struct TrueStates {
    number: usize,
    axis: Axis,
    /// Coldest and hottest cavity of the calibration \[degC\].
    range_c: (f64, f64),
    coefficients: DVector<f64>,
}

impl TrueStates {
    /// Fits axis number `number` of a unit.
    ///
    /// # Panics
    /// If there are no logs.
    pub(crate) fn fit(unit: &Unit, number: usize, training: &[Run]) -> Self {
        let temps_c = training.iter().flat_map(|run| &run.cavity_c[number]);
        let range_c = temps_c.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &t| {
            (low.min(t), high.max(t))
        });
        let mut states = Self {
            number,
            axis: unit.axes[number].clone(),
            range_c,
            coefficients: DVector::zeros(0),
        };
        // The spline holds the constant of the first log; each other log has one of its own.
        let own = training.len() - 1;
        let columns = states.columns() + own;
        let mut normal = DMatrix::zeros(columns, columns);
        let mut right = DVector::zeros(columns);
        for (log, run) in training.iter().enumerate() {
            let raw = &run.log.channels[0].axes[number].raw;
            let rows = states.rows(run);
            for (rows, raw) in rows.chunks(BLOCK_ROWS).zip(raw.chunks(BLOCK_ROWS)) {
                let mut block = DVector::zeros(columns);
                for row in rows {
                    let mut sum = block.rows_mut(0, row.len());
                    sum += row;
                }
                block /= rows.len() as f64;
                if log > 0 {
                    block[columns - own + log - 1] = 1.0;
                }
                normal.ger(1.0, &block, &block, 1.0);
                right.axpy(raw.iter().sum::<f64>() / raw.len() as f64, &block, 1.0);
            }
        }
        let ridge = RIDGE * normal.trace() / columns as f64;
        for column in 0..columns {
            normal[(column, column)] += ridge;
        }
        let solved = normal
            .cholesky()
            .expect("a ridge makes it definite")
            .solve(&right);
        states.coefficients = solved.rows(0, columns - own).into_owned();
        states
    }

    /// Rms of the error on a mission, as of the applied bias \[unit of the axis\].
    pub(crate) fn error(&self, mission: &Run) -> f64 {
        let rows = self.rows(mission);
        let pairs = rows.iter().zip(&mission.truth[self.number]);
        let errors = pairs.map(|(row, truth)| row.dot(&self.coefficients) - truth);
        error(&mission.log.time_s, &errors.collect::<Vec<_>>())
    }

    fn columns(&self) -> usize {
        SPLINES + RATES + MODES + self.axis.play.len()
    }

    /// The regressors of each row of a run.
    fn rows(&self, run: &Run) -> Vec<DVector<f64>> {
        let temps_c = &run.cavity_c[self.number];
        let rates = derivative(temps_c, run.log.interval_s);
        let accelerations = derivative(&rates, run.log.interval_s);
        let mut contacts_c = vec![temps_c[0]; self.axis.play.len()];
        let mut mode = self.axis.modes.map(|modes| nearest(modes, temps_c[0]));
        let (low_c, high_c) = self.range_c;
        let rows = temps_c.iter().zip(rates).zip(accelerations);
        let rows = rows.map(|((&temp_c, rate), acceleration)| {
            let mut row = DVector::zeros(self.columns());
            let z = (temp_c - low_c) / (high_c - low_c);
            let (cell, values) = spline(z);
            row.as_mut_slice()[cell..cell + 3].copy_from_slice(&values);
            row[SPLINES] = rate;
            row[SPLINES + 1] = z * rate;
            row[SPLINES + 2] = acceleration;
            if let (Some(modes), Some(mode)) = (self.axis.modes, &mut mode) {
                let columns = hop(modes, mode, temp_c);
                row.as_mut_slice()[SPLINES + RATES..][..MODES].copy_from_slice(&columns);
            }
            let plays = self.axis.play.iter().zip(&mut contacts_c);
            for (number, (play, contact_c)) in plays.enumerate() {
                let width_c = play.half_width_c;
                *contact_c = contact_c.clamp(temp_c - width_c, temp_c + width_c);
                row[SPLINES + RATES + MODES + number] = temp_c - *contact_c;
            }
            row
        });
        rows.collect()
    }
}

/// The mode nearest to a temperature.
fn nearest(modes: ModeSteps, temp_c: f64) -> f64 {
    (temp_c / modes.spacing_c).round()
}

/// Hops if the temperature is too far from the middle of the mode. The columns of the mode.
fn hop(modes: ModeSteps, mode: &mut f64, temp_c: f64) -> [f64; MODES] {
    let distance_c = |mode: f64| temp_c - mode * modes.spacing_c;
    if distance_c(*mode).abs() > 0.5 * modes.spacing_c + modes.overlap_c {
        *mode = nearest(modes, temp_c);
    }
    [mode.rem_euclid(2.0), distance_c(*mode)]
}

/// Change per minute, by central differences; none at the ends.
fn derivative(values: &[f64], interval_s: f64) -> Vec<f64> {
    let mut derivative = vec![0.0; values.len()];
    for row in 1..values.len() - 1 {
        derivative[row] = (values[row + 1] - values[row - 1]) * 30.0 / interval_s;
    }
    derivative
}

/// The cell of `z`, 0 to 1 over all cells, and the three functions of a quadratic B-spline that are
/// not 0 in it. Beyond the ends the last cell goes on.
fn spline(z: f64) -> (usize, [f64; 3]) {
    let place = z * CELLS as f64;
    let cell = place.clamp(0.0, (CELLS - 1) as f64).floor();
    let x = place - cell;
    let values = [
        0.5 * (1.0 - x).powi(2),
        0.5 + x * (1.0 - x),
        0.5 * x.powi(2),
    ];
    (cell as usize, values)
}

#[cfg(test)]
mod tests {
    use tempco_twin::{Drift, GyroNoise, Profile};

    use super::*;

    #[test]
    fn the_spline_adds_up_to_1_and_is_continuous() {
        for step in 0..=100 {
            let (_, values) = spline(f64::from(step) / 100.0);
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
        let [(before, a), (after, b)] = [0.25 - 1e-12, 0.25 + 1e-12].map(spline);
        assert_eq!((before, after), (2, 3));
        assert!((a[1] - b[0]).abs() < 1e-9 && (a[2] - b[1]).abs() < 1e-9 && b[2] < 1e-9);
    }

    /// A unit with nothing but a curve, rate terms, plays and modes is known but for pulses.
    #[test]
    fn without_noise_and_drift_little_is_left() {
        for name in ["loop", "mode_hops"] {
            let mut unit = Unit::named(name).unwrap();
            for axis in &mut unit.axes {
                axis.noise = GyroNoise::NONE;
                axis.drift = Drift::default();
            }
            let run = |profile: &str, seed| {
                Run::simulate(&unit, &Profile::named(profile).unwrap(), seed).unwrap()
            };
            let (training, mission) = (run("calibration", 1), run("verification", 2));
            for axis in 0..3 {
                let mut states = TrueStates::fit(&unit, axis, std::slice::from_ref(&training));
                let size = error(&mission.log.time_s, &mission.truth[axis]);
                let left = states.error(&mission) / size;
                assert!(left < 0.05, "{name}: {left}");
                let history = &mut states.coefficients.as_mut_slice()[SPLINES + RATES..];
                history.fill(0.0);
                assert!(states.error(&mission) / size > 3.0 * left, "{name}");
            }
        }
    }
}
