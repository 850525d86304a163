//! Blocks that are far from what temperature and its rate explain.

use tempco::{TableError, ThermalSettings};
use tempco_log::AxisUnit;
use tempco_set::{BiasStep, Disturbance};

use crate::least_squares::{Basis, Block, Blocks, Gram, RateForm, SparseRow, dot};
use crate::outliers::leaps::{self, Leaps, Series};
use crate::outliers::limits::{is_beyond, limits, undisturbed, usual_weight, white_sigmas};
use crate::outliers::parts::{Parts, of_log};
use crate::outliers::{gaps, steps};
use crate::summary::{ChannelData, Offset};

/// Fits and rejections in turn until nothing changes, at most so many times.
const ROUNDS: usize = 6;

/// Segments of the reference, and the narrowest \[degC\].
const SEGMENTS: usize = 8;
const LEAST_WIDTH_C: f64 = 8.0;

/// A second, slower rate in the reference: this many time constants of the first.
const SLOWER: f64 = 10.0;

/// The reference fit: flexible enough not to take thermal lag for a disturbance. It decides what
/// stays in the fit and is otherwise forgotten.
pub(super) struct Reference {
    blocks: Blocks,
    /// The leaps of each log.
    leaps: Vec<Leaps>,
    parts: Parts,
    fitted: Fitted,
}

/// What the reference leaves.
struct Fitted {
    /// For each block, whether it stays.
    keep: Vec<bool>,
    /// By axis and block; of left-out blocks as well.
    residuals: Vec<Vec<f64>>,
    /// By axis, how far a residual of a usual block may be.
    limits: Vec<f64>,
    /// Of each part and axis: how far its constant is from the mean of all.
    contrasts: Vec<Vec<f64>>,
}

/// Fits the reference; with `reject`, without the disturbed blocks.
pub(super) fn find(
    data: &ChannelData,
    settings: &ThermalSettings,
    reject: bool,
) -> Result<Reference, TableError> {
    let blocks = Blocks::new(data);
    // What leaps goes first, as it would bend the reference.
    let leaps: Vec<Leaps> = match reject {
        true => (0..blocks.logs())
            .map(|log| leaps_of(data, &blocks, log))
            .collect(),
        false => Vec::new(),
    };
    let mut leap: Vec<bool> = leaps.iter().flat_map(|of| of.left_out.clone()).collect();
    leap.resize(blocks.blocks.len(), false);
    let tau_s = f64::from(settings.tau_s);
    let rates = [
        blocks.rates(data, settings, tau_s)?,
        blocks.rates(data, settings, (SLOWER * tau_s).min(2400.0))?,
    ];
    let least_sigmas = reject.then(|| white_sigmas(data, &blocks));
    let fit = |parts: &Parts| fit(&blocks, &rates, parts, &leap, least_sigmas.as_deref());
    let mut parts = Parts::new(&blocks, &leaps);
    let mut fitted = fit(&parts);
    // Across a gap the unit may have been switched off: its constant is then another one.
    if reject && let Some(split) = gaps::split(&blocks, &parts.of_block, &leap) {
        let apart = Parts::of(&blocks, split);
        let free = fit(&apart);
        let residuals = [&fitted.residuals, &free.residuals];
        let same = gaps::joined(
            &blocks,
            [&parts.of_block, &apart.of_block],
            residuals,
            &free.contrasts,
        );
        if same != parts.of_block {
            parts = Parts::of(&blocks, same);
            fitted = fit(&parts);
        }
    }
    Ok(Reference {
        blocks,
        leaps,
        parts,
        fitted,
    })
}

