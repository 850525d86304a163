//! Rows that are far from their neighbours in time.

use crate::regress::ChannelData;
use crate::screen::{SIGMA_PER_MAD, SIGMA_PER_STEP, median};

/// Rows further from their local median than this many standard deviations are left out: of
/// normal noise one in 5e8.
const LIMIT: f64 = 6.0;

/// The local median is over this long \[s\] ...
const WINDOW_S: f64 = 10.0;

/// ... or over this many rows, if they take longer.
const WINDOW_ROWS: usize = 11;

/// Leaves spikes out, for all axes; returns the number of rows.
pub(super) fn leave_out(data: &mut ChannelData) -> usize {
    let mut count = 0;
    for (log, keep) in data.logs.iter().zip(&mut data.keep) {
        let rows: Vec<usize> = (0..log.rows()).filter(|&row| keep[row]).collect();
        let window = WINDOW_ROWS.max((WINDOW_S / log.interval_s) as usize);
        for axis in &log.channels[data.channel].axes {
            let values: Vec<f64> = rows.iter().map(|&row| axis.raw[row]).collect();
            for spike in spikes(&values, window) {
                count += usize::from(keep[rows[spike]]);
                keep[rows[spike]] = false;
            }
        }
    }
    count
}

/// Positions of spikes: values far from the local median and from those before and after it, to
/// which a lasting change would belong. The scale is the larger of two: of the distances from the local medians,
/// and of the steps between neighbours that differ, which is not below the step of a coarse
/// output such as whole pulses.
fn spikes(values: &[f64], window: usize) -> Vec<usize> {
    let levels: Vec<f64> = values
        .chunks(window)
        .map(|part| median(&mut part.to_vec()))
        .collect();
    let distance = |row: usize| {
        let own = row / window;
        let near = own.saturating_sub(1)..(own + 2).min(levels.len());
        let all = levels[near].iter().map(|level| (values[row] - level).abs());
        all.fold(f64::INFINITY, f64::min)
    };
    let distances: Vec<f64> = (0..values.len()).map(distance).collect();
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mut steps: Vec<f64> = steps.filter(|&step| step > 0.0).collect();
    let spread = SIGMA_PER_MAD * median(&mut distances.clone());
    let limit = LIMIT * spread.max(SIGMA_PER_STEP * median(&mut steps));
    let far = distances.iter().enumerate();
    far.filter(|&(_, &distance)| distance > limit)
        .map(|(position, _)| position)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::white;

    #[test]
    fn spikes_go_and_noise_stays() {
        let noise = white(1).take(1000).enumerate();
        let mut values: Vec<f64> = noise.map(|(i, v)| v + 0.01 * i as f64).collect();
        assert!(spikes(&values, 20).is_empty());
        let lasting = values.iter().enumerate();
        let lasting = lasting.map(|(i, v)| v + if i < 505 { 0.0 } else { 30.0 });
        assert!(spikes(&lasting.collect::<Vec<_>>(), 20).is_empty());
        values[17] += 30.0;
        values[500] -= 30.0;
        assert_eq!(spikes(&values, 20), [17, 500]);
    }

    /// Few pulses among many intervals without any are the signal.
    #[test]
    fn whole_pulses_are_not_spikes() {
        let values: Vec<f64> = (0..1000)
            .map(|i| if i % 37 == 0 { 2.0 } else { 0.0 })
            .collect();
        assert!(spikes(&values, 20).is_empty());
        assert!(spikes(&[5.0; 100], 20).is_empty());
    }
}
