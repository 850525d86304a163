//! Overlapping Allan deviation of a series of rates, and what is read from it.
//!
//! With the phase `x_i`, the sum of the first `i` values times the interval `t0`, and `N + 1`
//! phases from `N` values,
//!
//! ```text
//! sigma^2(m t0) = sum_i (x_(i+2m) - 2 x_(i+m) + x_i)^2 / (2 (m t0)^2 n),    n = N + 1 - 2m
//! ```
//!
//! (IEEE Std 952, annex C; NIST Special Publication 1065, equation 11). It agrees with the
//! package allantools to 1e-12 on the series in `tests/allan`.
//!
//! # Why not a crate
//!
//! The one crate of the registry that computes it, `allan` 0.4.1, makes N phases of N rates and so
//! leaves out the last one: its deviations of 10,000 values differ from the definition by up to
//! 4e-4, where 1e-9 is wanted. It has no octaves, no confidence, and adds up phases without
//! compensation. Fed with phases it would leave us everything but one line to write.
//!
//! # Numerics
//!
//! The second difference does not see a constant, so the first value, rounded to f32, is taken off.
//! Phases are error-compensated sums; each is then right to the last place, however long the log.
//!
//! # Memory
//!
//! [`AllanSums`] takes value after value and keeps 2.5 MB at most for 1e8 values. Up to
//! `m = 32768` it forms every second difference. Beyond, those that begin at every `m/4096`-th
//! value count: the ones between say almost the same.

mod confidence;
mod reading;
mod stretch;
mod sum;
mod sums;

pub use reading::{BiasInstability, RandomWalk, bias_instability, random_walk};
pub use stretch::{LongestStretch, Stretch};
pub use sums::AllanSums;

use serde::Serialize;

use confidence::Noise;

/// The Allan deviation at one averaging time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AllanPoint {
    /// Averaging time \[s\].
    pub tau_s: f64,
    /// Number of second differences that were averaged; they overlap.
    pub n: usize,
    /// Overlapping Allan deviation \[unit of the series\].
    pub deviation: f64,
    /// Equivalent degrees of freedom, for the noise that the slopes up to this point tell.
    pub edf: f64,
    /// Ends of the 1-sigma confidence interval (68.3 %) \[unit of the series\].
    pub confidence: [f64; 2],
}

/// The deviations at `1, 2, 4, ...` intervals, as far as the series reaches.
///
/// `values` are rates at a constant interval of `interval_s`; finite. Fewer than two values give
/// no point.
///
/// # Example
///
/// On a ramp of 3 per second the deviation is `3 tau / sqrt(2)`:
///
/// ```
/// use tempco_evaluate::allan::overlapping;
///
/// let ramp = (0..100).map(|i| 3.0 * f64::from(i));
/// let points = overlapping(ramp, 1.0);
/// assert_eq!(points.len(), 6);
/// assert!((points[5].deviation - 3.0 * 32.0 / 2.0_f64.sqrt()).abs() < 1e-9);
/// ```
pub fn overlapping(values: impl Iterator<Item = f64>, interval_s: f64) -> Vec<AllanPoint> {
    let mut sums = AllanSums::default();
    values.for_each(|value| sums.add(value));
    sums.finish(interval_s)
}

/// A deviation over `m` intervals, the mean of `n` second differences.
#[derive(Clone, Copy, Debug)]
struct Deviation {
    m: usize,
    n: usize,
    deviation: f64,
}

/// Adds to deviations of a series of `phases` phases how far they can be trusted.
fn points(deviations: &[Deviation], phases: usize, interval_s: f64) -> Vec<AllanPoint> {
    let curve: Vec<(usize, f64)> = deviations.iter().map(|of| (of.m, of.deviation)).collect();
    // A fall after a flatter stretch is no return to whiter noise: a hump ends, or chance has it.
    let mut noise = Noise::Quantization;
    let point = |(place, &Deviation { m, n, deviation }): (usize, &Deviation)| {
        noise = noise.max(Noise::of_slope(slope(&curve, place)));
        let edf = noise.degrees_of_freedom(phases, m);
        AllanPoint {
            tau_s: m as f64 * interval_s,
            n,
            deviation,
            edf,
            confidence: confidence::interval(deviation, edf),
        }
    };
    deviations.iter().enumerate().map(point).collect()
}

