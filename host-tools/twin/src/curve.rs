//! The static part of a bias: a curve over the temperature of the cavity.

use serde::Deserialize;

use crate::check::{Invalid, Range, element};

/// Static part of a bias, in the unit's rate unit, over the cavity temperature.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum StaticCurve {
    /// Quadratic segments joined smoothly.
    Segments(BlendedQuadratics),
    /// One smooth curve.
    Legendre(LegendreSeries),
}

/// Quadratics, each neighbouring pair blended across an overlap.
///
/// In an overlap `lo..hi` the curve is `(1 - w) p + w q` with `w = s^2 (3 - 2 s)`,
/// `s = (T - lo) / (hi - lo)`: value and slope are continuous at both ends. Outside `range_c` the
/// value at the nearer end holds.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlendedQuadratics {
    /// Lowest and highest temperature of the curve, degC.
    pub range_c: [f64; 2],
    /// Coefficients of each segment, lowest power of degC first; 1 to 32 segments.
    pub coefficients: Vec<[f64; 3]>,
    /// Low and high end of the overlap between each segment and the next, degC; ascending, apart
    /// from each other.
    pub overlaps_c: Vec<[f64; 2]>,
}

/// A series of Legendre polynomials: `c0 + c1 P1(x) + c2 P2(x) + ...`.
///
/// `x` goes from -1 to 1 over `range_c`; outside, the value at the nearer end holds. The
/// polynomials are orthogonal, so that the standard deviation over the range is
/// `sqrt(c1^2/3 + c2^2/5 + c3^2/7 + ...)`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LegendreSeries {
    /// Lowest and highest temperature of the curve, degC.
    pub range_c: [f64; 2],
    /// Coefficients, lowest order first; 1 to 32.
    pub coefficients: Vec<f64>,
}

/// Most segments or orders of a curve.
const MOST_TERMS: usize = 32;

/// Bonnet's recurrence, `P[n+1] = (2 n + 1) / (n + 1) x P[n] - n / (n + 1) P[n-1]`: the two fractions.
const BONNET: [[f64; 2]; MOST_TERMS] = {
    let mut fractions = [[0.0; 2]; MOST_TERMS];
    let mut n = 0;
    while n < MOST_TERMS {
        let order = n as f64;
        fractions[n] = [(2.0 * order + 1.0) / (order + 1.0), order / (order + 1.0)];
        n += 1;
    }
    fractions
};

impl StaticCurve {
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        match self {
            Self::Segments(curve) => curve.check().map_err(|error| error.inside("segments")),
            Self::Legendre(curve) => curve.check().map_err(|error| error.inside("legendre")),
        }
    }

    /// Static bias at a cavity temperature; constant outside the curve's range.
    pub fn value(&self, cavity_c: f64) -> f64 {
        match self {
            Self::Segments(curve) => curve.value(cavity_c),
            Self::Legendre(curve) => curve.value(cavity_c),
        }
    }
}

fn check_range([low_c, high_c]: [f64; 2]) -> Result<(), Invalid> {
    Range::TEMPERATURE.check("range_c", low_c)?;
    Range::TEMPERATURE.check("range_c", high_c)?;
    if low_c < high_c {
        Ok(())
    } else {
        let found = format!("{low_c} to {high_c}");
        Err(Invalid::new("range_c", found, "a lower and a higher end"))
    }
}

fn check_count(count: usize) -> Result<(), Invalid> {
    if (1..=MOST_TERMS).contains(&count) {
        Ok(())
    } else {
        let found = format!("a list of {count}");
        Err(Invalid::new("coefficients", found, "a list of 1 to 32"))
    }
}

impl BlendedQuadratics {
    fn check(&self) -> Result<(), Invalid> {
        check_range(self.range_c)?;
        check_count(self.coefficients.len())?;
        for (index, segment) in self.coefficients.iter().enumerate() {
            for value in segment {
                Range::SIGNED.check(&element("coefficients", index), *value)?;
            }
        }
        let count = self.overlaps_c.len();
        if count + 1 != self.coefficients.len() {
            let expected = format!("a list of {}", self.coefficients.len() - 1);
            let found = format!("a list of {count}");
            return Err(Invalid::new("overlaps_c", found, expected));
        }
        let mut last_c = self.range_c[0];
        for (index, &[low_c, high_c]) in self.overlaps_c.iter().enumerate() {
            if !(last_c <= low_c && low_c < high_c && high_c <= self.range_c[1]) {
                let expected = format!("ascending within {last_c} to {}", self.range_c[1]);
                let found = format!("{low_c} to {high_c}");
                return Err(Invalid::new(element("overlaps_c", index), found, expected));
            }
            last_c = high_c;
        }
        Ok(())
    }

