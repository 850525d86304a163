//! Second differences of a series that grows, octave by octave.

use super::sum::Sum;
use super::{AllanPoint, Deviation, points};

/// The longest averaging time \[intervals\] of which every second difference counts.
const LONGEST_WHOLE: usize = 1 << 15;

/// Of a longer averaging time, second differences begin this part of it apart.
const STEPS: usize = 1 << 12;

/// The first averaging time beyond, in steps of so many intervals, as a power of two.
const FIRST_STEP: u32 = (2 * LONGEST_WHOLE / STEPS).trailing_zeros();

/// The overlapping Allan deviation of a series, value after value.
#[derive(Clone, Debug)]
pub struct AllanSums {
    /// What is taken off every value.
    constant: Option<f64>,
    phase: Sum,
    values: usize,
    /// Every phase, for the shorter averaging times.
    fine: Window,
    /// Every 16th phase, every 32nd, ..., each for one of the longer averaging times.
    coarse: Vec<Window>,
}

impl Default for AllanSums {
    fn default() -> Self {
        let octaves = LONGEST_WHOLE.trailing_zeros();
        Self {
            constant: None,
            phase: Sum::default(),
            values: 0,
            fine: Window::new((0..=octaves).map(|octave| 1 << octave)),
            coarse: Vec::new(),
        }
    }
}

impl AllanSums {
    /// Takes the next value; it is finite.
    pub fn add(&mut self, value: f64) {
        let constant = *self.constant.get_or_insert(f64::from(value as f32));
        self.phase.add(value - constant);
        let phase = self.phase.value();
        self.values += 1;
        self.fine.push(phase);
        let windows = (self.values.trailing_zeros() + 1).saturating_sub(FIRST_STEP);
        for window in 0..windows as usize {
            if window == self.coarse.len() {
                self.coarse.push(Window::new([STEPS].into_iter()));
            }
            self.coarse[window].push(phase);
        }
    }

    /// The deviations, for values `interval_s` apart.
    pub fn finish(mut self, interval_s: f64) -> Vec<AllanPoint> {
        let mut deviations = self.fine.deviations(0);
        for (window, step) in self.coarse.iter_mut().zip(FIRST_STEP..) {
            deviations.extend(window.deviations(step));
        }
        points(&deviations, self.values + 1, interval_s)
    }
}

/// Second differences whose squares are added up plainly, before the compensated sum takes them.
const RUN: usize = 1024;

/// Lanes of a plain sum, which the processor adds to at a time.
const LANES: usize = 8;

/// The sum of the squares of as many second differences as there are last phases.
fn sum_of_squares(first: &[f64], middle: &[f64], last: &[f64]) -> f64 {
    let square = |first: f64, middle: f64, last: f64| {
        let difference = (last - middle) - (middle - first);
        difference * difference
    };
    let (first, first_rest) = first[..last.len()].as_chunks::<LANES>();
    let (middle, middle_rest) = middle[..last.len()].as_chunks::<LANES>();
    let (last, last_rest) = last.as_chunks::<LANES>();
    let mut lanes = [0.0; LANES];
    for ((first, middle), last) in first.iter().zip(middle).zip(last) {
        for lane in 0..LANES {
            lanes[lane] += square(first[lane], middle[lane], last[lane]);
        }
    }
    let rest = first_rest.iter().zip(middle_rest).zip(last_rest);
    let rest = rest.map(|((first, middle), last)| square(*first, *middle, *last));
    lanes.iter().sum::<f64>() + rest.sum::<f64>()
}

/// The last phases of a series, and the squares of the second differences so far.
#[derive(Clone, Debug)]
struct Window {
    octaves: Vec<Octave>,
    phases: Vec<f64>,
    /// Differences that end before this phase are in the sums.
    done: usize,
}

#[derive(Clone, Debug)]
struct Octave {
    /// Averaging time \[steps of the window\].
    lag: usize,
    squares: Sum,
    n: usize,
}