/// Slope of the curve in logarithms, from the neighbours of a point; 0 of a single point.
fn slope(deviations: &[(usize, f64)], place: usize) -> f64 {
    let (from_m, from) = deviations[place.saturating_sub(1)];
    let (to_m, to) = deviations[(place + 1).min(deviations.len() - 1)];
    if from_m == to_m {
        return 0.0;
    }
    (to / from).ln() / (to_m as f64 / from_m as f64).ln()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Uniform over -0.5..0.5, white.
    fn white(count: usize) -> Vec<f64> {
        let mut state = 1_u64;
        (0..count)
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
            })
            .collect()
    }

    fn deviations(values: &[f64], interval_s: f64) -> Vec<f64> {
        let points = overlapping(values.iter().copied(), interval_s);
        points.iter().map(|point| point.deviation).collect()
    }

    #[test]
    fn an_alternating_series_is_seen_at_one_interval_alone() {
        let values: Vec<f64> = (0..64).map(|i| f64::from(i % 2 * 2 - 1)).collect();
        let found = deviations(&values, 0.5);
        assert_eq!(found.len(), 6);
        assert!((found[0] - 2.0_f64.sqrt()).abs() < 1e-15);
        assert!(found[1..].iter().all(|&deviation| deviation == 0.0));
    }

    #[test]
    fn a_ramp_has_its_rate_times_tau_over_root_two() {
        let ramp = (0..1000).map(|i| 7.0 + 0.25 * f64::from(i));
        for point in overlapping(ramp, 0.1) {
            let expected = 2.5 * point.tau_s / 2.0_f64.sqrt();
            assert!((point.deviation / expected - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn quantization_noise_falls_as_one_over_tau_and_white_noise_as_its_root() {
        let noise = white(100_001);
        // Whole counts of an angle with an error uniform over one count: sqrt(3) Q / tau.
        let counts: Vec<f64> = noise.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let q = 1.0 / 12.0_f64.sqrt();
        for point in &overlapping(counts.into_iter(), 1.0)[..8] {
            let expected = 3.0_f64.sqrt() * q / point.tau_s;
            assert!((point.deviation / expected - 1.0).abs() < 0.02, "{point:?}");
        }
        for point in &overlapping(noise.into_iter(), 1.0)[..8] {
            let expected = q / point.tau_s.sqrt();
            assert!((point.deviation / expected - 1.0).abs() < 0.05, "{point:?}");
            assert!(point.confidence[0] < expected && expected < 1.1 * point.confidence[1]);
        }
    }

    #[test]
    fn a_large_constant_costs_nothing() {
        // Multiples of 2^-20 that f32 holds beside 1000.
        let small: Vec<f64> = white(50_000)
            .iter()
            .map(|v| (v * 1024.0).round() / 1024.0 / 16.0)
            .collect();
        let large: Vec<f64> = small.iter().map(|v| v + 1000.0).collect();
        for (small, large) in deviations(&small, 1.0).iter().zip(deviations(&large, 1.0)) {
            assert!((large / small - 1.0).abs() < 1e-11, "{large} {small}");
        }
    }

    #[test]
    fn short_and_still_series_are_no_trouble() {
        assert!(overlapping([].into_iter(), 1.0).is_empty());
        assert!(overlapping([1.0].into_iter(), 1.0).is_empty());
        assert_eq!(overlapping([1.0, 3.0].into_iter(), 1.0).len(), 1);
        for point in overlapping([4.0; 20].into_iter(), 1.0) {
            assert_eq!(point.deviation, 0.0);
            assert_eq!(point.confidence, [0.0; 2]);
        }
    }

    proptest! {
        /// The definition by means of adjacent windows, of cost O(N m).
        #[test]
        fn agrees_with_differences_of_adjacent_means(
            values in prop::collection::vec(-100.0..100.0_f64, 2..80),
        ) {
            for (octave, found) in deviations(&values, 1.0).into_iter().enumerate() {
                let m = 1 << octave;
                let mean = |from: usize| values[from..from + m].iter().sum::<f64>() / m as f64;
                let n = values.len() + 1 - 2 * m;
                let squares: f64 = (0..n).map(|i| (mean(i + m) - mean(i)).powi(2)).sum();
                let expected = (squares / (2.0 * n as f64)).sqrt();
                prop_assert!((found - expected).abs() < 1e-11);
            }
        }

        #[test]
        fn scales_with_the_values(
            values in prop::collection::vec(-1.0..1.0_f64, 10..50),
            scale in 0.01..100.0_f64,
        ) {
            let scaled: Vec<f64> = values.iter().map(|v| v * scale).collect();
            for (a, b) in deviations(&values, 1.0).iter().zip(deviations(&scaled, 1.0)) {
                prop_assert!((b - a * scale).abs() < 1e-9 * scale);
            }
        }
    }
}
