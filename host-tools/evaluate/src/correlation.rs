//! Whether what remains still follows the temperature, and how far chance can take that.
//!
//! Means that follow each other say less than as many independent ones: a bias that walks has a
//! large correlation with any slow series. So the number of independent means is estimated from
//! the autocorrelations `a_k`, `b_k` of both series (Bartlett),
//!
//! ```text
//! n_eff = n / (1 + 2 sum a_k b_k),    k = 1 ... up to where b_k, of the temperature, is 0
//! ```
//!
//! By chance alone `|r|` stays below `tanh(2.576 / sqrt(n_eff - 3))` in 99 of 100 logs (Fisher).
//! The autocorrelation at lag 1 alone does not do: white noise hides in it that the bias walks.

use serde::Serialize;

/// Pearson's correlation coefficient of an axis with the temperature and its rate.
///
/// Of the means over `tau`, so that the noise of single rows does not hide a trend.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Correlation {
    /// With the lag-compensated temperature, -1 to 1.
    pub temperature: f64,
    /// With the rate of temperature, -1 to 1.
    pub rate: f64,
    /// How far `temperature` gets from 0 by chance, in 99 of 100 logs; 1 where there are too few
    /// independent means to tell.
    pub temperature_chance: f64,
    /// The same of `rate`.
    pub rate_chance: f64,
}

/// Quantile of the normal distribution for 1 %, both sides.
const SIGMAS_OF_CHANCE: f64 = 2.576;

/// Longer series are averaged before their autocorrelation is taken, which costs the square of
/// their length. Independent means may then be counted as fewer.
const MOST_MEANS: usize = 4096;

/// How far Pearson's r of two series gets from 0 by chance, 0 to 1.
pub(super) fn chance(residual: &[f64], temperature: &[f64]) -> f64 {
    let count = residual.len().min(temperature.len());
    let each = count.div_ceil(MOST_MEANS).max(1);
    let [a, b] = [residual, temperature].map(|series| centred(&series[..count], each));
    let n = a.len() as f64;
    // Of the temperature up to its first zero: beyond, it turns back, and so would any walk.
    let of_b = (1..a.len()).map(|lag| autocovariance(&b, lag));
    let products = of_b
        .take_while(|of_b| *of_b > 0.0)
        .zip(1..)
        .map(|(of_b, lag)| of_b * autocovariance(&a, lag));
    let whole = autocovariance(&a, 0) * autocovariance(&b, 0);
    let sum = products.sum::<f64>() / whole;
    let independent = n / (1.0 + 2.0 * sum.max(0.0));
    if independent > 3.0 {
        (SIGMAS_OF_CHANCE / (independent - 3.0).sqrt()).tanh()
    } else {
        1.0
    }
}

/// Means of `each` values in a row, less their mean.
fn centred(series: &[f64], each: usize) -> Vec<f64> {
    let whole = series.chunks_exact(each);
    let means: Vec<f64> = whole
        .map(|of| of.iter().sum::<f64>() / each as f64)
        .collect();
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    means.into_iter().map(|value| value - mean).collect()
}

/// Sum of products of values that are `lag` apart.
fn autocovariance(series: &[f64], lag: usize) -> f64 {
    let pairs = series.iter().zip(&series[lag..]);
    pairs.map(|(a, b)| a * b).sum()
}

