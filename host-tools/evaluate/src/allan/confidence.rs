//! How far an Allan deviation may be from the one of an endless series.

/// The noise that governs a stretch of the curve, by its slope in logarithms; in the order in which
/// they take over as the averaging time grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Noise {
    /// Quantization noise (white phase): slope -1.
    Quantization,
    /// Angle random walk (white rate): slope -1/2.
    AngleRandomWalk,
    /// Bias instability (flicker rate): slope 0.
    BiasInstability,
    /// Rate random walk, and whatever rises faster: slope 1/2 and above.
    RateRandomWalk,
}

impl Noise {
    /// The noise whose slope is nearest; angle random walk where there is no slope.
    pub(super) fn of_slope(slope: f64) -> Self {
        if slope < -0.75 {
            Self::Quantization
        } else if slope < -0.25 || slope.is_nan() {
            Self::AngleRandomWalk
        } else if slope < 0.25 {
            Self::BiasInstability
        } else {
            Self::RateRandomWalk
        }
    }

    /// Equivalent degrees of freedom of the overlapping deviation over `m` intervals of a series of
    /// `phases` phases, 1 or more: NIST Special Publication 1065, table 5, after
    /// Stein (1985).
    pub(super) fn degrees_of_freedom(self, phases: usize, m: usize) -> f64 {
        let (phases, m) = (phases as f64, m as f64);
        let edf = match self {
            Self::Quantization => (phases + 1.0) * (phases - 2.0 * m) / (2.0 * (phases - m)),
            Self::AngleRandomWalk => {
                (1.5 * (phases - 1.0) / m - 2.0 * (phases - 2.0) / phases) * 4.0 * m * m
                    / (4.0 * m * m + 5.0)
            }
            Self::BiasInstability if m == 1.0 => {
                2.0 * (phases - 2.0).powi(2) / (2.3 * phases - 4.9)
            }
            Self::BiasInstability => 5.0 * phases * phases / (4.0 * m * (phases + 3.0 * m)),
            Self::RateRandomWalk => {
                let squares = (phases - 1.0).powi(2) - 3.0 * m * (phases - 1.0) + 4.0 * m * m;
                (phases - 2.0) * squares / (m * (phases - 3.0).powi(2))
            }
        };
        // Also where there are too few phases for the formula.
        if edf.is_finite() { edf.max(1.0) } else { 1.0 }
    }
}

/// The 1-sigma interval of a deviation with `edf` (1 or more) degrees of freedom.
///
/// The quantiles of chi-squared are those of Wilson and Hilferty (1931); the ends of the interval
/// are within 0.3 % from `edf` 3 on; at 1 the upper end is 18 % high.
pub(super) fn interval(deviation: f64, edf: f64) -> [f64; 2] {
    let h = 2.0 / (9.0 * edf);
    [h.sqrt(), -h.sqrt()].map(|z| deviation / (1.0 - h + z).powi(3).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_tell_the_noise() {
        for (slope, noise) in [
            (-1.0, Noise::Quantization),
            (-0.5, Noise::AngleRandomWalk),
            (f64::NAN, Noise::AngleRandomWalk),
            (0.0, Noise::BiasInstability),
            (0.5, Noise::RateRandomWalk),
            (1.0, Noise::RateRandomWalk),
        ] {
            assert_eq!(Noise::of_slope(slope), noise);
        }
    }

    /// As allantools 2024.6 has them (`edf_simple`).
    #[test]
    fn degrees_of_freedom_are_those_of_the_table() {
        use Noise::{AngleRandomWalk, BiasInstability, Quantization, RateRandomWalk};
        for (phases, m, expected) in [
            (
                1000,
                4,
                [498.489_959_8, 345.626_898_6, 308.794_466_4, 247.509_038_1],
            ),
            (
                1000,
                128,
                [427.032_110_1, 9.710_290_4, 7.056_087_4, 5.333_210_3],
            ),
            (
                20_001,
                64,
                [9_968.895_671_4, 466.607_802_6, 386.930_187_2, 309.559_233_1],
            ),
        ] {
            let kinds = [
                Quantization,
                AngleRandomWalk,
                BiasInstability,
                RateRandomWalk,
            ];
            for (noise, expected) in kinds.into_iter().zip(expected) {
                let edf = noise.degrees_of_freedom(phases, m);
                assert!(
                    (edf / expected - 1.0).abs() < 1e-8,
                    "{noise:?}: {edf} {expected}"
                );
            }
        }
    }

    #[test]
    fn degrees_of_freedom_stay_finite_and_at_least_one() {
        use Noise::{AngleRandomWalk, BiasInstability, Quantization, RateRandomWalk};
        for noise in [
            Quantization,
            AngleRandomWalk,
            BiasInstability,
            RateRandomWalk,
        ] {
            for phases in 3..40 {
                for m in 1..=(phases - 1) / 2 {
                    let edf = noise.degrees_of_freedom(phases, m);
                    assert!((1.0..100.0).contains(&edf), "{noise:?} {phases} {m} {edf}");
                }
            }
        }
    }

    /// Exact quantiles from scipy 1.17, `chi2.ppf`.
    #[test]
    fn the_interval_is_that_of_chi_squared() {
        for (edf, low, high, allowed) in [
            (1.0, 0.709_417, 4.995_662, 0.181),
            (3.0, 0.760_560, 1.896_732, 0.003),
            (10.0, 0.835_497, 1.326_790, 0.001),
            (100.0, 0.936_195, 1.078_922, 0.0001),
        ] {
            let found = interval(1.0, edf);
            for (found, expected) in found.into_iter().zip([low, high]) {
                assert!(
                    (found / expected - 1.0_f64).abs() < allowed,
                    "{edf}: {found}"
                );
            }
        }
    }
}
