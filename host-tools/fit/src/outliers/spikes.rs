//! Rows that are far from their neighbours in time.

use std::collections::VecDeque;

use tempco_log::decimate::Decimated;
use tempco_log::median::median;

use crate::outliers::{SIGMA_PER_MAD, SIGMA_PER_STEP};
use crate::summary::{Rows, Spiked};

/// Rows further from their local median than this many standard deviations are left out: of
/// normal noise one in 5e8.
const LIMIT: f64 = 6.0;

/// Where most rows are as their local median, as with few whole pulses, the limit is this many steps
/// of the output, and `LIMIT` times the rms of the distances without this share, the largest.
const STEPS: f64 = 2.5;
const TRIMMED: f64 = 0.05;

/// The local median is over this long \[s\] ...
const WINDOW_S: f64 = 10.0;

/// ... or over this many rows, if they take longer, and over this many if they take less time ...
const WINDOW_ROWS: (usize, usize) = (11, 4096);

/// ... of which so many, evenly spaced, are enough to tell it.
const LOOKED_AT: usize = 64;

/// No row is judged before the scale is known from so many, or from all there are.
const ROWS_AHEAD: usize = 1 << 14;

/// Distances and steps that the scale is taken from.
const SCALE_VALUES: usize = 1 << 12;

/// Number of rows in a window.
pub(crate) fn window_rows(interval_s: f64) -> usize {
    ((WINDOW_S / interval_s) as usize).clamp(WINDOW_ROWS.0, WINDOW_ROWS.1)
}

/// Judges rows window by window: the values of an axis that are far from the local median and from
/// those before and after it, to which a lasting change would belong, are spikes.
///
/// The scale is the larger of two: of the distances from the local medians, and of the steps
/// between neighbours that differ, which is not below the step of a coarse output such as whole
/// pulses. Both are medians over the log so far, and over its first 2^14 rows at least. Where most
/// distances are 0, the steps alone would let spikes of six of them pass: see `STEPS`.
#[derive(Clone, Debug)]
pub(crate) struct SpikeFilter {
    axes: Vec<Scale>,
    /// Windows that are not judged yet; the last one's successor is still to come.
    waiting: VecDeque<Window>,
    /// The local medians before those that wait.
    before: Option<Vec<f64>>,
    rows: usize,
    spikes: usize,
    /// By axis.
    places: Vec<Spiked>,
}

#[derive(Clone, Debug)]
struct Window {
    rows: Rows,
    /// Some kept rows, evenly spaced.
    looked_at: Vec<usize>,
    /// Local median of each axis; NaN of no kept rows.
    levels: Vec<f64>,
}

/// What is out of the ordinary for an axis.
#[derive(Clone, Debug)]
struct Scale {
    distances: Decimated,
    steps: Decimated,
    /// Distances that the limit was taken from.
    counted: usize,
    limit: f64,
}

impl SpikeFilter {
    pub(crate) fn new(axes: usize) -> Self {
        let scale = Scale {
            distances: Decimated::new(SCALE_VALUES),
            steps: Decimated::new(SCALE_VALUES),
            counted: 0,
            limit: f64::INFINITY,
        };
        Self {
            axes: vec![scale; axes],
            waiting: VecDeque::new(),
            before: None,
            rows: 0,
            spikes: 0,
            places: vec![Spiked::default(); axes],
        }
    }

    /// Takes in the next window; hands on those that are judged, spikes no longer kept.
    pub(crate) fn take(&mut self, rows: Rows, judged: &mut impl FnMut(Rows)) {
        self.rows += rows.len();
        let looked_at = looked_at(&rows);
        let mut pairs = looked_at.clone();
        pairs.retain(|&row| rows.keep.get(row + 1) == Some(&true));
        for (scale, values) in self.axes.iter_mut().zip(&rows.axes) {
            scale.steps.extend(pairs.len(), |i| {
                (values[pairs[i] + 1] - values[pairs[i]]).abs()
            });
        }
        let level = |values: &Vec<f64>| {
            let mut looked_at: Vec<f64> = looked_at.iter().map(|&row| values[row]).collect();
            match looked_at.is_empty() {
                true => f64::NAN,
                false => median(&mut looked_at),
            }
        };
        let levels = rows.axes.iter().map(level).collect();
        self.waiting.push_back(Window {
            rows,
            looked_at,
            levels,
        });
        if let Some(last_but_one) = self.waiting.len().checked_sub(2) {
            self.measure(last_but_one);
        }
        if self.rows >= ROWS_AHEAD {
            while self.waiting.len() > 1 {
                self.judge(judged);
            }
        }
    }

