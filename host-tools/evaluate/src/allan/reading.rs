//! The two figures that are read from an Allan curve.

use serde::Serialize;

use super::{AllanPoint, slope};

/// Allan deviation of flicker noise of coefficient `B` is `0.664 B`: `sqrt(2 ln 2 / pi)`.
const FLICKER: f64 = 0.664;

/// A point with fewer degrees of freedom is not trusted to end a search: its 1-sigma interval
/// reaches 55 % beyond it.
const LEAST_EDF: f64 = 5.0;

/// A slope this close to -1/2 is that of white noise.
const SLOPE_TOLERANCE: f64 = 0.1;

/// So many octaves in a row must have that slope: a curve that bends from -1 to 0 passes -1/2, but
/// is near it for 0.6 octaves only.
const LEAST_OCTAVES: usize = 3;

/// A floor must be followed by a curve up to this many times its averaging time.
const FLOOR_LENGTH: f64 = 4.0;

/// Random walk of the integral of a series, the coefficient `N` of `N / sqrt(tau)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RandomWalk {
    /// `deviation * sqrt(tau)` \[unit of the series times sqrt(s)\].
    pub value: f64,
    /// Averaging time at which it was read \[s\].
    pub tau_s: f64,
}

/// Bias instability, the coefficient `B` of a floor of `0.664 B`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BiasInstability {
    /// The least deviation, divided by 0.664 \[unit of the series\].
    pub value: f64,
    /// Averaging time of the least deviation \[s\].
    pub tau_s: f64,
    /// Whether the curve goes on to 4 times that time without falling lower. If not, `value` is an
    /// upper limit.
    pub floor_reached: bool,
}

/// Reads the random walk where the slope is -1/2: three octaves or more in a row within 0.1 of it,
/// of trusted points (5 degrees of freedom) before the curve first rises. It is read at the one of
/// them whose slope is nearest.
///
/// `None` where there is no such stretch: other noise, such as the counting of whole pulses, hides
/// the random walk.
pub fn random_walk(points: &[AllanPoint]) -> Option<RandomWalk> {
    let curve: Vec<(usize, f64)> = points
        .iter()
        .enumerate()
        .map(|(octave, point)| (1 << octave, point.deviation))
        .collect();
    let rise = curve.windows(2).position(|pair| pair[1].1 > pair[0].1);
    let distances: Vec<f64> = (0..rise.unwrap_or(points.len()))
        .take_while(|&place| points[place].edf >= LEAST_EDF)
        .map(|place| (slope(&curve, place) + 0.5).abs())
        .collect();
    let place = (0..distances.len())
        .filter(|&place| {
            let near = |distance: &&f64| **distance <= SLOPE_TOLERANCE;
            let after = distances[place..].iter().take_while(near).count();
            let before = distances[..place].iter().rev().take_while(near).count();
            after > 0 && before + after >= LEAST_OCTAVES
        })
        .min_by(|&a, &b| distances[a].total_cmp(&distances[b]))?;
    Some(RandomWalk {
        value: points[place].deviation * points[place].tau_s.sqrt(),
        tau_s: points[place].tau_s,
    })
}

/// Reads the bias instability at the lowest trusted point (5 degrees of freedom).
///
/// `None` where there are fewer than three of them.
pub fn bias_instability(points: &[AllanPoint]) -> Option<BiasInstability> {
    let trusted: Vec<&AllanPoint> = points
        .iter()
        .filter(|point| point.edf >= LEAST_EDF)
        .collect();
    let lowest = trusted
        .iter()
        .min_by(|a, b| a.deviation.total_cmp(&b.deviation))?;
    let longest = trusted.last()?;
    (trusted.len() >= 3).then(|| BiasInstability {
        value: lowest.deviation / FLICKER,
        tau_s: lowest.tau_s,
        floor_reached: FLOOR_LENGTH * lowest.tau_s <= longest.tau_s,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(deviation: impl Fn(f64) -> f64) -> Vec<AllanPoint> {
        (0..16)
            .map(|octave| {
                let tau_s = 0.5 * f64::from(1 << octave);
                AllanPoint {
                    tau_s,
                    n: 1000,
                    deviation: deviation(tau_s),
                    edf: 1e5 / tau_s,
                    confidence: [0.0; 2],
                }
            })
            .collect()
    }

    #[test]
    fn the_coefficients_of_a_curve_are_found_again() {
        // Quantization, random walk and flicker, apart enough to be read one by one.
        let (q, n, b) = (0.02_f64, 0.3_f64, 0.006_f64);
        let points = curve(|tau_s| {
            let parts = [3.0_f64.sqrt() * q / tau_s, n / tau_s.sqrt(), 0.664 * b];
            parts.iter().map(|part| part * part).sum::<f64>().sqrt()
        });
        let walk = random_walk(&points).unwrap();
        assert!((walk.value / n - 1.0).abs() < 0.02, "{walk:?}");
        assert!(bias_instability(&points).is_some_and(|floor| !floor.floor_reached));

        let rising = curve(|tau_s| (0.09 / tau_s + 1e-6 * tau_s).sqrt());
        let floor = bias_instability(&rising).unwrap();
        assert!(floor.floor_reached && floor.tau_s == 256.0, "{floor:?}");
        let expected = (0.09_f64 / 256.0 + 256e-6).sqrt() / 0.664;
        assert!((floor.value - expected).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_there_is_not_read() {
        assert_eq!(random_walk(&curve(|tau_s| 1.0 / tau_s)), None);
        assert_eq!(random_walk(&curve(|tau_s| tau_s)), None);
        // From quantization noise to a floor, past -1/2.
        let bent = curve(|tau_s| (1.0 / (tau_s * tau_s) + 1e-4).sqrt());
        assert_eq!(random_walk(&bent), None);
        // White noise, but only after a hump.
        let hump = curve(|tau_s| {
            if tau_s < 9.0 {
                tau_s
            } else {
                27.0 / tau_s.sqrt()
            }
        });
        assert_eq!(random_walk(&hump), None);
        assert_eq!(random_walk(&[]), None);
        assert_eq!(bias_instability(&[]), None);
        assert_eq!(bias_instability(&curve(|_| 1.0)[..2]), None);
    }
}
