//! A temperature that stands still while the unit's temperature does not.

use super::Place;
use super::runs::{Run, Runs};
use crate::decimate::Decimated;

/// Rows that the movement of the axes is taken from.
const SAMPLE: usize = 1 << 12;

/// Means of the axes during a run.
const PARTS: usize = 32;

/// Rows of the sample in each of them, at least.
const LEAST_ROWS: usize = 4;

/// A shorter stand without noise to judge it by says nothing \[s\].
const LEAST_S: f64 = 600.0;

/// Elsewhere the temperature must move by this much, or the movement of an axis says nothing
/// \[degC\].
const LEAST_C: f64 = 5.0;

/// Half the mean square of the steps from mean to mean, as a share of their variance: of noise
/// alone 1, of two ramps up and down 0.1, of a steady drift 0.006.
const STEADY: f64 = 0.2;

/// Shares of their movement elsewhere by which the axes move during a stand: worth a warning, and
/// plainly the temperature's work.
const MOVES: (f64, f64) = (0.25, 0.35);

/// What the movement of an only axis counts for. It may drift by itself; two of them hardly do.
const ALONE: f64 = 0.6;

/// Looks at the runs of identical temperatures.
///
/// A real soak stands too, if the steps of the sensor are coarse. What tells a frozen sensor:
///
/// - The temperature has noise wider than its steps elsewhere, and none here.
/// - Or it has none, but axes move here, after the first third of the stand, as they do elsewhere
///   with temperature. The first third is left to the lag of the unit.
#[derive(Clone, Debug)]
pub(super) struct FrozenTemperature {
    runs: Runs,
    /// Rows of the log, evenly spaced: time, temperature, axes.
    time_s: Decimated,
    temp_c: Decimated,
    axes: Vec<Decimated>,
    rows: usize,
}

impl FrozenTemperature {
    pub(super) fn new(axes: usize) -> Self {
        Self {
            runs: Runs::new(),
            time_s: Decimated::new(SAMPLE),
            temp_c: Decimated::new(SAMPLE),
            axes: vec![Decimated::new(SAMPLE); axes],
            rows: 0,
        }
    }

    pub(super) fn take(&mut self, time_s: &[f64], temp_c: &[f32], axes: &[&[f64]]) {
        let rows = time_s.len();
        self.rows += rows;
        self.runs.take(time_s, temp_c, temp_c);
        self.time_s.extend(rows, |row| time_s[row]);
        self.temp_c.extend(rows, |row| temp_c[row].into());
        for (kept, values) in self.axes.iter_mut().zip(axes) {
            kept.extend(rows, |row| values[row]);
        }
    }

    /// Stands that are surely a fault, and stands that may be one.
    pub(super) fn finish(mut self) -> (Vec<Place>, Vec<Place>) {
        self.runs.finish();
        let (mut frozen, mut standing) = (Vec::new(), Vec::new());
        if self.runs.is_constant() {
            return (frozen, standing);
        }
        if self.runs.is_noisy() {
            let found = self.runs.without_noise();
            let Some(found) = found else {
                return (frozen, standing);
            };
            let place = place(&found.longest, found.rows, (found.from_s, found.to_s));
            // A few rows in a long log do not spoil it.
            let is_much = found.rows as f64 >= 0.02 * self.rows as f64;
            if is_much { &mut frozen } else { &mut standing }.push(place);
            return (frozen, standing);
        }
        let run = self.runs.longest();
        let movement = self.movement(run);
        let place = place(run, run.rows, (run.from_s, run.to_s));
        if movement >= MOVES.1 {
            frozen.push(place);
        } else if movement >= MOVES.0 {
            standing.push(place);
        }
        (frozen, standing)
    }

    /// By how much the axes move during a run, as a share of their movement elsewhere; 0 where that
    /// cannot be known. Of several axes it is the second largest share.
    fn movement(&self, run: &Run) -> f64 {
        let times = self.time_s.values();
        let start = times.partition_point(|&time_s| time_s < run.from_s);
        let end = times.partition_point(|&time_s| time_s <= run.to_s);
        let settled = start + (end - start) / 3;
        let part = (end - settled) / PARTS;
        if part < LEAST_ROWS || run.to_s - run.from_s < LEAST_S {
            return 0.0;
        }
        let elsewhere = |values: &[f64]| {
            let parts = values[..start].chunks_exact(part);
            range(&means(parts.chain(values[end..].chunks_exact(part))))
        };
        if elsewhere(self.temp_c.values()) < LEAST_C {
            return 0.0;
        }
        let shares = self.axes.iter().map(|axis| {
            let values = axis.values();
            let here = means(values[settled..end].chunks_exact(part));
            let elsewhere = elsewhere(values);
            match is_steady(&here) && elsewhere > 0.0 {
                true => range(&here) / elsewhere,
                false => 0.0,
            }
        });
        let mut shares: Vec<f64> = shares.collect();
        shares.sort_by(|a, b| b.total_cmp(a));
        match shares[..] {
            [] => 0.0,
            [only] => ALONE * only,
            [_, second, ..] => second,
        }
    }
}

fn means<'a>(parts: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    parts.map(mean).collect()
}

fn range(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (high - low).max(0.0)
}

/// Whether values follow each other instead of scattering.
fn is_steady(values: &[f64]) -> bool {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count;
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
    0.5 * steps.sum::<f64>() / (count - 1.0) < STEADY * variance
}

fn place(run: &Run, rows: usize, (from_s, to_s): (f64, f64)) -> Place {
    let on_end = run.to_s - run.from_s;
    Place {
        axis: None,
        rows,
        from_s,
        to_s,
        detail: format!(
            "it stands at {} degC for {on_end:.0} s on end",
            run.value as f32
        ),
    }
}
