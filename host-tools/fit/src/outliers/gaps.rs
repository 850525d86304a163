//! Gaps in a log, across which the unit may have been switched off and on.
//!
//! Temperature moves on in a gap, so that a new constant does not show as a leap. A part on either
//! side gets a constant of its own where that explains far more, and by much.

use std::collections::BTreeSet;

use tempco_log::median::median;

use crate::least_squares::Blocks;
use crate::outliers::SIGMA_PER_MAD;

/// A gap is longer than this \[s\].
const GAP_S: f64 = 60.0;

/// Blocks that a part must have on either side of a gap.
const LEAST_BLOCKS: usize = 30;

/// Degrees that parts must share, or their constants cannot be compared.
const SHARED_C: usize = 10;

/// More parts than this are not tried: the reference would be divided among too many.
const MOST_PARTS: usize = 8;

/// Constants apart must leave less than this share of the residual ...
const LEFT: f64 = 0.5;

/// ... and be this many times what is then left.
const LIMIT: f64 = 6.0;

/// The parts of all blocks with those divided that a gap divides; none without such gaps.
pub(super) fn split(blocks: &Blocks, of_block: &[usize], leap: &[bool]) -> Option<Vec<usize>> {
    let first = of_block.iter().max()? + 1;
    let mut next = first;
    let mut split = of_block.to_vec();
    let quiet: Vec<usize> = (0..of_block.len()).filter(|&i| !leap[i]).collect();
    // Quiet blocks since the last gap or step.
    let mut run = 0;
    for at in 1..quiet.len() {
        let (before, i) = (quiet[at - 1], quiet[at]);
        run += 1;
        if of_block[before] != of_block[i] {
            run = 0;
            continue;
        }
        let apart_s = blocks.blocks[i].time_s - blocks.blocks[before].time_s;
        if apart_s > GAP_S && run >= LEAST_BLOCKS {
            let rest = quiet[at..]
                .iter()
                .take_while(|&&of| of_block[of] == of_block[i]);
            if rest.count() >= LEAST_BLOCKS {
                let end = (i..of_block.len()).find(|&of| of_block[of] != of_block[i]);
                split[i..end.unwrap_or(of_block.len())].fill(next);
                next += 1;
                run = 0;
            }
        }
    }
    (next > first && next <= MOST_PARTS).then_some(split)
}

/// The parts of all blocks with those joined again whose constants are not apart. `parts` and
/// `residuals` without and with the division; `contrasts` with it.
pub(super) fn joined(
    blocks: &Blocks,
    [whole, divided]: [&[usize]; 2],
    residuals: [&Vec<Vec<f64>>; 2],
    contrasts: &[Vec<f64>],
) -> Vec<usize> {
    let degrees = |part: usize| -> BTreeSet<i64> {
        let of_part = divided
            .iter()
            .zip(&blocks.temp_c)
            .filter(|(of, _)| **of == part);
        of_part.map(|(_, temp_c)| temp_c.floor() as i64).collect()
    };
    let usual =
        |of: &[f64]| SIGMA_PER_MAD * median(&mut of.iter().map(|r| r.abs()).collect::<Vec<_>>());
    let is_apart = |before: usize, after: usize| {
        let shared = degrees(before).intersection(&degrees(after)).count();
        let axes = residuals[0].iter().zip(residuals[1]).enumerate();
        shared >= SHARED_C
            && axes.into_iter().any(|(axis, (joined, free))| {
                let apart = contrasts[after][axis] - contrasts[before][axis];
                usual(free) < LEFT * usual(joined) && apart.abs() > LIMIT * usual(free)
            })
    };
    let mut found: Vec<usize> = Vec::with_capacity(divided.len());
    for i in 0..divided.len() {
        let part = match i.checked_sub(1) {
            Some(before) if whole[before] == whole[i] => {
                let changes = divided[before] != divided[i];
                let is_apart = changes && is_apart(divided[before], divided[i]);
                if is_apart { divided[i] } else { found[before] }
            }
            _ => whole[i],
        };
        found.push(part);
    }
    dense(found)
}

/// The same parts without numbers that are not used.
fn dense(parts: Vec<usize>) -> Vec<usize> {
    let used: Vec<usize> = BTreeSet::from_iter(parts.iter().copied())
        .into_iter()
        .collect();
    let position = |part: &usize| used.partition_point(|of| of < part);
    parts.iter().map(position).collect()
}
