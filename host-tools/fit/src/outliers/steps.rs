//! Sudden and lasting changes of the bias.

use tempco_log::median::median;

use crate::outliers::SIGMA_PER_MAD;

/// Means over this long before and after are compared \[s\], in a short log over this share of it ...
const LASTING_S: f64 = 1200.0;
const LASTING_SHARE: f64 = 1.0 / 20.0;

/// ... and over this share of that, which a slow change does not pass.
const SUDDEN_SHARE_OF_TIME: f64 = 0.1;

/// A mean over less is of too few blocks \[s\].
const LEAST_S: f64 = 30.0;

/// A step is this many times the usual difference of the means.
const LIMIT: f64 = 6.0;

/// The sudden change is this many times the usual one.
const SUDDEN_LIMIT: f64 = 4.0;

/// Of the lasting change, at least this share must be sudden.
const SUDDEN_SHARE: f64 = 0.6;

/// A lasting change is one of all but one of so many parts of the time before and after: what comes and
/// goes in less is a disturbance.
const PARTS: usize = 4;

/// Times and sizes of steps.
pub(super) fn find(times_s: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    let length_s = match times_s {
        [first, .., last] => last - first,
        _ => return Vec::new(),
    };
    let lasting_s = LASTING_S.min(LASTING_SHARE * length_s);
    let sudden_s = (SUDDEN_SHARE_OF_TIME * lasting_s).max(LEAST_S);
    if lasting_s < 2.0 * sudden_s {
        return Vec::new();
    }
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(values.iter().scan(0.0, |sum, value| {
            *sum += value;
            Some(*sum)
        }))
        .collect();
    let mean = |a: usize, b: usize| (sums[b] - sums[a]) / (b - a) as f64;
    // Mean after less mean before the i-th value; none where a side is not half full.
    let difference = |i: usize, length_s: f64| {
        let from = times_s.partition_point(|&t| t < times_s[i] - length_s);
        let to = times_s.partition_point(|&t| t < times_s[i] + length_s);
        let covered = times_s[i] - times_s[from] > 0.5 * length_s
            && times_s[to - 1] - times_s[i] > 0.5 * length_s;
        (covered && from < i).then(|| mean(i, to) - mean(from, i))
    };
    let differences = |length_s: f64| -> (Vec<Option<f64>>, f64) {
        let found: Vec<_> = (0..values.len()).map(|i| difference(i, length_s)).collect();
        let mut sizes: Vec<f64> = found.iter().flatten().map(|d| d.abs()).collect();
        let usual = SIGMA_PER_MAD * median(&mut sizes);
        (found, usual)
    };
    // Whether the parts after the i-th value lie on one side of the parts before it, but for one each.
    let lasts = |i: usize, size: f64| {
        let part_mean = |from_s: f64, to_s: f64| {
            let [a, b] = [from_s, to_s].map(|of| times_s.partition_point(|&t| t < times_s[i] + of));
            (a < b).then(|| size.signum() * mean(a, b))
        };
        let edge = |part: usize| lasting_s * part as f64 / PARTS as f64;
        let sorted = |parts: [Option<f64>; PARTS]| {
            let mut parts: Vec<f64> = parts.into_iter().flatten().collect();
            parts.sort_unstable_by(f64::total_cmp);
            parts
        };
        let parts = std::array::from_fn(|part| part);
        let after = sorted(parts.map(|part| part_mean(edge(part), edge(part + 1))));
        let before = sorted(parts.map(|part| part_mean(-edge(part + 1), -edge(part))));
        match (after.get(1), before.iter().rev().nth(1)) {
            (Some(after), Some(before)) => after > before,
            _ => true,
        }
    };
    let (lasting, usual) = differences(lasting_s);
    let (sudden, usual_sudden) = differences(sudden_s);
    let limit = LIMIT * usual;
    let mut steps = Vec::new();
    let mut peaks: Vec<f64> = Vec::new();
    let mut order: Vec<usize> = (0..values.len())
        .filter(|&i| lasting[i].is_some_and(|d| limit > 0.0 && d.abs() > limit))
        .collect();
    let size_at = |i: usize| lasting[i].unwrap_or(0.0);
    order.sort_by(|&a, &b| size_at(b).abs().total_cmp(&size_at(a).abs()));
    for i in order {
        let (time_s, size) = (times_s[i], size_at(i));
        // What is near a larger change is its flank.
        let near = |peak: &f64| (time_s - peak).abs() < 2.0 * lasting_s;
        if peaks.iter().any(near) {
            continue;
        }
        peaks.push(time_s);
        let at_once = sudden[i].unwrap_or(0.0);
        let is_sudden =
            at_once / size > SUDDEN_SHARE && at_once.abs() > SUDDEN_LIMIT * usual_sudden;
        if is_sudden && lasts(i, size) {
            steps.push((time_s, size));
        }
    }
    steps.sort_by(|a: &(f64, f64), b| a.0.total_cmp(&b.0));
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::white;

    fn series(step: f64, width_s: f64) -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..3000).map(|i| 10.0 * f64::from(i)).collect();
        let values = times.iter().zip(white(5)).map(|(&t, noise)| {
            let share = ((t - 12_000.0) / width_s + 0.5).clamp(0.0, 1.0);
            noise + (t / 4000.0).sin() * 0.2 + step * share
        });
        (times.clone(), values.collect())
    }

    #[test]
    fn a_step_is_found_and_a_slow_change_is_not() {
        let (times, values) = series(6.0, 1.0);
        let steps = find(&times, &values);
        assert_eq!(steps.len(), 1, "{steps:?}");
        assert!((steps[0].0 - 12_000.0).abs() < 60.0 && (steps[0].1 - 6.0).abs() < 0.5);
        for (step, width_s) in [(0.0, 1.0), (6.0, 3600.0)] {
            let (times, values) = series(step, width_s);
            assert_eq!(find(&times, &values), [], "{step} over {width_s} s");
        }
    }

    /// Ten minutes off are half of the time that is compared.
    #[test]
    fn what_comes_and_goes_is_no_step() {
        let (times, mut values) = series(0.0, 1.0);
        values[900..960].iter_mut().for_each(|value| *value += 20.0);
        assert_eq!(find(&times, &values), []);
    }
}
