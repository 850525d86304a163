//! Terms of the thermal history: plays and the second lag.
//!
//! Each is one column over the whole range, whose values the core computes. A play depends on the
//! lag-compensated temperature alone and a second lag on the temperature alone, so that terms are
//! run one by one, whatever their number.

use tempco::{Interval, PLAYS, Play, SecondLag, Thermal, ThermalPoint, ThermalSettings};

use crate::least_squares::Blocks;
use crate::spline::regressors::Regressors;

/// No lag is limited while fitting \[degC\].
const NO_LIMIT_C: f32 = 1e3;

/// A term of the history, all but its gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Term {
    /// A play, with its half width \[degC\].
    Play { half_width_c: f64 },
    /// A second lag, with its time constant \[s\].
    SecondLag { tau2_s: f64 },
}

/// Longest time constant of a thermal path \[s\]. Means over blocks are further apart than rows,
/// and are run with the interval of such a path, to which they are no gap.
const LONGEST_TAU_S: f32 = 6000.0;

/// The terms of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shape {
    /// Half widths of the plays, ascending \[degC\].
    pub(crate) half_widths_c: Vec<f64>,
    /// Time constant of the second lag \[s\].
    pub(crate) tau2_s: Option<f64>,
}

impl Shape {
    pub(crate) fn of(terms: impl Iterator<Item = Term>) -> Self {
        let mut shape = Self::default();
        for term in terms {
            match term {
                Term::Play { half_width_c } => shape.half_widths_c.push(half_width_c),
                Term::SecondLag { tau2_s } => shape.tau2_s = Some(tau2_s),
            }
        }
        shape
    }

    /// The terms in the order of their columns: plays first.
    pub(crate) fn terms(&self) -> Vec<Term> {
        let widths = self.half_widths_c.iter();
        let plays = widths.map(|&half_width_c| Term::Play { half_width_c });
        let lag = self.tau2_s.map(|tau2_s| Term::SecondLag { tau2_s });
        plays.chain(lag).collect()
    }

    /// Settings of the core with these terms: `kappa` holds for the plays too, and no second lag
    /// is limited.
    pub(crate) fn settings(&self, of: ThermalSettings) -> ThermalSettings {
        let half_width_c = |play: usize| self.half_widths_c.get(play).map_or(0.0, |&of| of as f32);
        let limit_c = if self.tau2_s.is_some() {
            NO_LIMIT_C
        } else {
            0.0
        };
        ThermalSettings {
            half_width1_c: half_width_c(0),
            half_width2_c: half_width_c(1),
            play_kappa: if self.half_widths_c.is_empty() {
                0.0
            } else {
                of.kappa
            },
            tau2_s: self.tau2_s.map_or(of.tau2_s, |tau2_s| tau2_s as f32),
            lag2_min_c: -limit_c,
            lag2_max_c: limit_c,
            ..of
        }
    }

    /// What the gain of each term multiplies at a point.
    pub(crate) fn values(&self, point: &ThermalPoint) -> impl Iterator<Item = f64> {
        let plays = point.plays_c.into_iter().take(self.half_widths_c.len());
        plays
            .chain(self.tau2_s.map(|_| point.lag2_c))
            .map(f64::from)
    }
}

const _: () = assert!(PLAYS == 2, "the search looks for two plays at most");

/// Puts plays first, each kind ascending.
pub(crate) fn sort(terms: &mut [Term]) {
    let key = |term: &Term| match *term {
        Term::Play { half_width_c } => (0, half_width_c),
        Term::SecondLag { tau2_s } => (1, tau2_s),
    };
    terms.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
}

/// A block: its log, the time since the block before, its temperature and lag-compensated
/// temperature.
struct BlockPoint {
    log: usize,
    dt_s: f32,
    temp_c: f32,
    effective_c: f32,
}