/// Pearson's r; `None` where there are fewer than three pairs or one of the series stands still.
pub(super) fn pearson(a: &[f64], b: &[f64]) -> Option<f64> {
    let n = a.len().min(b.len());
    if n < 3 {
        return None;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        aa += a * a;
        bb += b * b;
        ab += a * b;
    }
    let r = ab / (aa.sqrt() * bb.sqrt());
    r.is_finite().then(|| r.clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::{chance, pearson};

    #[test]
    fn r_is_that_of_the_definition() {
        let a = [1.0, 2.0, 3.0, 4.0];
        for (b, expected) in [
            ([3.0, 5.0, 7.0, 9.0], 1.0),
            ([9.0, 7.0, 5.0, 3.0], -1.0),
            ([1.0, -1.0, -1.0, 1.0], 0.0),
            ([1.0, 3.0, 2.0, 4.0], 0.8),
        ] {
            let r = pearson(&a, &b).unwrap();
            assert!((r - expected).abs() < 1e-15, "{r} {expected}");
        }
    }

    #[test]
    fn nothing_is_said_of_a_series_that_stands_still_or_is_too_short() {
        assert_eq!(pearson(&[1.0, 1.0, 1.0], &[1.0, 2.0, 3.0]), None);
        assert_eq!(pearson(&[1.0, 2.0], &[1.0, 2.0]), None);
    }

    /// Numbers of a normal distribution, by a generator of its own: the same everywhere.
    struct Random(u64);

    impl Random {
        fn uniform(&mut self) -> f64 {
            let next = self.0.wrapping_mul(6_364_136_223_846_793_005);
            self.0 = next.wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }

        /// The sum of twelve uniform numbers, less their mean.
        fn normal(&mut self) -> f64 {
            (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
        }
    }

    /// Up and down `cycles` times, with soaks at both ends.
    fn profile(count: usize, cycles: f64) -> Vec<f64> {
        let phase = |i: usize| cycles * std::f64::consts::TAU * i as f64 / count as f64;
        (0..count)
            .map(|i| (-1.3 * phase(i).cos()).clamp(-1.0, 1.0))
            .collect()
    }

    fn rates(temperature: &[f64]) -> Vec<f64> {
        let mut filtered = 0.0;
        let differences = temperature.windows(2).map(|pair| pair[1] - pair[0]);
        std::iter::once(0.0)
            .chain(differences)
            .map(|difference| {
                filtered += 0.5 * (difference - filtered);
                filtered
            })
            .collect()
    }

    /// Logs in which chance goes further than it should: 1 % of them, and the fewer the better
    /// where a wrong verdict could follow. White noise, a random walk, and one within the other.
    #[test]
    fn chance_stays_below_its_limit_in_99_of_100_logs() {
        const LOGS: u32 = 1000;
        let mut random = Random(15);
        for (count, cycles) in [(36, 1.0), (45, 1.0), (400, 1.0), (400, 2.5), (160, 8.0)] {
            let temperature = profile(count, cycles);
            let rates = rates(&temperature);
            for (white, walk) in [(1.0, 0.0), (0.0, 1.0), (2.0, 0.3), (2.0, 0.1)] {
                let (mut beyond, mut rejected) = (0, 0);
                for log in 0..LOGS {
                    let mut place = 0.0;
                    let residual: Vec<f64> = (0..count)
                        .map(|_| {
                            place += walk * random.normal();
                            place + white * random.normal()
                        })
                        .collect();
                    let series = [&temperature, &rates][log as usize % 2];
                    let r = pearson(&residual, series).unwrap().abs();
                    beyond += u32::from(r > chance(&residual, series));
                    rejected += u32::from(r > chance(&residual, series).max(0.5));
                }
                let case = format!("{count} means, {cycles} cycles, {white} + {walk}");
                println!("{case}: {beyond} of {LOGS} beyond chance, {rejected} beyond 0.5 too");
                assert!(beyond <= LOGS / 50, "{case}: {beyond}");
                assert!(rejected <= LOGS / 66, "{case}: {rejected}");
            }
        }
    }

    /// What follows the temperature is found, in noise of its own size too.
    #[test]
    fn a_trend_is_beyond_chance() {
        let mut random = Random(15);
        for (count, cycles, noise) in [
            (36, 1.0, 0.05),
            (400, 1.0, 0.2),
            (400, 2.5, 0.7),
            (160, 8.0, 0.7),
        ] {
            let temperature = profile(count, cycles);
            for _ in 0..100 {
                let residual = temperature.iter().map(|t| t + noise * random.normal());
                let residual: Vec<f64> = residual.collect();
                let r = pearson(&residual, &temperature).unwrap();
                let chance = chance(&residual, &temperature);
                assert!(r > 0.5 && r > chance, "{count}, {noise}: {r} {chance}");
            }
        }
    }

    #[test]
    fn long_series_are_averaged_and_short_ones_say_nothing() {
        let mut random = Random(15);
        let temperature = profile(50_000, 3.0);
        let residual: Vec<f64> = temperature.iter().map(|_| random.normal()).collect();
        let limit = chance(&residual, &temperature);
        assert!((0.03..0.06).contains(&limit), "{limit}");
        assert_eq!(chance(&[1.0, 2.0, 3.0], &[1.0, 2.0, 3.0]), 1.0);
    }
}
