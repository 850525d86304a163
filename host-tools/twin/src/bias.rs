//! The true bias of an axis as a function of its cavity's temperature.

/// Lowest and highest temperature of the printed segments, degC.
const PAPER_RANGE_C: (f64, f64) = (-15.0, 80.0);

/// Where neighbouring printed segments overlap, degC.
const PAPER_OVERLAPS_C: [(f64, f64); 3] = [(5.0, 15.0), (25.0, 35.0), (50.0, 60.0)];

/// Static part of a bias, pulses/s, over the cavity temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum StaticCurve {
    /// Quadratic segments joined smoothly.
    Blended(BlendedQuadratics),
    /// One smooth curve.
    Legendre(LegendreSeries),
}

/// Four quadratics, each neighbouring pair blended across an overlap.
///
/// In an overlap `lo..hi` the curve is `(1 - w) p + w q` with `w = s^2 (3 - 2 s)`,
/// `s = (T - lo) / (hi - lo)`: value and slope are continuous at both ends. Outside `range_c` the
/// value at the nearer end holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlendedQuadratics {
    /// Lowest and highest temperature of the curve, degC.
    pub range_c: (f64, f64),
    /// Coefficients of each segment, lowest power first: pulses/s, pulses/s/degC,
    /// pulses/s/degC^2.
    pub segments: [[f64; 3]; 4],
    /// Low and high end of the overlap between each segment and the next, degC; ascending, apart
    /// from each other.
    pub overlaps_c: [(f64, f64); 3],
}

/// A cubic in Legendre polynomials: `c0 + c1 P1(x) + c2 P2(x) + c3 P3(x)`.
///
/// `x` goes from -1 to 1 over `range_c`; outside, the value at the nearer end holds. The
/// polynomials are orthogonal, so that the standard deviation over the range is
/// `sqrt(c1^2/3 + c2^2/5 + c3^2/7)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LegendreSeries {
    /// Lowest and highest temperature of the curve, degC.
    pub range_c: (f64, f64),
    /// Coefficients, lowest order first, pulses/s.
    pub coefficients: [f64; 4],
}

/// True bias of one axis: `static(T) + g (1 + k (T - 25)) T'`, T and T' those of the cavity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisBias {
    /// Static part.
    pub static_curve: StaticCurve,
    /// Temperature rate sensitivity g at 25 degC, pulses/s per degC/min.
    pub rate_sensitivity: f64,
    /// Relative change k of the rate sensitivity with temperature, 1/degC.
    pub rate_sensitivity_slope_per_c: f64,
}

impl AxisBias {
    /// Bias in pulses/s at a cavity temperature and its rate.
    pub fn pulses_per_s(&self, cavity_c: f64, cavity_rate_c_per_min: f64) -> f64 {
        let factor = 1.0 + self.rate_sensitivity_slope_per_c * (cavity_c - 25.0);
        self.static_curve.pulses_per_s(cavity_c)
            + self.rate_sensitivity * factor * cavity_rate_c_per_min
    }
}

impl StaticCurve {
    /// The X gyro of Weng et al., Sensors 2020, 20(2), 377, table 2.
    pub const fn paper_x() -> Self {
        Self::paper([
            [0.0173, -0.0014, 1.7535e-5],
            [0.0064, 0.0004, -4.2567e-5],
            [-0.0551, 0.0026, -3.302e-5],
            [0.3390, -0.0118, 9.6146e-5],
        ])
    }

    /// The Y gyro of the same table.
    ///
    /// The second-order coefficient of the first segment is printed with a minus sign. Only with
    /// a plus sign do the variances of the curve and of table 1's residual add up to table 1's
    /// variance before compensation.
    pub const fn paper_y() -> Self {
        Self::paper([
            [0.0184, -0.0014, 3.1281e-5],
            [0.0187, -0.0010, 1.3435e-5],
            [0.0884, -0.0040, 4.1885e-5],
            [0.1204, -0.0033, 1.5919e-5],
        ])
    }

    /// A curve for the Z gyro with the standard deviation of the paper's table 1, 0.0335 pulses/s.
    ///
    /// The coefficients printed for Z disagree between neighbouring segments by more than that
    /// figure, so the shape is our own.
    pub const fn paper_z() -> Self {
        Self::Legendre(LegendreSeries {
            range_c: PAPER_RANGE_C,
            coefficients: [0.0100, -0.0500, 0.0300, 0.0276],
        })
    }

    const fn paper(segments: [[f64; 3]; 4]) -> Self {
        Self::Blended(BlendedQuadratics {
            range_c: PAPER_RANGE_C,
            segments,
            overlaps_c: PAPER_OVERLAPS_C,
        })
    }

    /// Static bias in pulses/s at a cavity temperature; constant outside the curve's range.
    pub fn pulses_per_s(&self, cavity_c: f64) -> f64 {
        match self {
            Self::Blended(curve) => curve.value(cavity_c),
            Self::Legendre(curve) => curve.value(cavity_c),
        }
    }
}

