//! Sudden movement: blocks whose means leap. No model is asked, so that no model can hide them.
//!
//! A turn of the unit, a hand on it, or an axis at its rail begins and ends within a few blocks.
//! Temperature does not. Leaps part a log into quiet stretches, each at a level of its own:
//!
//! - A level that is left and returned to: what lies between is disturbed.
//! - A level that is not returned to: the bias has stepped. Each level is a part of the log, with
//!   a constant of its own.

use std::ops::Range;

use tempco_log::median::median;
use tempco_set::Disturbance;

/// A block leaps if it is this many standard deviations from the mean of its neighbours: in clean
/// logs of all simulated units none is further than 6.
const LIMIT: f64 = 12.0;

/// Neighbours so many blocks away are asked. The second ones find a leap in the middle of a block,
/// of which the next ones see half.
const NEIGHBOURS: [usize; 2] = [1, 2];

/// A level differs from another beyond this many standard deviations ...
const LEVEL_LIMIT: f64 = 8.0;

/// ... and beyond this share of the leaps between, which are not known better.
const LEVEL_SHARE: f64 = 0.1;

/// Standard deviation of normal values over the first quartile of their distance from 0. Up to
/// three quarters of the blocks may leap before the quartile follows them.
const SIGMA_PER_QUARTILE: f64 = 3.138;

/// Distances up to this share of the largest value are rounding.
const ROUNDING: f64 = 1e-9;

/// Leaps with fewer quiet blocks between are one: a stretch must be long enough to have a level.
const LEAST_STRETCH: usize = 6;

/// Blocks next to a leap that give the level, and those that give the drift.
const LEVEL_BLOCKS: usize = 3;
const DRIFT_BLOCKS: usize = 30;

/// Blocks further apart are no neighbours \[s\].
const NEAR_S: f64 = 60.0;

/// Without this many blocks, nobody knows how much they usually differ.
const LEAST_BLOCKS: usize = 12;

/// A level this many standard deviations of the rest of the axis away is no bias of the unit.
const LARGE: f64 = 3.0;

/// The blocks of one log.
pub(super) struct Series<'a> {
    /// Middle of each block \[s\].
    pub(super) times_s: &'a [f64],
    /// Rows of each block.
    pub(super) weights: &'a [f64],
    /// Means by axis and block.
    pub(super) values: Vec<&'a [f64]>,
    /// For each axis, how far a unit at rest can be from another rest \[unit of the axis\].
    pub(super) at_rest: &'a [f64],
}

/// The parts into which leaps divide a log.
#[derive(Debug, PartialEq)]
pub(super) struct Leaps {
    /// The part of each block, numbered from 0.
    pub(super) parts: Vec<usize>,
    /// Whether a block is to be left out.
    pub(super) left_out: Vec<bool>,
    /// By axis and block, whether it is disturbed.
    pub(super) disturbed: Vec<Vec<bool>>,
    /// So much is disturbed that none is left out.
    pub(super) too_much: bool,
    /// For each axis, a step beyond this is no bias of the unit \[unit of the axis\].
    pub(super) large: Vec<f64>,
}

impl Leaps {
    fn none(series: &Series) -> Self {
        let (blocks, axes) = (series.times_s.len(), series.values.len());
        Self {
            parts: vec![0; blocks],
            left_out: vec![false; blocks],
            disturbed: vec![vec![false; blocks]; axes],
            too_much: false,
            large: vec![f64::INFINITY; axes],
        }
    }
}