    fn value(&self, cavity_c: f64) -> f64 {
        let t = cavity_c.clamp(self.range_c[0], self.range_c[1]);
        let quadratic = |[a0, a1, a2]: [f64; 3]| a0 + t * (a1 + t * a2);
        // The last overlap that begins at or below t says which segment ends there.
        let lower = self.overlaps_c.iter().rposition(|&[low_c, _]| t >= low_c);
        let Some(lower) = lower else {
            return quadratic(self.coefficients[0]);
        };
        let above = quadratic(self.coefficients[lower + 1]);
        let [low_c, high_c] = self.overlaps_c[lower];
        if t >= high_c {
            return above;
        }
        let below = quadratic(self.coefficients[lower]);
        let s = (t - low_c) / (high_c - low_c);
        below + s * s * (3.0 - 2.0 * s) * (above - below)
    }
}

impl LegendreSeries {
    fn check(&self) -> Result<(), Invalid> {
        check_range(self.range_c)?;
        check_count(self.coefficients.len())?;
        for (index, value) in self.coefficients.iter().enumerate() {
            Range::SIGNED.check(&element("coefficients", index), *value)?;
        }
        Ok(())
    }

    fn value(&self, cavity_c: f64) -> f64 {
        let [low_c, high_c] = self.range_c;
        let t = cavity_c.clamp(low_c, high_c);
        let x = (2.0 * t - low_c - high_c) / (high_c - low_c);
        let (mut before, mut now) = (0.0, 1.0);
        let mut sum = 0.0;
        for (coefficient, [ahead, back]) in self.coefficients.iter().zip(BONNET) {
            sum += coefficient * now;
            (before, now) = (now, ahead * x * now - back * before);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit::Unit;

    /// The curve of an axis of the unit `paper`.
    fn paper(axis: usize) -> StaticCurve {
        Unit::named("paper").unwrap().axes[axis]
            .static_curve
            .clone()
    }

    /// Standard deviation over -15..80 degC, all temperatures alike.
    fn standard_deviation(curve: &StaticCurve) -> f64 {
        let points = 95_000;
        let values: Vec<f64> = (0..points)
            .map(|i| -15.0 + 0.001 * (f64::from(i) + 0.5))
            .map(|t| curve.value(t))
            .collect();
        let mean = values.iter().sum::<f64>() / f64::from(points);
        let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        (square / f64::from(points)).sqrt()
    }

    #[test]
    fn z_has_the_standard_deviation_of_table_1() {
        let sigma = standard_deviation(&paper(2));
        assert!((sigma / 0.0335 - 1.0).abs() < 0.001, "{sigma}");
    }

    #[test]
    fn x_and_y_account_for_the_difference_that_compensation_makes_in_table_1() {
        for (curve, before, after, tolerance) in [
            (paper(0), 0.0233_f64, 0.0173, 0.03),
            (paper(1), 0.0280, 0.0189, 0.02),
        ] {
            let sigma = standard_deviation(&curve);
            let together = (sigma * sigma + after * after).sqrt();
            let ratio = together / before;
            assert!((ratio - 1.0).abs() < tolerance, "{curve:?}: {ratio}");
        }
    }

    #[test]
    fn x_and_y_are_the_printed_quadratics_away_from_overlaps() {
        // Worked out by hand from the table.
        for (cavity_c, expected) in [
            (-15.0, 0.0173 + 0.0210 + 0.003_945_375),
            (0.0, 0.0173),
            (20.0, 0.0064 + 0.0080 - 0.017_026_8),
            (40.0, -0.0551 + 0.1040 - 0.052_832),
            (70.0, 0.3390 - 0.8260 + 0.471_115_4),
        ] {
            let value = paper(0).value(cavity_c);
            assert!((value - expected).abs() < 1e-12, "{cavity_c}: {value}");
        }
        for (cavity_c, expected) in [
            (-10.0, 0.0184 + 0.0140 + 0.003_128_1),
            (20.0, 0.0187 - 0.0200 + 0.005_374),
            (40.0, 0.0884 - 0.1600 + 0.067_016),
            (80.0, 0.1204 - 0.2640 + 0.101_881_6),
        ] {
            let value = paper(1).value(cavity_c);
            assert!((value - expected).abs() < 1e-12, "{cavity_c}: {value}");
        }
    }

    #[test]
    fn the_middle_of_an_overlap_is_the_mean_of_both_segments() {
        let below = 0.0064 + 0.0004 * 30.0 - 4.2567e-5 * 900.0;
        let above = -0.0551 + 0.0026 * 30.0 - 3.302e-5 * 900.0;
        let value = paper(0).value(30.0);
        assert!((value - 0.5 * (below + above)).abs() < 1e-15);
    }

    #[test]
    fn value_and_slope_are_continuous_inside_the_range() {
        for curve in [paper(0), paper(1), paper(2)] {
            for edge_c in [5.0, 15.0, 25.0, 35.0, 50.0, 60.0] {
                let h = 1e-4;
                let at = |offset: f64| curve.value(edge_c + offset);
                // The curvature stays below 0.001, so that both differences are of order h.
                let slope_before = (at(0.0) - at(-h)) / h;
                let slope_after = (at(h) - at(0.0)) / h;
                assert!((at(h) - at(-h)).abs() < 1e-5, "{edge_c} degC");
                assert!((slope_after - slope_before).abs() < 1e-6, "{edge_c} degC");
            }
        }
    }

    #[test]
    fn curves_hold_their_end_values_outside_the_range() {
        for curve in [paper(0), paper(2)] {
            assert_eq!(curve.value(-40.0), curve.value(-15.0));
            assert_eq!(curve.value(95.0), curve.value(80.0));
            assert_ne!(curve.value(79.0), curve.value(80.0));
        }
    }

    #[test]
    fn a_series_is_the_sum_of_its_polynomials() {
        let series = LegendreSeries {
            range_c: [-10.0, 30.0],
            coefficients: vec![0.5, -2.0, 3.0, 0.25, -1.5],
        };
        for cavity_c in [-10.0, -3.0, 10.0, 22.5, 30.0] {
            let x: f64 = (cavity_c - 10.0) / 20.0;
            let p = [
                1.0,
                x,
                1.5 * x * x - 0.5,
                2.5 * x * x * x - 1.5 * x,
                (35.0 * x.powi(4) - 30.0 * x * x + 3.0) / 8.0,
            ];
            let expected: f64 = p.iter().zip(&series.coefficients).map(|(p, c)| p * c).sum();
            assert!((series.value(cavity_c) - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn impossible_curves_are_refused() {
        let series = |range_c, count| LegendreSeries {
            range_c,
            coefficients: vec![1.0; count],
        };
        let quadratics = |segments, overlaps_c: &[[f64; 2]]| BlendedQuadratics {
            range_c: [-15.0, 80.0],
            coefficients: vec![[0.0; 3]; segments],
            overlaps_c: overlaps_c.to_vec(),
        };
        for (curve, expected) in [
            (
                StaticCurve::Legendre(series([80.0, -15.0], 2)),
                "`legendre.range_c` is 80 to -15, expected a lower and a higher end",
            ),
            (
                StaticCurve::Legendre(series([-15.0, 80.0], 0)),
                "`legendre.coefficients` is a list of 0, expected a list of 1 to 32",
            ),
            (
                StaticCurve::Segments(quadratics(2, &[])),
                "`segments.overlaps_c` is a list of 0, expected a list of 1",
            ),
            (
                StaticCurve::Segments(quadratics(3, &[[5.0, 15.0], [10.0, 20.0]])),
                "`segments.overlaps_c[2]` is 10 to 20, expected ascending within 15 to 80",
            ),
        ] {
            assert_eq!(curve.check().unwrap_err().to_string(), expected);
        }
    }
}
