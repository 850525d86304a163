//! Logarithmic scales: their ranges, and ticks at round values.

use std::ops::Range;

/// Room around the values, as a factor.
const MARGIN: f64 = 1.6;

/// A range around positive values, with a margin.
pub(super) fn around(values: impl Iterator<Item = f64>) -> Range<f64> {
    let positive = values.filter(|&value| value > 0.0);
    let (low, high) = positive.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return 0.1..10.0;
    }
    low / MARGIN..high * MARGIN
}

/// Powers of ten in a range; where there are few of them, also twice and five times these.
pub(super) fn ticks(range: &Range<f64>) -> Vec<f64> {
    let [low, high] = [range.start, range.end].map(|end| end.log10().floor() as i32);
    let times = |factors: &[f64]| -> Vec<f64> {
        let powers = (low..=high).map(|power| 10_f64.powi(power));
        let ticks = powers.flat_map(|power| factors.iter().map(move |factor| factor * power));
        ticks.filter(|tick| range.contains(tick)).collect()
    };
    match times(&[1.0]) {
        ticks if ticks.len() > 2 => ticks,
        _ => times(&[1.0, 2.0, 5.0]),
    }
}

/// A tick in as few letters as it takes.
pub(super) fn tick(value: &f64) -> String {
    if (1e-3..1e5).contains(value) {
        // Twice and five times a power of ten are not exact.
        let decimals = (-value.log10()).ceil().max(0.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.0e}")
    }
}