/// Fits all blocks but those that leap. With `least_sigmas`, fits without what is disturbed.
fn fit(
    blocks: &Blocks,
    [fast, slow]: &[Vec<f64>; 2],
    parts: &Parts,
    leap: &[bool],
    least_sigmas: Option<&[f64]>,
) -> Fitted {
    let count = blocks.blocks.len();
    let (low, high) = Blocks::range(&blocks.temp_c);
    let segments = (((high - low) / LEAST_WIDTH_C) as usize).clamp(1, SEGMENTS);
    let edge = |k: usize| low + (high - low) * k as f64 / segments as f64;
    let edges = (0..=segments).map(edge).collect();
    let basis = Basis::new(edges, RateForm::Line, parts.count);
    let columns = basis.columns();
    let rows: Vec<SparseRow> = (0..count)
        .map(|i| {
            let mut row = SparseRow::new();
            basis.row(parts.of_block[i], blocks.temp_c[i], fast[i], &mut row);
            row.extend([
                (columns, slow[i]),
                (columns + 1, slow[i] * blocks.temp_c[i] / 100.0),
            ]);
            row
        })
        .collect();

    // Fit and rejection take turns until nothing changes.
    let mut keep: Vec<bool> = leap.iter().map(|leap| !leap).collect();
    let mut solution = Vec::new();
    for _ in 0..ROUNDS {
        let mut gram = Gram::new(columns + 2, blocks.axes());
        for i in (0..count).filter(|&i| keep[i]) {
            gram.push(&rows[i], blocks.observations(i), blocks.blocks[i].weight);
        }
        solution = gram
            .solve()
            .unwrap_or_else(|| vec![vec![0.0; columns + 2]; blocks.axes()]);
        let Some(least_sigmas) = least_sigmas else {
            break;
        };
        let residuals = residuals(blocks, &rows, &solution);
        let limits = limits(&residuals, leap, least_sigmas);
        let quiet = undisturbed(blocks, &residuals, &limits);
        let now: Vec<bool> = quiet
            .iter()
            .zip(leap)
            .map(|(quiet, leap)| *quiet && !leap)
            .collect();
        // Where so many would go, it is the reference that does not fit: what disturbs leaps.
        let rejected = (0..count).filter(|&i| !now[i] && !leap[i]).count();
        if now == keep || rejected as f64 > Disturbance::MOST_SHARE * count as f64 {
            break;
        }
        keep = now;
    }
    let residuals = residuals(blocks, &rows, &solution);
    Fitted {
        limits: limits(
            &residuals,
            leap,
            least_sigmas.unwrap_or(&vec![0.0; blocks.axes()]),
        ),
        contrasts: contrasts(parts.count, basis.static_columns(), &solution),
        keep,
        residuals,
    }
}

fn leaps_of(data: &ChannelData, blocks: &Blocks, log: usize) -> Leaps {
    let of_log = of_log(blocks, log);
    let column = |figure: fn(&Block) -> f64| -> Vec<f64> {
        blocks.blocks[of_log.clone()].iter().map(figure).collect()
    };
    let axes = data.of(log).axes.iter();
    leaps::find(&Series {
        times_s: &column(|block| block.time_s),
        weights: &column(|block| block.weight),
        values: blocks.raw.iter().map(|raw| &raw[of_log.clone()]).collect(),
        at_rest: &axes.map(|axis| at_rest(axis.unit)).collect::<Vec<_>>(),
    })
}

/// How far the output of an axis at rest can step when the unit is turned to another place: twice
/// the earth's rate, or any share of gravity. Pulses may be of any size; a pulse per arcsec is fine.
fn at_rest(unit: AxisUnit) -> f64 {
    const TWICE_EARTH_DPH: f64 = 31.0;
    match unit {
        AxisUnit::Dph | AxisUnit::PulsesPerS => TWICE_EARTH_DPH,
        AxisUnit::Dps => TWICE_EARTH_DPH / 3600.0,
        AxisUnit::Radps => (TWICE_EARTH_DPH / 3600.0).to_radians(),
        AxisUnit::Mps2 | AxisUnit::G => f64::INFINITY,
    }
}

fn residuals(blocks: &Blocks, rows: &[SparseRow], solution: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let of_axis = blocks.raw.iter().zip(solution);
    of_axis
        .map(|(raw, solution)| {
            let pairs = raw.iter().zip(rows);
            pairs.map(|(raw, row)| raw - dot(row, solution)).collect()
        })
        .collect()
}

/// How far the constant of each part is from the mean of all, by part and axis.
fn contrasts(parts: usize, first: usize, solution: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let of_axis = |axis: usize, part: usize| {
        let contrasts = &solution[axis][first..first + parts - 1];
        match contrasts.get(part) {
            Some(contrast) => *contrast,
            None => -contrasts.iter().sum::<f64>(),
        }
    };
    (0..parts)
        .map(|part| {
            (0..solution.len())
                .map(|axis| of_axis(axis, part))
                .collect()
        })
        .collect()
}

impl Reference {
    /// Leaves the rows of disturbed blocks out and counts them.
    pub(super) fn leave_out(&self, data: &mut ChannelData) -> usize {
        let mut count = 0;
        for (block, _) in self
            .blocks
            .blocks
            .iter()
            .zip(&self.fitted.keep)
            .filter(|(_, k)| !**k)
        {
            data.keep[block.log][block.position] = false;
            count += block.weight as usize;
        }
        count
    }

    /// Log and position of the blocks that leap.
    pub(super) fn moved(&self) -> Vec<(usize, usize)> {
        let leapt = self.leaps.iter().flat_map(|leaps| &leaps.left_out);
        let blocks = self.blocks.blocks.iter().zip(leapt);
        let moved = blocks.filter(|(_, leapt)| **leapt);
        moved
            .map(|(block, _)| (block.log, block.position))
            .collect()
    }

