//! Axes that are running totals, such as a counter that nobody resets.
//!
//! A bias follows the temperature: what it gains on the way up it loses on the way down, and where
//! the temperature returns it does. A total grows by the bias. So its growth, not its value, is what
//! the temperature explains. Both are seen in a sample of the log, where noise weighs as much as in
//! a row: the growth of a total exceeds it, the changes of a bias hardly do.
//!
//! Where the temperature goes one way only, both may look the same, and nothing is found.

use super::Place;

/// Rows that are added up at a time, the closest that samples are.
const BLOCK: usize = 16;

/// Of so many rows one is looked at: a total grows on between them.
const STEP: usize = 2;

/// Samples are between half as many and as many.
const MOST_SAMPLES: usize = 512;

/// Fewer samples are not judged.
const LEAST_SAMPLES: usize = 64;

/// A change this many times the usual one is a wrap, a restart or a spike, and is left out.
const UNUSUAL: f64 = 8.0;

/// Weight of a block in the size of a usual change.
const WEIGHT: f64 = 0.125;

/// The range of temperature is cut into so many bins.
const BINS: usize = 16;

/// Growth is that of a total if the bins leave less than this share of its squares. They leave 0.8
/// to 1.05 of noise and of biases, 0.35 of a bias without noise that answers to the rate alone.
const GROWTH_LEFT: f64 = 0.25;

/// Values are no bias if the bins leave more than this share of their variance.
const VALUES_LEFT: f64 = 0.13;

/// A total grows in every quarter of the log, by this share at least.
const QUARTER: f64 = 0.03;

/// Keeps samples of temperature and axes.
#[derive(Clone, Debug)]
pub(super) struct RunningTotal {
    rows: usize,
    from_s: f64,
    to_s: f64,
    /// Blocks from sample to sample.
    stride: usize,
    temps_c: Vec<f32>,
    axes: Vec<Axis>,
}

#[derive(Clone, Debug)]
struct Axis {
    last: f64,
    /// Sum of all usual changes.
    sum: f64,
    /// Size of a usual change that is not zero; 0 until one is known.
    usual: f64,
    /// Sizes of the block's changes, unusual ones cut, and the number of those that are not zero.
    sizes: f64,
    changes: f64,
    samples: Vec<f64>,
}

impl Axis {
    /// Every so many rows, from the first on.
    #[inline]
    fn rows(&mut self, values: &[f64]) {
        let limit = UNUSUAL * self.usual;
        let cut = if self.usual == 0.0 {
            f64::INFINITY
        } else {
            limit
        };
        for &value in values.iter().step_by(STEP) {
            let change = value - self.last;
            let size = change.abs();
            self.last = value;
            self.sum += if size <= limit { change } else { 0.0 };
            self.sizes += size.min(cut);
            self.changes += if change == 0.0 { 0.0 } else { 1.0 };
        }
    }

    fn end_block(&mut self) {
        if self.changes > 0.0 {
            let size = self.sizes / self.changes;
            let weight = if self.usual == 0.0 { 1.0 } else { WEIGHT };
            self.usual += weight * (size - self.usual);
        }
        (self.sizes, self.changes) = (0.0, 0.0);
    }

    fn is_total(&self, bins: &[usize]) -> bool {
        let values = &self.samples;
        let growth: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let squares = |of: &[f64]| of.iter().map(|value| value * value).sum::<f64>();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let from_mean: Vec<f64> = values.iter().map(|value| value - mean).collect();
        let quarters = growth.chunks(growth.len().div_ceil(4));
        let sizes = quarters.map(|quarter| quarter.iter().map(|change| change.abs()).sum::<f64>());
        let least = sizes.clone().fold(f64::INFINITY, f64::min);
        squares(&growth) > 0.0
            && left(&growth, bins) < GROWTH_LEFT * squares(&growth)
            && left(&from_mean, bins) > VALUES_LEFT * squares(&from_mean)
            && least > QUARTER * sizes.sum::<f64>()
    }
}

/// Sum of squares about the means of the bins, corrected for what the means take.
fn left(values: &[f64], bins: &[usize]) -> f64 {
    let (mut counts, mut sums, mut squares) = ([0.0; BINS], [0.0; BINS], [0.0; BINS]);
    for (&value, &bin) in values.iter().zip(bins) {
        counts[bin] += 1.0;
        sums[bin] += value;
    }
    for (&value, &bin) in values.iter().zip(bins) {
        squares[bin] += (value - sums[bin] / counts[bin]).powi(2);
    }
    let corrected = |bin: usize| match counts[bin] > 1.0 {
        true => squares[bin] * counts[bin] / (counts[bin] - 1.0),
        false => 0.0,
    };
    (0..BINS).map(corrected).sum()
}

