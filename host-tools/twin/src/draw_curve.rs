//! Static curves drawn at random, of the order and size of another one.

use crate::curve::{BlendedQuadratics, LegendreSeries, StaticCurve};
use crate::normal::NormalSource;

/// A curve of the same kind, order, range, mean and rms size about the mean.
///
/// The variance of a Legendre polynomial in the sum falls with 1 / order. Segments are quadratics
/// through three points each of such a series, so that neighbours nearly agree where they overlap.
pub(crate) fn like(curve: &StaticCurve, random: &mut NormalSource) -> StaticCurve {
    match curve {
        StaticCurve::Legendre(curve) => StaticCurve::Legendre(series_like(curve, random)),
        StaticCurve::Segments(curve) => StaticCurve::Segments(segments_like(curve, random)),
    }
}

/// A Legendre series without a constant.
fn series(range_c: [f64; 2], orders: usize, random: &mut NormalSource) -> LegendreSeries {
    let mut coefficient = |order: usize| {
        let order = order as f64;
        random.next() * ((2.0 * order + 1.0) / order).sqrt()
    };
    let coefficients = (0..=orders)
        .map(|order| if order == 0 { 0.0 } else { coefficient(order) })
        .collect();
    LegendreSeries {
        range_c,
        coefficients,
    }
}

fn series_like(curve: &LegendreSeries, random: &mut NormalSource) -> LegendreSeries {
    let variance = |coefficients: &[f64]| -> f64 {
        let orders = coefficients.iter().enumerate().skip(1);
        orders
            .map(|(order, c)| c * c / (2 * order + 1) as f64)
            .sum()
    };
    let mut drawn = series(curve.range_c, curve.coefficients.len() - 1, random);
    let share = variance(&curve.coefficients) / variance(&drawn.coefficients);
    // A constant has no variance, before and after.
    let factor = if share.is_finite() { share.sqrt() } else { 0.0 };
    for coefficient in &mut drawn.coefficients {
        *coefficient *= factor;
    }
    drawn.coefficients[0] = curve.coefficients[0];
    drawn
}

fn segments_like(curve: &BlendedQuadratics, random: &mut NormalSource) -> BlendedQuadratics {
    let [low_c, high_c] = curve.range_c;
    let count = curve.coefficients.len();
    let series = StaticCurve::Legendre(series(curve.range_c, count + 2, random));
    let quadratic = |index: usize| {
        let begin_c = index
            .checked_sub(1)
            .map_or(low_c, |before| curve.overlaps_c[before][0]);
        let end_c = curve
            .overlaps_c
            .get(index)
            .map_or(high_c, |overlap| overlap[1]);
        quadratic_through([begin_c, 0.5 * (begin_c + end_c), end_c], |t| {
            series.value(t)
        })
    };
    let mut drawn = BlendedQuadratics {
        coefficients: (0..count).map(quadratic).collect(),
        ..curve.clone()
    };
    let (mean, rms) = mean_and_rms(curve);
    let (drawn_mean, drawn_rms) = mean_and_rms(&drawn);
    let factor = rms / drawn_rms;
    for segment in &mut drawn.coefficients {
        *segment = segment.map(|coefficient| factor * coefficient);
        segment[0] += mean - factor * drawn_mean;
    }
    drawn
}

/// Coefficients, lowest power first, by Newton's divided differences.
fn quadratic_through([a, b, c]: [f64; 3], value: impl Fn(f64) -> f64) -> [f64; 3] {
    let [at_a, at_b, at_c] = [a, b, c].map(value);
    let slope = (at_b - at_a) / (b - a);
    let bend = ((at_c - at_b) / (c - b) - slope) / (c - a);
    [at_a - a * (slope - b * bend), slope - (a + b) * bend, bend]
}

/// Mean, and rms about it, over the range, at a thousand temperatures.
fn mean_and_rms(curve: &BlendedQuadratics) -> (f64, f64) {
    const POINTS: u32 = 1000;
    let [low_c, high_c] = curve.range_c;
    let curve = StaticCurve::Segments(curve.clone());
    let values: Vec<f64> = (0..POINTS)
        .map(|i| low_c + (high_c - low_c) * (f64::from(i) + 0.5) / f64::from(POINTS))
        .map(|t| curve.value(t))
        .collect();
    let mean = values.iter().sum::<f64>() / f64::from(POINTS);
    let square: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (mean, (square / f64::from(POINTS)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal::Stream;
    use crate::unit::Unit;

    #[test]
    fn size_and_mean_stay() {
        for name in ["paper", "wavy", "smooth"] {
            for axis in Unit::named(name).unwrap().axes {
                for seed in 0..20 {
                    let mut random = NormalSource::new(seed, Stream::DrawnAxis(0));
                    let drawn = like(&axis.static_curve, &mut random);
                    let (mean, rms) = moments(&axis.static_curve);
                    let (drawn_mean, drawn_rms) = moments(&drawn);
                    assert!(
                        (drawn_rms / rms - 1.0).abs() < 1e-3,
                        "{name} {drawn_rms} {rms}"
                    );
                    assert!(
                        (drawn_mean - mean).abs() < 1e-3 * rms,
                        "{name} {drawn_mean}"
                    );
                    assert_ne!(drawn, axis.static_curve);
                }
            }
        }
    }

    /// Mean, and rms about it, over the curve's range.
    fn moments(curve: &StaticCurve) -> (f64, f64) {
        let [low_c, high_c] = match curve {
            StaticCurve::Segments(curve) => curve.range_c,
            StaticCurve::Legendre(curve) => curve.range_c,
        };
        let points = 20_000;
        let values: Vec<f64> = (0..points)
            .map(|i| low_c + (high_c - low_c) * (f64::from(i) + 0.5) / f64::from(points))
            .map(|t| curve.value(t))
            .collect();
        let mean = values.iter().sum::<f64>() / f64::from(points);
        let square: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        (mean, (square / f64::from(points)).sqrt())
    }

    #[test]
    fn a_quadratic_passes_through_its_points() {
        let [a0, a1, a2] = quadratic_through([-5.0, 20.0, 45.0], |t| 3.0 - 0.5 * t + 0.02 * t * t);
        for (found, expected) in [(a0, 3.0), (a1, -0.5), (a2, 0.02)] {
            assert!((found - expected).abs() < 1e-12, "{found}");
        }
    }

    #[test]
    fn a_constant_stays_one() {
        let constant = StaticCurve::Legendre(LegendreSeries {
            range_c: [-40.0, 85.0],
            coefficients: vec![0.3],
        });
        let mut random = NormalSource::new(1, Stream::DrawnAxis(0));
        assert_eq!(like(&constant, &mut random), constant);
    }
}
