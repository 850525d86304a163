//! Where the plays are after a power-on in mid-ramp.

use crate::spline::lags::HALF_WIDTHS_C;
use crate::spline::regressors::Points;

/// Factors that are tried \[degC per degC/min\], each so many times the one before.
const FIRST_MIN: f64 = 1.0;
const RATIO: f64 = 1.3;
const TRIED: usize = 20;

/// The factor of the rate at which a play is put, that comes nearest to where the plays are in the
/// logs, over their half widths:
///
/// ```text
/// v - c = clamp(factor T', -w, w)
/// ```
///
/// 0 where the model has no plays.
pub(crate) fn play_start_min(points: &Points) -> f32 {
    let error = |factor: f64| -> f64 {
        let plays = points.plays_c.iter().zip(HALF_WIDTHS_C);
        let of_play = plays.map(|(plays_c, width_c)| {
            let pairs = plays_c.iter().zip(points.rates.iter());
            let squares = pairs.map(|(play_c, rate)| {
                let put_c = (factor * rate).clamp(-width_c, width_c);
                ((play_c - put_c) / width_c).powi(2)
            });
            squares.sum::<f64>()
        });
        of_play.sum()
    };
    if points.plays_c.is_empty() {
        return 0.0;
    }
    let tried = (0..TRIED).scan(FIRST_MIN, |factor, _| {
        let now = *factor;
        *factor *= RATIO;
        Some(now)
    });
    let best = tried.min_by(|a, b| error(*a).total_cmp(&error(*b)));
    best.unwrap_or(0.0) as f32
}