impl RunningTotal {
    pub(super) fn new(axes: usize) -> Self {
        let axis = Axis {
            last: 0.0,
            sum: 0.0,
            usual: 0.0,
            sizes: 0.0,
            changes: 0.0,
            samples: Vec::with_capacity(MOST_SAMPLES),
        };
        Self {
            rows: 0,
            from_s: 0.0,
            to_s: 0.0,
            stride: 1,
            temps_c: Vec::with_capacity(MOST_SAMPLES),
            axes: vec![axis; axes],
        }
    }

    pub(super) fn take(&mut self, time_s: &[f64], temp_c: &[f32], axes: &[&[f64]]) {
        let (Some(&first_s), Some(&last_s)) = (time_s.first(), time_s.last()) else {
            return;
        };
        if self.rows == 0 {
            self.from_s = first_s;
            for (axis, values) in self.axes.iter_mut().zip(axes) {
                axis.last = values[0];
            }
        }
        self.to_s = last_s;
        let mut start = 0;
        while start < time_s.len() {
            let end = time_s.len().min(start + BLOCK - self.rows % BLOCK);
            // The last of each step, however the rows come.
            let first = end.min(start + STEP - 1 - self.rows % STEP);
            for (axis, values) in self.axes.iter_mut().zip(axes) {
                axis.rows(&values[first..end]);
            }
            self.rows += end - start;
            if self.rows.is_multiple_of(BLOCK) {
                self.axes.iter_mut().for_each(Axis::end_block);
                if (self.rows / BLOCK).is_multiple_of(self.stride) {
                    self.sample(temp_c[end - 1]);
                }
            }
            start = end;
        }
    }

    /// Keeps a sample, and of too many every other one.
    fn sample(&mut self, temp_c: f32) {
        self.temps_c.push(temp_c);
        for axis in &mut self.axes {
            axis.samples.push(axis.sum);
        }
        if self.temps_c.len() == MOST_SAMPLES {
            self.stride *= 2;
            halve(&mut self.temps_c);
            for axis in &mut self.axes {
                halve(&mut axis.samples);
            }
        }
    }

    pub(super) fn finish(self) -> Vec<Place> {
        if self.temps_c.len() < LEAST_SAMPLES {
            return Vec::new();
        }
        let bins = bins(&self.temps_c);
        let totals = self
            .axes
            .iter()
            .enumerate()
            .filter(|(_, axis)| axis.is_total(&bins));
        let place = |(number, axis): (usize, &Axis)| Place {
            axis: Some(number),
            rows: self.rows,
            from_s: self.from_s,
            to_s: self.to_s,
            detail: format!(
                "changes by {:.1} in all, {:.1} in {STEP} rows, whatever the temperature does",
                axis.sum, axis.usual
            ),
        };
        totals.map(place).collect()
    }
}

/// Keeps every second one.
fn halve<T>(samples: &mut Vec<T>) {
    let mut number = 0;
    samples.retain(|_| {
        number += 1;
        number % 2 == 0
    });
}