impl Window {
    /// For these averaging times, the longest last.
    fn new(lags: impl Iterator<Item = usize>) -> Self {
        let octave = |lag| Octave {
            lag,
            squares: Sum::default(),
            n: 0,
        };
        Self {
            octaves: lags.map(octave).collect(),
            // The first phase is 0: the sum of no values.
            phases: vec![0.0],
            done: 0,
        }
    }

    fn push(&mut self, phase: f64) {
        self.phases.push(phase);
        let reach = 2 * self.octaves.last().map_or(0, |longest| longest.lag);
        if self.phases.len() >= 2 * reach {
            self.settle();
            self.phases.drain(..self.phases.len() - reach);
            self.done = reach;
        }
    }

    /// Takes in the differences that end at the phases since the last time.
    fn settle(&mut self) {
        for Octave { lag, squares, n } in &mut self.octaves {
            let end = self.done.max(2 * *lag);
            let Some(last) = self.phases.get(end..) else {
                continue;
            };
            let (first, middle) = (&self.phases[end - 2 * *lag..], &self.phases[end - *lag..]);
            let runs = last.chunks(RUN).zip(middle.chunks(RUN));
            for ((last, middle), first) in runs.zip(first.chunks(RUN)) {
                squares.add(sum_of_squares(first, middle, last));
            }
            *n += last.len();
        }
        self.done = self.phases.len();
    }

    /// The deviations of phases that are `2^step` intervals apart.
    fn deviations(&mut self, step: u32) -> Vec<Deviation> {
        self.settle();
        let reached = self.octaves.iter().filter(|octave| octave.n > 0);
        let deviation = |octave: &Octave| {
            let m = octave.lag << step;
            let mean = octave.squares.value() / (2.0 * octave.n as f64);
            Deviation {
                m,
                n: octave.n,
                deviation: mean.sqrt() / m as f64,
            }
        };
        reached.map(deviation).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise on a slow wave, from a linear congruence.
    fn values(count: usize) -> impl Iterator<Item = f64> {
        let mut state = 1_u64;
        (0..count).map(move |i| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64 + (i as f64 * 1e-4).sin()
        })
    }

    /// The definition, with every second difference, over all phases in memory.
    fn whole(count: usize, m: usize) -> (usize, f64) {
        let mut phases = vec![0.0];
        for value in values(count) {
            phases.push(phases.last().unwrap() + value);
        }
        let difference = |i: usize| phases[i + 2 * m] - 2.0 * phases[i + m] + phases[i];
        let n = count + 1 - 2 * m;
        let squares: f64 = (0..n).map(|i| difference(i).powi(2)).sum();
        (n, (squares / (2.0 * n as f64)).sqrt() / m as f64)
    }

    #[test]
    fn a_long_series_has_the_overlapping_deviation() {
        const COUNT: usize = 700_000;
        let mut sums = AllanSums::default();
        values(COUNT).for_each(|value| sums.add(value));
        let found = sums.finish(1.0);
        assert_eq!(found.len(), 19, "up to 2^18 intervals");
        for (octave, found) in found.iter().enumerate() {
            let m = 1 << octave;
            let (n, deviation) = whole(COUNT, m);
            let off = (found.deviation / deviation - 1.0).abs();
            assert_eq!(found.tau_s, m as f64);
            if m <= LONGEST_WHOLE {
                assert!(found.n == n && off < 1e-9, "{found:?}, not {n} {deviation}");
            } else {
                let step = m / STEPS;
                assert_eq!(found.n, (COUNT - 2 * m) / step + 1);
                assert!(off < 1e-4, "{found:?}, not {deviation}");
            }
        }
    }

    #[test]
    fn memory_grows_by_one_window_for_twice_the_values() {
        let kept = |count: usize| {
            let mut sums = AllanSums::default();
            values(count).for_each(|value| sums.add(value));
            let windows = sums.coarse.iter().chain([&sums.fine]);
            windows.map(|window| window.phases.len()).max()
        };
        assert!(kept(500_000).unwrap() <= 4 * LONGEST_WHOLE);
    }
}
