//! Axes that repeat a value, bit by bit: dead, frozen, or cut off.

use super::Place;
use super::runs::{Run, Runs, Standing};

/// Looks at the runs of identical values of every axis.
///
/// A coarse output repeats its values by chance. So runs are judged by the usual ones of the same
/// axis: with noise wider than its steps by how often neighbours are the same, without such noise
/// only where a run stands apart from all others while the temperature moves.
#[derive(Clone, Debug)]
pub(super) struct Identical {
    axes: Vec<Runs>,
    temps_c: (f32, f32),
}

impl Identical {
    pub(super) fn new(axes: usize) -> Self {
        Self {
            axes: vec![Runs::new(); axes],
            temps_c: (f32::INFINITY, f32::NEG_INFINITY),
        }
    }

    pub(super) fn take(&mut self, time_s: &[f64], temp_c: &[f32], axes: &[&[f64]]) {
        for &temp_c in temp_c.iter().step_by(16) {
            self.temps_c.0 = self.temps_c.0.min(temp_c);
            self.temps_c.1 = self.temps_c.1.max(temp_c);
        }
        for (runs, values) in self.axes.iter_mut().zip(axes) {
            runs.take(time_s, temp_c, values);
        }
    }

    pub(super) fn finish(self) -> Vec<Place> {
        let axes = self.axes.into_iter().enumerate();
        let place = |(axis, mut runs): (usize, Runs)| {
            runs.finish();
            let standing = if runs.is_constant() {
                Some(whole(runs.longest()))
            } else {
                runs.without_noise()
                    .or_else(|| runs.while_temperature_moves(self.temps_c))
            }?;
            let Run {
                value,
                from_s,
                to_s,
                ..
            } = standing.longest;
            Some(Place {
                axis: Some(axis),
                rows: standing.rows,
                from_s: standing.from_s,
                to_s: standing.to_s,
                detail: format!("the value is {value} for {:.0} s on end", to_s - from_s),
            })
        };
        axes.filter_map(place).collect()
    }
}

const fn whole(run: &Run) -> Standing {
    Standing {
        rows: run.rows,
        from_s: run.from_s,
        to_s: run.to_s,
        longest: *run,
    }
}