/// The bin of each temperature. The ends of the range leave out what an open sensor read.
fn bins(temps_c: &[f32]) -> Vec<usize> {
    let mut sorted = temps_c.to_vec();
    sorted.sort_unstable_by(f32::total_cmp);
    let left_out = temps_c.len() / 50;
    let (low_c, high_c) = (sorted[left_out], sorted[temps_c.len() - 1 - left_out]);
    let per_c = BINS as f32 / (high_c - low_c).max(f32::MIN_POSITIVE);
    let bin = |temp_c: &f32| (((temp_c - low_c) * per_c) as usize).min(BINS - 1);
    temps_c.iter().map(bin).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::signals::made::{Made, Noise, rounded, up_and_down};

    const CURVES: [(f64, f64, f64); 3] = [
        (0.5, 0.012, 1.2e-4),
        (-0.3, -0.008, 0.8e-4),
        (0.1, 0.005, -0.5e-4),
    ];

    fn found(log: &Made) -> Vec<Place> {
        let mut detector = RunningTotal::new(log.axes.len());
        log.parts(|time_s, temp_c, axes| detector.take(time_s, temp_c, axes));
        detector.finish()
    }

    fn bias(curve: usize, temp_c: f64) -> f64 {
        let (d, (b0, b1, b2)) = (temp_c - 25.0, CURVES[curve]);
        b0 + d * (b1 + d * b2)
    }

    /// Three axes that answer to the temperature as it was, with noise, after a filter of so many rows.
    fn log(seed: u64, rows: usize, cycles: f64, sigma: f64, filter_rows: f64) -> Made {
        let mut noise = Noise::new(seed);
        let mut log = Made::new(rows, 0.2, |share| {
            up_and_down((share * cycles).fract(), -10.0, 50.0) + 0.02 * noise.next()
        });
        for curve in 0..3 {
            let (mut lagged_c, mut filtered) = (f64::from(log.temp_c[0]), 0.0);
            let lag_rows = rows as f64 / cycles / 100.0;
            log = log.with_axis(|_, temp_c| {
                lagged_c += (temp_c - lagged_c) / lag_rows;
                filtered += (sigma * noise.next() - filtered) / filter_rows;
                bias(curve, lagged_c) + filtered
            });
        }
        log
    }

    /// What an axis would read as a total of `per_row` and its bias.
    fn totalled(values: &mut [f64], scale: f64, per_row: f64, step: f64) {
        let mut total = 0.0;
        for value in values {
            total += scale * *value + per_row;
            *value = if step == 0.0 {
                total
            } else {
                (total / step).floor() * step
            };
        }
    }

    proptest! {
        #[test]
        fn totals_are_found_whatever_they_count(
            seed in 0_u64..1000,
            rows in prop::sample::select(vec![1500, 9000, 40_000]),
            cycles in prop::sample::select(vec![1.0, 2.0, 3.0]),
            sigma in prop::sample::select(vec![0.0, 0.01, 0.05]),
            (per_row, step) in prop::sample::select(
                vec![(0.0, 0.0), (3.0, 0.0), (-20.0, 0.0), (150.2, 1.0), (-150.2, 1.0), (0.7, 1.0)]
            ),
            wrap in prop::sample::select(vec![0.0, 65_536.0, 4_294_967_296.0, 5000.0]),
            is_signed: bool,
            axis in 0_usize..3,
        ) {
            let mut log = log(seed, rows, cycles, sigma, 1.0);
            // An axis whose bias passes zero may return to its total.
            prop_assume!(per_row != 0.0 || axis < 2);
            totalled(&mut log.axes[axis], 0.2, per_row, step);
            for value in &mut log.axes[axis] {
                if wrap > 0.0 {
                    let half = if is_signed { 0.5 * wrap } else { 0.0 };
                    *value = (*value + half).rem_euclid(wrap) - half;
                }
            }
            let found = found(&log);
            prop_assert_eq!(found.len(), 1);
            prop_assert_eq!(found[0].axis, Some(axis));
            prop_assert_eq!(found[0].rows, rows);
        }

        #[test]
        fn biases_are_silent(
            seed in 0_u64..1000,
            rows in prop::sample::select(vec![1500, 9000, 40_000]),
            cycles in prop::sample::select(vec![0.45, 0.5, 0.6, 1.0, 1.3, 2.0, 3.0]),
            sigma in prop::sample::select(vec![0.0, 1e-3, 0.05, 1.0]),
            filter_rows in prop::sample::select(vec![1.0, 30.0, 400.0]),
            step in prop::sample::select(vec![0.0, 1e-4, 0.01, 0.5]),
            spikes in 10_usize..20_000,
            turned in 0.0..1.0_f64,
        ) {
            let mut log = log(seed, rows, cycles, sigma, filter_rows);
            let turned = (turned * rows as f64) as usize;
            for axis in &mut log.axes {
                for (row, value) in axis.iter_mut().enumerate() {
                    let spike = if row % spikes == 0 { 80.0 } else { 0.0 };
                    let turn = if row / 200 == turned / 200 { 10.0 } else { 0.0 };
                    *value = rounded(*value + spike + turn, step);
                }
            }
            prop_assert_eq!(found(&log), []);
        }

        #[test]
        fn whole_pulses_and_constant_axes_are_silent(
            seed in 0_u64..1000,
            rate in -5.0..5.0_f64,
            sigma in prop::sample::select(vec![0.0, 0.3, 2.0]),
        ) {
            let mut noise = Noise::new(seed);
            let (mut angle, mut counted) = (0.0, 0.0);
            let log = Made::new(20_000, 0.5, |share| up_and_down(share, -10.0, 50.0))
                .with_axis(|_, temp_c| {
                    angle += rate + 0.002 * temp_c + sigma * noise.next();
                    let pulses = f64::floor(angle) - counted;
                    counted += pulses;
                    pulses
                })
                .with_axis(|_, _| rate)
                .with_axis(|row, _| if row < 9000 { rate } else { rate + 0.1 });
            prop_assert_eq!(found(&log), []);
        }
    }

    #[test]
    fn a_counter_that_restarts_is_found() {
        let mut log = log(1, 20_000, 1.0, 0.01, 1.0);
        totalled(&mut log.axes[1], 0.2, 3.0, 1.0);
        let (first, later) = (log.axes[1][4000], log.axes[1][13_000]);
        log.axes[1][4000..13_000]
            .iter_mut()
            .for_each(|value| *value -= first);
        log.axes[1][13_000..]
            .iter_mut()
            .for_each(|value| *value -= later);
        assert_eq!(found(&log).len(), 1);
    }
}
