//! Cubics in temperature.

use crate::model::horner;

/// Coefficients of a cubic, lowest power first.
pub(super) type Cubic = [f64; 4];

/// The bias of the three axes of a gyro as cubics in `d = T - centre_c` \[rad/s\].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cubics {
    /// \[degC\]
    pub(super) centre_c: f64,
    /// Calibrated range; temperatures beyond count as its ends \[degC\].
    pub(super) range_c: (f64, f64),
    pub(super) axes: [Cubic; 3],
}

impl Cubics {
    /// The bias of an axis at a temperature \[rad/s\].
    pub(super) fn at(&self, axis: usize, temp_c: f64) -> f64 {
        let temp_c = temp_c.clamp(self.range_c.0, self.range_c.1);
        horner(&self.axes[axis], temp_c - self.centre_c)
    }

    /// The same cubics about another temperature.
    pub(super) fn about(&self, centre_c: f64) -> Self {
        Self {
            centre_c,
            axes: self
                .axes
                .map(|cubic| shifted(cubic, centre_c - self.centre_c)),
            ..*self
        }
    }
}

/// `p(d + by)`.
fn shifted(mut p: Cubic, by: f64) -> Cubic {
    // Horner's rule, again and again (Taylor shift).
    for first in 0..p.len() - 1 {
        for power in (first..p.len() - 1).rev() {
            p[power] += by * p[power + 1];
        }
    }
    p
}

/// The cubic that is nearest, by least squares, to values at temperatures that are evenly spread over a
/// range; in `d = T - centre` of the range.
pub(super) fn nearest(values: &[f64], (low, high): (f64, f64)) -> Cubic {
    let half_width = 0.5 * (high - low);
    let points = values.len();
    let at = |point: usize| 2.0 * point as f64 / (points - 1) as f64 - 1.0;
    let sum = |of: &dyn Fn(f64) -> f64| (0..points).map(|point| of(at(point))).sum::<f64>();
    // Powers of z, -1 to 1, made orthogonal over the points.
    let mut basis: Vec<Cubic> = Vec::new();
    let mut nearest = [0.0; 4];
    for power in 0..4 {
        let mut next = [0.0; 4];
        next[power] = 1.0;
        for former in &basis {
            let share = sum(&|z| horner(&next, z) * horner(former, z))
                / sum(&|z| horner(former, z).powi(2));
            for (next, former) in next.iter_mut().zip(former) {
                *next -= share * former;
            }
        }
        let of_curve: f64 = values
            .iter()
            .enumerate()
            .map(|(point, value)| value * horner(&next, at(point)))
            .sum();
        let share = of_curve / sum(&|z| horner(&next, z).powi(2));
        for (nearest, next) in nearest.iter_mut().zip(&next) {
            *nearest += share * next;
        }
        basis.push(next);
    }
    std::array::from_fn(|power| nearest[power] / half_width.powi(power as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUBIC: Cubic = [0.3, -0.02, 1e-3, 5e-5];

    #[test]
    fn a_cubic_is_found_again() {
        let range_c = (-15.0, 80.0);
        let centre_c = 32.5;
        let temp_c = |point: usize| -15.0 + 95.0 * point as f64 / 500.0;
        let values = (0..501).map(|point| horner(&CUBIC, temp_c(point) - centre_c));
        let found = nearest(&values.collect::<Vec<_>>(), range_c);
        for (found, expected) in found.iter().zip(CUBIC) {
            assert!(
                (found - expected).abs() < 1e-12 * (1.0 + expected.abs()),
                "{found}"
            );
        }
    }

    /// Of `z^4` on -1 to 1, the nearest polynomial of degree 3 is `6/7 z^2 - 3/35`.
    #[test]
    fn the_nearest_cubic_is_by_least_squares() {
        let values = (0..100_001).map(|point| (f64::from(point) / 50_000.0 - 1.0).powi(4));
        let found = nearest(&values.collect::<Vec<_>>(), (-1.0, 1.0));
        for (found, expected) in found.iter().zip([-3.0 / 35.0, 0.0, 6.0 / 7.0, 0.0]) {
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        }
    }

    #[test]
    fn a_cubic_about_another_temperature_is_the_same() {
        let cubics = Cubics {
            centre_c: 20.0,
            range_c: (-10.0, 60.0),
            axes: [CUBIC; 3],
        };
        let other = cubics.about(35.0);
        for temp_c in [-20.0, -10.0, 0.0, 35.0, 60.0, 90.0] {
            let difference = cubics.at(0, temp_c) - other.at(0, temp_c);
            assert!(difference.abs() < 1e-12, "{temp_c}: {difference}");
        }
    }
}
