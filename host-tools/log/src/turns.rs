//! Where a series turns back.

/// The values between which a series goes up and down in turn: where it begins, its turns and how
/// far it gets at last. A way back of up to `least` is no turn; a series that never moves by more has
/// none of these.
pub fn turns(values: impl Iterator<Item = f64>, least: f64) -> Vec<f64> {
    let mut found = Vec::new();
    // The lowest and highest since the last turn, and the way since then.
    let (mut low, mut high, mut rises) = (f64::INFINITY, f64::NEG_INFINITY, None);
    for value in values {
        match rises {
            Some(true) if value < high - least => {
                found.push(high);
                (rises, low) = (Some(false), value);
            }
            Some(false) if value > low + least => {
                found.push(low);
                (rises, high) = (Some(true), value);
            }
            Some(true) => high = high.max(value),
            Some(false) => low = low.min(value),
            None => {
                (low, high) = (low.min(value), high.max(value));
                if high - low > least {
                    let up = value == high;
                    found.push(if up { low } else { high });
                    rises = Some(up);
                }
            }
        }
    }
    found.extend(rises.map(|up| if up { high } else { low }));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_found_and_noise_is_none() {
        let points = [20.0, -10.0, 60.0, 40.0, 50.0];
        let way = points.windows(2).flat_map(|pair| {
            let (from, to) = (pair[0], pair[1]);
            (0..=100).map(move |i| from + (to - from) * f64::from(i) / 100.0)
        });
        let noisy = way.enumerate();
        let found = turns(noisy.map(|(i, value)| value + 0.5 * (i % 2) as f64), 5.0);
        for (found, expected) in found.iter().zip([20.0, -10.0, 60.5, 40.0, 50.0]) {
            assert!((found - expected).abs() < 0.6, "{found} {expected}");
        }
        assert_eq!(found.len(), 5);
        assert!(turns([20.0, 24.0, 20.0].into_iter(), 5.0).is_empty());
    }
}