    /// Hands on what is left.
    pub(crate) fn finish(&mut self, judged: &mut impl FnMut(Rows)) {
        if let Some(last) = self.waiting.len().checked_sub(1) {
            self.measure(last);
        }
        while !self.waiting.is_empty() {
            self.judge(judged);
        }
    }

    /// Rows that were left out.
    pub(crate) fn spikes(&self) -> usize {
        self.spikes
    }

    /// Where the spikes of each axis are.
    pub(crate) fn places(&self) -> Vec<Spiked> {
        self.places.clone()
    }

    /// For each axis the standard deviation of its white noise, as far as neighbouring rows tell it.
    pub(crate) fn white_sigmas(&self) -> Vec<f64> {
        let of_axis = |scale: &Scale| SIGMA_PER_STEP * median(&mut scale.steps.values().to_vec());
        self.axes.iter().map(of_axis).collect()
    }

    /// The local medians that the rows of a waiting window may belong to.
    fn levels(&self, window: usize, axis: usize) -> [f64; 3] {
        let of = |window: Option<&Window>| window.map(|w| w.levels[axis]);
        let before = match window.checked_sub(1) {
            Some(before) => of(self.waiting.get(before)),
            None => self.before.as_ref().map(|levels| levels[axis]),
        };
        let others = [
            of(self.waiting.get(window)),
            of(self.waiting.get(window + 1)),
        ];
        [before, others[0], others[1]].map(|level| level.unwrap_or(f64::NAN))
    }

    /// Takes the distances of a window's rows into the scale.
    fn measure(&mut self, window: usize) {
        for axis in 0..self.axes.len() {
            let levels = self.levels(window, axis);
            let Window {
                rows, looked_at, ..
            } = &self.waiting[window];
            let values = &rows.axes[axis];
            let scale = &mut self.axes[axis];
            scale
                .distances
                .extend(looked_at.len(), |i| distance(values[looked_at[i]], levels));
        }
    }

    fn judge(&mut self, judged: &mut impl FnMut(Rows)) {
        let mut spikes = Vec::new();
        for axis in 0..self.axes.len() {
            let levels = self.levels(0, axis);
            let limit = self.axes[axis].limit();
            let rows = &self.waiting[0].rows;
            let values = &rows.axes[axis];
            // Hardly a window has a row that is far from its own median.
            let far = |value: f64| (value - levels[1]).abs() > limit;
            if !values.iter().fold(false, |any, &value| any | far(value)) {
                continue;
            }
            let is_spike = |&row: &usize| rows.keep[row] && distance(values[row], levels) > limit;
            let place = &mut self.places[axis];
            for row in (0..values.len()).filter(is_spike) {
                if place.rows == 0 {
                    place.from_s = rows.time_s[row];
                }
                place.to_s = rows.time_s[row];
                place.rows += 1;
                spikes.push(row);
            }
        }
        let mut window = self.waiting.pop_front().expect("a window waits");
        for row in spikes {
            self.spikes += usize::from(window.rows.keep[row]);
            window.rows.keep[row] = false;
        }
        self.before = Some(window.levels);
        judged(window.rows);
    }
}

/// Distance from the nearest of the levels.
fn distance(value: f64, levels: [f64; 3]) -> f64 {
    let distances = levels.map(|level| (value - level).abs());
    distances.into_iter().fold(f64::INFINITY, f64::min)
}

/// Rms of all but the largest.
fn trimmed_rms(distances: &mut [f64]) -> f64 {
    distances.sort_unstable_by(f64::total_cmp);
    let count = ((1.0 - TRIMMED) * distances.len() as f64) as usize;
    let squares = distances[..count].iter().map(|of| of * of);
    (squares.sum::<f64>() / count.max(1) as f64).sqrt()
}

