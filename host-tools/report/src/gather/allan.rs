//! Allan deviations of a stream, in memory of a fixed size.
//!
//! Two estimates are kept at a time. Differences of adjacent means over `1, 2, 4, ...` rows, without
//! overlap, need two numbers per octave. Means over clusters of rows, at most [`MOST_CLUSTERS`], the
//! cluster doubling when there are more, give the overlapping deviation at the longer times, where
//! differences are few and every one counts. A log of up to [`MOST_CLUSTERS`] rows has clusters of
//! one row: its whole curve is the overlapping one.

use tempco_evaluate::allan::overlapping;

/// The most clusters that are kept.
pub(crate) const MOST_CLUSTERS: usize = 1 << 16;

/// A point of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Deviation {
    pub(crate) tau_s: f64,
    pub(crate) deviation: f64,
    /// Ends of the 1-sigma interval.
    pub(crate) interval: [f64; 2],
}

/// A series of values at a constant interval.
#[derive(Clone, Debug, Default)]
pub(crate) struct AllanSums {
    octaves: Vec<Octave>,
    /// Means of `size` values each.
    clusters: Vec<f64>,
    /// Octave of the size of a cluster.
    size: u32,
    begun: f64,
    in_begun: u64,
}

/// Differences of adjacent means over one power of two of values.
#[derive(Clone, Copy, Debug, Default)]
struct Octave {
    /// The mean before, to be compared with the next one.
    before: Option<f64>,
    /// The first mean of a pair that becomes one of the next octave.
    waiting: Option<f64>,
    squares: f64,
    n: f64,
}

impl AllanSums {
    /// Takes the next value; it is finite.
    #[inline]
    pub(crate) fn add(&mut self, value: f64) {
        let mut mean = value;
        for octave in 0.. {
            if octave == self.octaves.len() {
                self.octaves.push(Octave::default());
            }
            match self.octaves[octave].take(mean) {
                Some(of_pair) => mean = of_pair,
                None => break,
            }
        }
        self.begun += value;
        self.in_begun += 1;
        if self.in_begun == 1 << self.size {
            self.clusters.push(self.begun / self.in_begun as f64);
            (self.begun, self.in_begun) = (0.0, 0);
            if self.clusters.len() == MOST_CLUSTERS {
                let pairs = self.clusters.chunks_exact(2);
                self.clusters = pairs.map(|pair| 0.5 * (pair[0] + pair[1])).collect();
                self.size += 1;
            }
        }
    }

    /// The curve, for values `interval_s` apart.
    pub(crate) fn curve(&self, interval_s: f64) -> Vec<Deviation> {
        let short = self.octaves[..self.octaves.len().min(self.size as usize)]
            .iter()
            .zip(0..)
            .map(|(octave, power)| octave.deviation(interval_s * f64::from(1 << power)));
        let cluster_s = interval_s * (1_u64 << self.size) as f64;
        let long = overlapping(self.clusters.iter().copied(), cluster_s);
        let long = long.into_iter().map(|point| Deviation {
            tau_s: point.tau_s,
            deviation: point.deviation,
            interval: point.confidence,
        });
        short.chain(long).filter(|d| d.deviation > 0.0).collect()
    }
}

impl Octave {
    /// Takes the next mean; returns one of the next octave, if it is whole.
    #[inline]
    fn take(&mut self, mean: f64) -> Option<f64> {
        if let Some(before) = self.before.replace(mean) {
            self.squares += (mean - before) * (mean - before);
            self.n += 1.0;
        }
        match self.waiting.take() {
            Some(first) => Some(0.5 * (first + mean)),
            None => {
                self.waiting = Some(mean);
                None
            }
        }
    }

    /// There are 2^15 differences or more: their uncertainty is below a line's width.
    fn deviation(&self, tau_s: f64) -> Deviation {
        let deviation = (0.5 * self.squares / self.n).sqrt();
        Deviation {
            tau_s,
            deviation,
            interval: [deviation; 2],
        }
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

    #[test]
    fn short_series_have_the_overlapping_deviation_itself() {
        let mut sums = AllanSums::default();
        values(5000).for_each(|value| sums.add(value));
        let expected = overlapping(values(5000).collect::<Vec<_>>().into_iter(), 0.5);
        let found = sums.curve(0.5);
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert_eq!(found.deviation, expected.deviation);
            assert_eq!(found.tau_s, expected.tau_s);
        }
    }

    #[test]
    fn long_series_have_about_the_overlapping_deviation_at_every_octave() {
        let count = 400_000;
        let mut sums = AllanSums::default();
        values(count).for_each(|value| sums.add(value));
        assert!(sums.clusters.len() < MOST_CLUSTERS && sums.size == 3);
        let expected = overlapping(values(count).collect::<Vec<_>>().into_iter(), 1.0);
        let found = sums.curve(1.0);
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert_eq!(found.tau_s, expected.tau_s);
            let off = found.deviation / expected.deviation - 1.0;
            assert!(off.abs() < 0.02, "{} s: {off}", found.tau_s);
        }
    }
}