/// Finds the leaps of a log.
pub(super) fn find(series: &Series) -> Leaps {
    let mut found = Leaps::none(series);
    // A block of few rows, as at the end of a log, is noisier. It is not asked.
    let usual = median(&mut series.weights.to_vec());
    let full: Vec<usize> = (0..series.weights.len())
        .filter(|&i| series.weights[i] >= 0.5 * usual)
        .collect();
    if full.len() < LEAST_BLOCKS {
        return found;
    }
    let axes: Vec<Vec<f64>> = series
        .values
        .iter()
        .map(|values| full.iter().map(|&i| values[i]).collect())
        .collect();
    let times_s: Vec<f64> = full.iter().map(|&i| series.times_s[i]).collect();
    let leaps: Vec<(Vec<bool>, f64)> = axes
        .iter()
        .map(|values| leaps_of(values, &times_s))
        .collect();
    let sigmas: Vec<f64> = leaps.iter().map(|(_, sigma)| *sigma).collect();
    let any: Vec<bool> = (0..full.len())
        .map(|i| leaps.iter().any(|(leaps, _)| leaps[i]))
        .collect();
    let stretches = stretches(&any);
    if stretches.is_empty() || stretches.len() == 1 && stretches[0].len() == full.len() {
        found.too_much = stretches.is_empty();
        if found.too_much {
            found.disturbed = vec![vec![true; series.times_s.len()]; axes.len()];
        }
        return found;
    }

    // Levels of the stretches, and what lies between two of them.
    let mut levels = vec![vec![0.0; axes.len()]];
    let mut disturbed = vec![vec![false; full.len()]; axes.len()];
    let mut left_out = vec![false; full.len()];
    for pair in stretches.windows(2) {
        let between = pair[0].end..pair[1].start;
        let mut level = levels[levels.len() - 1].clone();
        let mut steps = false;
        for (axis, values) in axes.iter().enumerate() {
            let leap = Leap::new(values, &pair[0], &pair[1]);
            let tolerance = LEVEL_LIMIT * sigmas[axis];
            let size = leap.size();
            if size.abs() > tolerance {
                level[axis] += size;
                steps = true;
            }
            for i in between
                .clone()
                .filter(|&i| leap.is_off(values[i], tolerance))
            {
                disturbed[axis][i] = true;
                left_out[i] = true;
            }
        }
        // The blocks in which the bias steps belong to neither side.
        left_out[between].iter_mut().for_each(|out| *out |= steps);
        levels.push(level);
    }
    // Blocks before the first stretch and after the last one have no level to return to.
    for i in (0..stretches[0].start).chain(stretches[stretches.len() - 1].end..full.len()) {
        left_out[i] = any[i];
        for (disturbed, (leaps, _)) in disturbed.iter_mut().zip(&leaps) {
            disturbed[i] = leaps[i];
        }
    }
    for (axis, values) in axes.iter().enumerate() {
        let large = LARGE * spread(values, &stretches, &levels, axis);
        found.large[axis] = large.max(series.at_rest[axis]);
    }

    let mut parts = parts(&levels, &sigmas);
    // Stretches at a level that is left again: disturbed if they are few, steps if they are small.
    let away = |parts: &[Option<usize>]| -> Vec<usize> {
        (0..parts.len()).filter(|&of| parts[of].is_none()).collect()
    };
    let is_small = |stretch: usize| {
        let home = (0..stretch).rev().find(|&of| parts[of].is_some());
        let home = &levels[home.unwrap_or(0)];
        (0..axes.len()).all(|axis| (levels[stretch][axis] - home[axis]).abs() <= found.large[axis])
    };
    let all_small = away(&parts).into_iter().all(is_small);
    let blocks_away: usize = away(&parts).iter().map(|&of| stretches[of].len()).sum();
    let off = (0..full.len())
        .filter(|&i| disturbed.iter().any(|axis| axis[i]))
        .count();
    let most = Disturbance::MOST_SHARE * full.len() as f64;
    if (off + blocks_away) as f64 > most && all_small && off as f64 <= most {
        let next = parts.iter().flatten().max().map_or(0, |last| last + 1);
        for (number, of) in (next..).zip(away(&parts)) {
            parts[of] = Some(number);
        }
    }
    for of in away(&parts) {
        let home = (0..of).rev().find(|&of| parts[of].is_some()).unwrap_or(0);
        left_out[stretches[of].clone()].fill(true);
        for (axis, disturbed) in disturbed.iter_mut().enumerate() {
            if (levels[of][axis] - levels[home][axis]).abs() > LEVEL_LIMIT * sigmas[axis] {
                disturbed[stretches[of].clone()].fill(true);
            }
        }
    }
    let off = (0..full.len())
        .filter(|&i| disturbed.iter().any(|axis| axis[i]))
        .count();
    found.too_much = off as f64 > most;
    // Blocks of few rows go with what is next to them.
    for block in 0..series.times_s.len() {
        let next = full.partition_point(|&full| full < block);
        let is_full = full.get(next) == Some(&block);
        let near = if is_full {
            next
        } else {
            next.saturating_sub(1)
        }..full.len().min(next + 1);
        for (to, from) in found.disturbed.iter_mut().zip(&disturbed) {
            to[block] = from[near.clone()].contains(&true);
        }
        found.left_out[block] = left_out[near].contains(&true) && !found.too_much;
    }
    if !found.too_much {
        found.parts = of_blocks(&parts, &stretches, &full, series.times_s.len());
    }
    found
}

/// Which blocks of an axis leap, and the standard deviation of a block from its neighbours' mean.
fn leaps_of(values: &[f64], times_s: &[f64]) -> (Vec<bool>, f64) {
    let apart = |i: usize, reach: usize| {
        let (before, after) = (i.checked_sub(reach)?, i + reach);
        let [to_before_s, to_after_s] = [
            times_s[i] - times_s[before],
            times_s.get(after)? - times_s[i],
        ];
        let is_near = to_before_s.max(to_after_s) <= NEAR_S;
        is_near.then(|| (values[i] - 0.5 * (values[before] + values[after])).abs())
    };
    // Means of whole pulses are often equal, but for rounding: that says nothing about their steps.
    let largest = values.iter().fold(0.0, |most: f64, of| most.max(of.abs()));
    let next = (0..values.len()).filter_map(|i| apart(i, NEIGHBOURS[0]));
    let mut sizes: Vec<f64> = next.filter(|&of| of > ROUNDING * largest).collect();
    if sizes.len() < LEAST_BLOCKS {
        return (vec![false; values.len()], f64::INFINITY);
    }
    let quartile = sizes.len() / 4;
    let (_, quartile, _) = sizes.select_nth_unstable_by(quartile, f64::total_cmp);
    let sigma = SIGMA_PER_QUARTILE * *quartile;
    let leaps = |i: usize| {
        let mut apart = NEIGHBOURS.iter().filter_map(|&reach| apart(i, reach));
        apart.any(|apart| apart > LIMIT * sigma)
    };
    ((0..values.len()).map(leaps).collect(), sigma)
}

