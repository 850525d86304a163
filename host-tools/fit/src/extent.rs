//! What the kept rows of a channel cover: degrees, means, directions, speed.

use std::collections::BTreeSet;

use tempco_log::turns::turns;
use tempco_set::{Extent, Stretch, TooFast};

use crate::summary::{Block, ChannelData};

/// Means are counted in this length, whatever the blocks are \[s\].
const MEAN_S: f64 = 10.0;

/// A turn of less is no turn: noise of a sensor, a chamber that overshoots \[degC\].
const LEAST_TURN_C: f64 = 2.0;

/// What is covered is counted in steps of this part of a degree: soaks have noise at both ends.
const PER_DEGREE: usize = 10;

/// Degrees that rows of a slow log may pass between them.
const MOST_PASSED_C: usize = 5;

/// So many changes one after the other, all in one direction, are no bad readings.
const LEAST_FAST: usize = 3;

/// What the kept rows cover, with the fastest change that the core follows.
pub(crate) fn of(data: &ChannelData, limit_c_per_min: f64) -> Extent {
    let mut steps = BTreeSet::new();
    let (mut heated_c, mut cooled_c, mut time_s) = (0.0, 0.0, 0.0);
    let mut too_fast: Option<TooFast> = None;
    for log in 0..data.logs.len() {
        let channel = data.of(log);
        let mut means: Vec<(f64, f64)> = Vec::new();
        let mut last: Option<(usize, i64)> = None;
        for (_, position, block) in data.blocks().filter(|(of, ..)| *of == log) {
            // Between neighbouring samples the temperature passed all steps, unless it leapt.
            for temp_c in channel.temps_c(block) {
                let at = (f64::from(temp_c) * PER_DEGREE as f64).floor() as i64;
                let from = last
                    .filter(|(before, _)| position - before <= 1)
                    .map(|(_, step)| step)
                    .filter(|step| step.abs_diff(at) <= (MOST_PASSED_C * PER_DEGREE) as u64)
                    .unwrap_or(at);
                steps.extend(from.min(at)..=from.max(at));
                last = Some((position, at));
            }
            time_s += channel.block_s;
            means.push((0.5 * (block.from_s + block.to_s), block.moments.temp_c));
        }
        let (up_c, down_c) = travelled(means.iter().map(|(_, temp_c)| *temp_c));
        heated_c += up_c;
        cooled_c += down_c;
        // The core does not accept them for long, so rows that are not kept count as well.
        let exclude = &data.logs[log].plan.options.exclude;
        let excluded = |block: &Block| {
            let overlaps = |of: &Stretch| of.from_s <= block.to_s && of.to_s >= block.from_s;
            exclude.iter().any(overlaps)
        };
        let all = channel.blocks.iter().filter(|block| !excluded(block));
        let all: Vec<_> = all
            .map(|block| (0.5 * (block.from_s + block.to_s), channel.mean_c(block)))
            .collect();
        let found = fast(&all, 2.0 * channel.block_s, limit_c_per_min);
        let faster = found.filter(|found| {
            let fastest = too_fast.as_ref().map_or(0.0, |of| of.rate_c_per_min);
            found.rate_c_per_min > fastest
        });
        if let Some(found) = faster {
            let file = data.logs[log].file().to_owned();
            too_fast = Some(TooFast { file, ..found });
        }
    }
    Extent {
        covered_c: steps.len() / PER_DEGREE,
        // Blocks of a log are equally long but for rounding.
        means: (time_s / MEAN_S + 1e-6) as usize,
        heated_c,
        cooled_c,
        too_fast,
    }
}

/// How far temperatures go up and down in all, small turns aside \[degC\].
fn travelled(temps_c: impl Iterator<Item = f64>) -> (f64, f64) {
    let turns_c = turns(temps_c, LEAST_TURN_C);
    let ways_c = turns_c.windows(2).map(|pair| pair[1] - pair[0]);
    ways_c.fold((0.0, 0.0), |(up_c, down_c), way_c| {
        (up_c + way_c.max(0.0), down_c + (-way_c).max(0.0))
    })
}

/// Stretches in which the temperature changes faster than the limit from mean to mean.
fn fast(means: &[(f64, f64)], near_s: f64, limit_c_per_min: f64) -> Option<TooFast> {
    let changes = means.windows(2).map(|pair| {
        let [(from_s, from_c), (to_s, to_c)] = [pair[0], pair[1]];
        let rate = 60.0 * (to_c - from_c) / (to_s - from_s);
        let is_fast = to_s - from_s <= near_s && rate.abs() > limit_c_per_min;
        (from_s, to_s, if is_fast { rate } else { 0.0 })
    });
    let changes: Vec<_> = changes.collect();
    let rates: Vec<_> = changes
        .chunk_by(|(.., a), (.., b)| a * b > 0.0)
        .filter(|run| run.len() >= LEAST_FAST)
        .flatten()
        .collect();
    let (first, last) = (rates.first()?, rates.last()?);
    Some(TooFast {
        file: String::new(),
        rate_c_per_min: rates
            .iter()
            .map(|(.., rate)| rate.abs())
            .fold(0.0, f64::max),
        limit_c_per_min,
        share: rates.len() as f64 / means.len() as f64,
        from_s: first.0,
        to_s: last.1,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_turns_are_no_turns() {
        let up_down = [0.0, 1.0, 0.5, 5.0, 10.0, 9.0, 10.5, 3.0, 4.0, 0.0, 1.5];
        assert_eq!(travelled(up_down.into_iter()), (10.5, 10.5));
        assert_eq!(travelled([3.0, 2.0, 1.0, 0.0].into_iter()), (0.0, 3.0));
        assert_eq!(travelled([3.0, 2.0, 3.0].into_iter()), (0.0, 0.0));
    }

    #[test]
    fn speed_has_a_place() {
        let means = |rate: f64| -> Vec<(f64, f64)> {
            let heated = |i: usize| rate / 6.0 * i.clamp(20, 30) as f64;
            (0..60).map(|i| (10.0 * i as f64, heated(i))).collect()
        };
        assert_eq!(fast(&means(29.0), 20.0, 30.0), None);
        // A bad reading goes there and back.
        let mut bad = means(0.0);
        (bad[20].1, bad[21].1, bad[22].1) = (20.0, 40.0, 20.0);
        assert_eq!(fast(&bad, 20.0, 30.0), None);
        let found = fast(&means(40.0), 20.0, 30.0).unwrap();
        assert_eq!((found.from_s, found.to_s), (200.0, 300.0));
        assert!(
            (found.rate_c_per_min - 40.0).abs() < 1e-9 && (found.share - 1.0 / 6.0).abs() < 1e-9
        );
    }
}