    /// How far the constant of each log and axis is from the mean of the logs.
    pub(super) fn constants(&self) -> Vec<Vec<f64>> {
        let logs = self.blocks.logs() as f64;
        let of = |part: usize, axis: usize| self.fitted.contrasts[part][axis];
        let homes = &self.parts.of_log;
        let of_axis = |axis: usize, log: usize| {
            let means = self.blocks.log_means.iter().map(|means| means[axis]);
            // With a part for each log, the contrasts add up to 0.
            let common = match self.parts.count == homes.len() {
                true => 0.0,
                false => homes.iter().map(|&home| of(home, axis)).sum::<f64>() / logs,
            };
            of(homes[log], axis) + self.blocks.log_means[log][axis]
                - means.sum::<f64>() / logs
                - common
        };
        (0..homes.len())
            .map(|log| {
                (0..self.blocks.axes())
                    .map(|axis| of_axis(axis, log))
                    .collect()
            })
            .collect()
    }

    /// For each log, the steps between its parts.
    pub(super) fn offsets(&self, data: &ChannelData) -> Vec<Vec<Offset>> {
        let of_log = |log: usize| {
            let home = &self.fitted.contrasts[self.parts.of_log[log]];
            let mut offsets = Vec::new();
            let mut last = self.parts.of_log[log];
            for i in of_log(&self.blocks, log) {
                let part = self.parts.of_block[i];
                if part != last {
                    let axes = self.fitted.contrasts[part].iter().zip(home);
                    offsets.push(Offset {
                        from: self.blocks.blocks[i].position,
                        axes: axes.map(|(part, home)| part - home).collect(),
                    });
                }
                last = part;
            }
            offsets
        };
        (0..data.logs.len()).map(of_log).collect()
    }

    /// What is disturbed, by log and axis.
    pub(super) fn disturbances(&self, data: &ChannelData) -> Vec<Disturbance> {
        let usual = usual_weight(&self.blocks);
        let mut found = Vec::new();
        for (log, leaps) in self.leaps.iter().enumerate() {
            let range = of_log(&self.blocks, log);
            let first = range.start;
            for (axis, name) in data.of(log).axes.iter().enumerate() {
                let is_disturbed = |&i: &usize| {
                    let residual = self.fitted.residuals[axis][i];
                    let block = &self.blocks.blocks[i];
                    leaps.disturbed[axis][i - first]
                        || !self.fitted.keep[i]
                            && is_beyond(residual, self.fitted.limits[axis], block, usual)
                };
                let blocks: Vec<_> = range
                    .clone()
                    .filter(is_disturbed)
                    .map(|i| &self.blocks.blocks[i])
                    .collect();
                let (Some(from), Some(to)) = (blocks.first(), blocks.last()) else {
                    continue;
                };
                let rows = blocks.iter().map(|block| block.weight).sum::<f64>();
                let all = &data.of(log).blocks;
                found.push(Disturbance {
                    file: data.logs[log].file.clone(),
                    axis: name.name.clone(),
                    rows: rows as usize,
                    share: (rows / data.logs[log].rows as f64).min(1.0),
                    from_s: all[from.position].from_s,
                    to_s: all[to.position].to_s,
                    left_out: !leaps.too_much,
                });
            }
        }
        found
    }

    /// Steps of the bias by log and time: between parts, and what the reference does not explain.
    pub(super) fn steps(&self, data: &ChannelData) -> Vec<BiasStep> {
        let mut found = Vec::new();
        for (number, log) in data.logs.iter().enumerate() {
            let range = of_log(&self.blocks, number);
            // Blocks next to a step are far from the reference: only what leaps is not asked.
            let first = range.start;
            let leaps = self.leaps.get(number);
            let leaps = |i: usize| leaps.is_some_and(|of| of.left_out[i - first]);
            let kept: Vec<usize> = range.filter(|&i| !leaps(i)).collect();
            let times: Vec<f64> = kept.iter().map(|&i| self.blocks.blocks[i].time_s).collect();
            let axes = &data.of(number).axes;
            for (axis, of_axis) in axes.iter().enumerate() {
                let step = |time_s: f64, size: f64, levelled: bool| BiasStep {
                    file: log.file.clone(),
                    axis: of_axis.name.clone(),
                    time_s,
                    size,
                    levelled,
                    large: levelled && size.abs() > self.leaps[number].large[axis],
                };
                for pair in kept.windows(2) {
                    let [before, after] = [pair[0], pair[1]].map(|i| self.parts.of_block[i]);
                    let size =
                        self.fitted.contrasts[after][axis] - self.fitted.contrasts[before][axis];
                    if before != after && size.abs() > self.fitted.limits[axis] {
                        let time_s = |i: usize| self.blocks.blocks[i].time_s;
                        found.push(step(0.5 * (time_s(pair[0]) + time_s(pair[1])), size, true));
                    }
                }
                let values: Vec<f64> = kept
                    .iter()
                    .map(|&i| self.fitted.residuals[axis][i])
                    .collect();
                let steps = steps::find(&times, &values).into_iter();
                found.extend(steps.map(|(time_s, size)| step(time_s, size, false)));
            }
        }
        found
    }
}