/// What the gain of the term multiplies, over the blocks of a log \[degC\].
///
/// # Panics
/// If the core refuses the term.
fn follow(term: Term, log: &[BlockPoint]) -> Vec<f64> {
    match term {
        Term::Play { half_width_c } => {
            let mut play = Play::new(log[0].effective_c);
            let follow = |block: &BlockPoint| play.follow(half_width_c as f32, block.effective_c);
            log.iter().map(follow).map(f64::from).collect()
        }
        Term::SecondLag { tau2_s } => {
            let settings = ThermalSettings {
                tau_s: LONGEST_TAU_S,
                tau2_s: tau2_s as f32,
                ..ThermalSettings::DEFAULT
            };
            let thermal =
                Thermal::new(settings).expect("the search stays within the core's bounds");
            let mut lag = SecondLag::new(log[0].temp_c);
            let update =
                |block: &BlockPoint| lag.update(&Interval::new(&thermal, block.dt_s), block.temp_c);
            log.iter().map(update).map(f64::from).collect()
        }
    }
}

/// The values of each term, block by block.
pub(crate) fn block_history(
    blocks: &Blocks,
    regressors: &Regressors,
    kappa: f64,
    terms: &[Term],
) -> Vec<Vec<f64>> {
    if terms.is_empty() {
        return Vec::new();
    }
    let point = |i: usize| {
        let log = blocks.blocks[i].log;
        let before = i.checked_sub(1).filter(|&b| blocks.blocks[b].log == log);
        let dt_s = before.map_or(0.0, |b| blocks.blocks[i].time_s - blocks.blocks[b].time_s);
        BlockPoint {
            log,
            dt_s: dt_s as f32,
            temp_c: blocks.temp_c[i] as f32,
            effective_c: regressors.effective_c(i, kappa) as f32,
        }
    };
    let points: Vec<BlockPoint> = (0..blocks.blocks.len()).map(point).collect();
    let of_term = |&term: &Term| {
        let logs = points.chunk_by(|a, b| a.log == b.log);
        logs.flat_map(|log| follow(term, log)).collect()
    };
    terms.iter().map(of_term).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_come_in_the_order_of_their_columns() {
        let shape = Shape {
            half_widths_c: vec![1.0, 3.0],
            tau2_s: Some(5000.0),
        };
        assert_eq!(Shape::of(shape.terms().into_iter()), shape);
        assert_eq!(shape.terms()[2], Term::SecondLag { tau2_s: 5000.0 });
    }

    /// A term run by itself over blocks has the values that the core gives it among others.
    #[test]
    fn terms_do_not_know_of_each_other() {
        let shape = Shape {
            half_widths_c: vec![0.5, 3.0],
            tau2_s: Some(300.0),
        };
        let settings = shape.settings(ThermalSettings {
            kappa: 0.0,
            ..ThermalSettings::DEFAULT
        });
        let thermal = Thermal::new(settings).unwrap();
        let interval = Interval::new(&thermal, 1.0);
        let mut state = tempco::ThermalState::new(&thermal);
        state.start(&thermal, 20.0);
        let temps = (0..2000).map(|i| 20.0 + 10.0 * (0.01 * i as f32).sin());
        let points: Vec<ThermalPoint> = temps
            .map(|t| state.update(&thermal, &interval, t))
            .collect();
        let temps = (0..2000).map(|i| 20.0 + 10.0 * (0.01 * i as f32).sin());
        let block = |(i, temp_c): (usize, f32)| BlockPoint {
            log: 0,
            dt_s: if i == 0 { 0.0 } else { 1.0 },
            temp_c,
            effective_c: temp_c,
        };
        let blocks: Vec<BlockPoint> = temps.enumerate().map(block).collect();
        let alone = shape.terms();
        let alone: Vec<Vec<f64>> = alone.iter().map(|&term| follow(term, &blocks)).collect();
        for (i, point) in points.iter().enumerate() {
            for (alone, value) in alone.iter().zip(shape.values(point)) {
                assert!((alone[i] - value).abs() < 1e-4, "{i}: {} {value}", alone[i]);
            }
        }
        assert!(alone.iter().flatten().any(|value| *value > 0.4));
    }
}