/// Some kept rows of a window, evenly spaced.
fn looked_at(rows: &Rows) -> Vec<usize> {
    let every = rows.len().div_ceil(LOOKED_AT).max(1);
    let mut some: Vec<usize> = (0..rows.len()).step_by(every).collect();
    some.retain(|&row| rows.keep[row]);
    some
}

impl Scale {
    /// The limit. It is computed again whenever the log has grown by an eighth.
    fn limit(&mut self) -> f64 {
        let seen = self.distances.seen();
        if 8 * seen > 9 * self.counted {
            let steps = self.steps.values().iter().copied();
            let mut steps: Vec<f64> = steps.filter(|&step| step > 0.0).collect();
            let step = median(&mut steps);
            let mut distances = self.distances.values().to_vec();
            let spread = SIGMA_PER_MAD * median(&mut distances);
            self.limit = LIMIT * spread.max(SIGMA_PER_STEP * step);
            if spread == 0.0 {
                let limit = STEPS * step + LIMIT * trimmed_rms(&mut distances);
                self.limit = self.limit.min(limit);
            }
            self.counted = seen;
        }
        self.limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::white;

    /// Positions of the spikes of a series.
    fn spikes(values: &[f64], window: usize) -> Vec<usize> {
        let (mut filter, mut keep) = (SpikeFilter::new(1), Vec::new());
        let mut judged = |rows: Rows| keep.extend_from_slice(&rows.keep);
        for values in values.chunks(window) {
            let rows = Rows {
                time_s: vec![0.0; values.len()],
                keep: vec![true; values.len()],
                axes: vec![values.to_vec()],
                ..Rows::default()
            };
            filter.take(rows, &mut judged);
        }
        filter.finish(&mut judged);
        assert_eq!(keep.len(), values.len());
        let found: Vec<usize> = (0..keep.len()).filter(|&row| !keep[row]).collect();
        assert_eq!(filter.spikes(), found.len());
        found
    }

    #[test]
    fn spikes_go_and_noise_stays() {
        let noise = white(1).take(1000).enumerate();
        let mut values: Vec<f64> = noise.map(|(i, v)| v + 0.01 * i as f64).collect();
        assert!(spikes(&values, 20).is_empty());
        let lasting = values.iter().enumerate();
        let lasting = lasting.map(|(i, v)| v + if i < 505 { 0.0 } else { 30.0 });
        assert!(spikes(&lasting.collect::<Vec<_>>(), 20).is_empty());
        values[17] += 30.0;
        values[500] -= 30.0;
        assert_eq!(spikes(&values, 20), [17, 500]);
    }

    /// A log that is longer than what is looked at ahead, in windows of which a part is looked at.
    #[test]
    fn spikes_go_from_long_logs() {
        let mut values: Vec<f64> = white(2).take(60_000).collect();
        let at = [3, 9_000, 17_000, 59_999];
        at.iter().for_each(|&row| values[row] += 20.0);
        assert_eq!(spikes(&values, 1000), at);
    }

    /// Few pulses among many intervals without any are the signal.
    #[test]
    fn whole_pulses_are_not_spikes() {
        let values: Vec<f64> = (0..1000)
            .map(|i| if i % 37 == 0 { 2.0 } else { 0.0 })
            .collect();
        assert!(spikes(&values, 20).is_empty());
        assert!(spikes(&[5.0; 100], 20).is_empty());
    }

    /// The pulses of a slow output are few; what is far beyond them is a spike for all that.
    #[test]
    fn spikes_go_from_few_whole_pulses() {
        for (sigma, spike) in [(0.3, 5.0), (0.5, 7.0), (1.0, 15.0)] {
            let noise = white(3).take(20_000);
            let mut values: Vec<f64> = noise.map(|v| (sigma * v).round()).collect();
            assert!(spikes(&values, 20).is_empty(), "{sigma}");
            let at: Vec<usize> = (50..20_000).step_by(100).collect();
            at.iter().for_each(|&row| values[row] += spike);
            assert_eq!(spikes(&values, 20), at, "{sigma}");
        }
    }
}