/// The quiet stretches that are long enough to have a level.
fn stretches(leaps: &[bool]) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = 0;
    for i in 0..=leaps.len() {
        if leaps.get(i).is_none_or(|&leaps| leaps) {
            if i - start >= LEAST_STRETCH {
                found.push(start..i);
            }
            start = i + 1;
        }
    }
    found
}

/// A leap of an axis between two stretches.
struct Leap {
    before: f64,
    after: f64,
    /// Drift over the time between, at the speed of either side \[unit of the axis\].
    drifts: [f64; 2],
}

impl Leap {
    fn new(values: &[f64], before: &Range<usize>, after: &Range<usize>) -> Self {
        let mid = |range: Range<usize>| median(&mut values[range].to_vec());
        let drift = |range: Range<usize>| {
            let half = range.len() / 2;
            let first = mid(range.start..range.start + half);
            (mid(range.end - half..range.end) - first) / (range.len() - half) as f64
        };
        let last = before.end - LEVEL_BLOCKS..before.end;
        let first = after.start..after.start + LEVEL_BLOCKS;
        let blocks = (first.start - last.start) as f64;
        let tail = before.start.max(before.end.saturating_sub(DRIFT_BLOCKS))..before.end;
        let head = after.start..after.end.min(after.start + DRIFT_BLOCKS);
        Self {
            before: mid(last),
            after: mid(first),
            drifts: [blocks * drift(tail), blocks * drift(head)],
        }
    }

    /// What the drift does not explain.
    fn size(&self) -> f64 {
        let change = self.after - self.before;
        let [low, high] = [f64::min, f64::max].map(|of| of(self.drifts[0], self.drifts[1]));
        change - change.clamp(low, high)
    }

    /// Whether a value between is at neither level, nor on the way.
    fn is_off(&self, value: f64, tolerance: f64) -> bool {
        let reach = tolerance + self.drifts[0].abs().max(self.drifts[1].abs());
        let [low, high] = [f64::min, f64::max].map(|of| of(self.before, self.after));
        value < low - reach || value > high + reach
    }
}

/// The part of each stretch; none of a stretch whose level is left for an earlier one.
fn parts(levels: &[Vec<f64>], sigmas: &[f64]) -> Vec<Option<usize>> {
    let same = |i: usize, j: usize| {
        (0..sigmas.len()).all(|axis| {
            let apart = |k: usize| (levels[k][axis] - levels[i][axis]).abs();
            let largest = (i..=j).map(apart).fold(0.0, f64::max);
            apart(j) <= (LEVEL_LIMIT * sigmas[axis]).max(LEVEL_SHARE * largest)
        })
    };
    let mut parts = vec![None; levels.len()];
    let (mut first, mut number) = (0, 0);
    while first < levels.len() {
        let last = (first..levels.len()).rev().find(|&of| same(first, of));
        let last = last.unwrap_or(first);
        for (of, part) in parts.iter_mut().enumerate().take(last + 1).skip(first) {
            *part = same(first, of).then_some(number);
        }
        number += 1;
        first = last + 1;
    }
    parts
}

/// Standard deviation of an axis, each stretch less its level.
fn spread(values: &[f64], stretches: &[Range<usize>], levels: &[Vec<f64>], axis: usize) -> f64 {
    let levelled: Vec<f64> = stretches
        .iter()
        .zip(levels)
        .flat_map(|(stretch, level)| values[stretch.clone()].iter().map(|v| v - level[axis]))
        .collect();
    let count = levelled.len() as f64;
    let mean = levelled.iter().sum::<f64>() / count;
    (levelled
        .iter()
        .map(|v| (v - mean) * (v - mean))
        .sum::<f64>()
        / count)
        .sqrt()
}

/// The part of every block: that of its stretch, or of the part before.
fn of_blocks(
    parts: &[Option<usize>],
    stretches: &[Range<usize>],
    full: &[usize],
    blocks: usize,
) -> Vec<usize> {
    let mut found = vec![0; blocks];
    for (part, stretch) in parts.iter().zip(stretches) {
        if let Some(part) = part {
            found[full[stretch.start]..].fill(*part);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means that differ by rounding alone do not say how far blocks usually are from each other.
    #[test]
    fn rounding_is_no_scale() {
        let times_s: Vec<f64> = (0..1000).map(|i| 10.0 * f64::from(i)).collect();
        let value = |i: u32| match i % 7 {
            0 => 0.4,
            of => [0.3, 0.1 * 3.0][of as usize % 2],
        };
        let values: Vec<f64> = (0..1000).map(value).collect();
        let (leaps, sigma) = leaps_of(&values, &times_s);
        assert!(sigma > 0.1, "{sigma}");
        assert!(!leaps.contains(&true));
    }
}