impl BlendedQuadratics {
    fn value(&self, cavity_c: f64) -> f64 {
        let t = cavity_c.clamp(self.range_c.0, self.range_c.1);
        let quadratic = |[a0, a1, a2]: [f64; 3]| a0 + t * (a1 + t * a2);
        // The last overlap that begins at or below t says which segment ends there.
        let lower = self.overlaps_c.iter().rposition(|&(low_c, _)| t >= low_c);
        let Some(lower) = lower else {
            return quadratic(self.segments[0]);
        };
        let above = quadratic(self.segments[lower + 1]);
        let (low_c, high_c) = self.overlaps_c[lower];
        if t >= high_c {
            return above;
        }
        let below = quadratic(self.segments[lower]);
        let s = (t - low_c) / (high_c - low_c);
        below + s * s * (3.0 - 2.0 * s) * (above - below)
    }
}

impl LegendreSeries {
    fn value(&self, cavity_c: f64) -> f64 {
        let (low_c, high_c) = self.range_c;
        let t = cavity_c.clamp(low_c, high_c);
        let x = (2.0 * t - low_c - high_c) / (high_c - low_c);
        let [c0, c1, c2, c3] = self.coefficients;
        let p2 = 1.5 * x * x - 0.5;
        let p3 = x * (2.5 * x * x - 1.5);
        c0 + c1 * x + c2 * p2 + c3 * p3
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Standard deviation over -15..80 degC, all temperatures alike.
    fn standard_deviation(curve: &StaticCurve) -> f64 {
        let points = 95_000;
        let values: Vec<f64> = (0..points)
            .map(|i| -15.0 + 0.001 * (f64::from(i) + 0.5))
            .map(|t| curve.pulses_per_s(t))
            .collect();
        let mean = values.iter().sum::<f64>() / f64::from(points);
        let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        (square / f64::from(points)).sqrt()
    }

    #[test]
    fn z_has_the_standard_deviation_of_table_1() {
        let sigma = standard_deviation(&StaticCurve::paper_z());
        assert!((sigma / 0.0335 - 1.0).abs() < 0.001, "{sigma}");
    }

    #[test]
    fn x_and_y_account_for_the_difference_that_compensation_makes_in_table_1() {
        for (curve, before, after, tolerance) in [
            (StaticCurve::paper_x(), 0.0233_f64, 0.0173, 0.03),
            (StaticCurve::paper_y(), 0.0280, 0.0189, 0.02),
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
            let value = StaticCurve::paper_x().pulses_per_s(cavity_c);
            assert!((value - expected).abs() < 1e-12, "{cavity_c}: {value}");
        }
        for (cavity_c, expected) in [
            (-10.0, 0.0184 + 0.0140 + 0.003_128_1),
            (20.0, 0.0187 - 0.0200 + 0.005_374),
            (40.0, 0.0884 - 0.1600 + 0.067_016),
            (80.0, 0.1204 - 0.2640 + 0.101_881_6),
        ] {
            let value = StaticCurve::paper_y().pulses_per_s(cavity_c);
            assert!((value - expected).abs() < 1e-12, "{cavity_c}: {value}");
        }
    }

    #[test]
    fn the_middle_of_an_overlap_is_the_mean_of_both_segments() {
        let below = 0.0064 + 0.0004 * 30.0 - 4.2567e-5 * 900.0;
        let above = -0.0551 + 0.0026 * 30.0 - 3.302e-5 * 900.0;
        let value = StaticCurve::paper_x().pulses_per_s(30.0);
        assert!((value - 0.5 * (below + above)).abs() < 1e-15);
    }

    #[test]
    fn value_and_slope_are_continuous_inside_the_range() {
        for curve in [
            StaticCurve::paper_x(),
            StaticCurve::paper_y(),
            StaticCurve::paper_z(),
        ] {
            for edge_c in [5.0, 15.0, 25.0, 35.0, 50.0, 60.0] {
                let h = 1e-4;
                let at = |offset: f64| curve.pulses_per_s(edge_c + offset);
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
        for curve in [StaticCurve::paper_x(), StaticCurve::paper_z()] {
            assert_eq!(curve.pulses_per_s(-40.0), curve.pulses_per_s(-15.0));
            assert_eq!(curve.pulses_per_s(95.0), curve.pulses_per_s(80.0));
            assert_ne!(curve.pulses_per_s(79.0), curve.pulses_per_s(80.0));
        }
    }

    #[test]
    fn the_rate_part_grows_with_temperature() {
        let bias = AxisBias {
            static_curve: StaticCurve::paper_x(),
            rate_sensitivity: 0.07,
            rate_sensitivity_slope_per_c: 0.004,
        };
        let rate_part =
            |t: f64, rate: f64| bias.pulses_per_s(t, rate) - bias.static_curve.pulses_per_s(t);
        assert!((rate_part(25.0, -2.0) + 0.14).abs() < 1e-15);
        assert!((rate_part(75.0, 1.0) - 0.084).abs() < 1e-15);
        assert_eq!(rate_part(75.0, 0.0), 0.0);
    }
}
