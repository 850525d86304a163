//! Terms of the thermal history that the core can add to the table.
//!
//! Each is one column over the whole range, whose values come from the core's own
//! [`HistoryState`]. A term depends on the lag-compensated temperature alone, so that terms are run one
//! by one, whatever their number.

use tempco::{History, HistoryState, Interval, Play, SlowPart, Thermal, ThermalSettings};
use tempco_set::Term;

use crate::least_squares::{Blocks, SamplePoints};
use crate::spline::regressors::Regressors;

/// No lag is limited while fitting \[degC\].
const NO_LIMIT_C: f32 = 1e3;

/// Longest time constant of a thermal path \[s\]. Means over blocks are further apart than rows,
/// and are run with the interval of such a path, to which they are no gap.
const LONGEST_TAU_S: f32 = 6000.0;

/// The terms of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shape {
    /// Half widths of the plays, ascending \[degC\].
    pub(crate) half_widths_c: Vec<f64>,
    /// Time constant of the second thermal lag \[s\].
    pub(crate) slow_tau_s: Option<f64>,
}

impl Shape {
    pub(crate) fn of(terms: impl Iterator<Item = Term>) -> Self {
        let mut shape = Self::default();
        for term in terms {
            match term {
                Term::Play { half_width_c } => shape.half_widths_c.push(half_width_c),
                Term::SlowPart { tau_s } => shape.slow_tau_s = Some(tau_s),
            }
        }
        shape
    }

    /// The terms in the order of their columns: plays first, as in the core.
    pub(crate) fn terms(&self) -> Vec<Term> {
        let widths = self.half_widths_c.iter();
        let plays = widths.map(|&half_width_c| Term::Play { half_width_c });
        let slow = self.slow_tau_s.map(|tau_s| Term::SlowPart { tau_s });
        plays.chain(slow).collect()
    }
}

/// Puts plays first, each kind ascending.
pub(crate) fn sort(terms: &mut [Term]) {
    let key = |term: &Term| match *term {
        Term::Play { half_width_c } => (0, half_width_c),
        Term::SlowPart { tau_s } => (1, tau_s),
    };
    terms.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
}

/// What the gain of the term multiplies, over a series of lag-compensated temperatures, each with the
/// interval since the one before \[degC\].
///
/// # Panics
/// If the core refuses the term.
pub(crate) fn follow(
    term: Term,
    start_c: f32,
    series: impl Iterator<Item = (Interval, f32)>,
) -> Vec<f32> {
    let checked = "the search stays within the core's bounds";
    match term {
        Term::Play { half_width_c } => {
            let play = Play {
                half_width_c: half_width_c as f32,
                gain: [],
            };
            let history = History::<0, 1, 0>::new(0.0, [play], []).expect(checked);
            let mut state = HistoryState::new(start_c);
            series
                .map(|(interval, u)| state.update(&history, &interval, u).plays_c[0])
                .collect()
        }
        Term::SlowPart { tau_s } => {
            let part = SlowPart {
                tau_s: tau_s as f32,
                limit_c: NO_LIMIT_C,
                gain: [],
            };
            let history = History::<0, 0, 1>::new(0.0, [], [part]).expect(checked);
            let mut state = HistoryState::new(start_c);
            series
                .map(|(interval, u)| state.update(&history, &interval, u).lags_c[0])
                .collect()
        }
    }
}

/// The values of each term, block by block, from the lag-compensated temperatures of the blocks.
pub(crate) fn block_history(
    blocks: &Blocks,
    regressors: &Regressors,
    kappa: f64,
    terms: &[Term],
) -> Vec<Vec<f64>> {
    if terms.is_empty() {
        return Vec::new();
    }
    let settings = ThermalSettings {
        tau_s: LONGEST_TAU_S,
        ..ThermalSettings::DEFAULT
    };
    let thermal = Thermal::new(settings).expect("the default with another time constant");
    let count = blocks.blocks.len();
    let series: Vec<(usize, Interval, f32)> = (0..count)
        .map(|i| {
            let log = blocks.blocks[i].log;
            let before = i.checked_sub(1).filter(|&b| blocks.blocks[b].log == log);
            let dt_s = before.map_or(0.0, |b| blocks.blocks[i].time_s - blocks.blocks[b].time_s);
            let interval = Interval::new(&thermal, dt_s as f32);
            (log, interval, regressors.effective_c(i, kappa) as f32)
        })
        .collect();
    let of_term = |term: &Term| {
        let mut values = Vec::with_capacity(count);
        for log in series.chunk_by(|a, b| a.0 == b.0) {
            let points = log.iter().map(|&(_, interval, u)| (interval, u));
            values.extend(follow(*term, log[0].2, points).into_iter().map(f64::from));
        }
        values
    };
    terms.iter().map(of_term).collect()
}

/// The values of each term by log and sample.
pub(crate) fn sample_history(points: &SamplePoints, terms: &[Term]) -> Vec<Vec<Vec<f32>>> {
    let of_log = |term: &Term, log: usize| {
        let series = points
            .of_log(log)
            .iter()
            .map(|sample| (sample.interval, sample.point.effective_c));
        follow(*term, points.start_c(log), series)
    };
    let logs = 0..points.logs();
    let of_term = |term: &Term| logs.clone().map(|log| of_log(term, log)).collect();
    terms.iter().map(of_term).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_come_in_the_order_of_the_core() {
        let shape = Shape {
            half_widths_c: vec![1.0, 3.0],
            slow_tau_s: Some(5000.0),
        };
        assert_eq!(Shape::of(shape.terms().into_iter()), shape);
        assert_eq!(shape.terms()[2], Term::SlowPart { tau_s: 5000.0 });
    }

    /// One term by itself is what it is beside others in the core.
    #[test]
    fn terms_do_not_know_of_each_other() {
        let thermal = Thermal::new(ThermalSettings::DEFAULT).unwrap();
        let interval = Interval::new(&thermal, 1.0);
        let play = |half_width_c| Play {
            half_width_c,
            gain: [],
        };
        let part = SlowPart {
            tau_s: 300.0,
            limit_c: NO_LIMIT_C,
            gain: [],
        };
        let history = History::<0, 2, 1>::new(60.0, [play(0.5), play(3.0)], [part]).unwrap();
        let mut state = HistoryState::new(20.0);
        let shape = Shape {
            half_widths_c: vec![0.5, 3.0],
            slow_tau_s: Some(300.0),
        };
        let temps = || (0..2000).map(|i| 20.0 + 10.0 * (0.01 * i as f32).sin());
        let series = || temps().map(|u| (interval, u));
        let alone: Vec<Vec<f32>> = shape
            .terms()
            .iter()
            .map(|&term| follow(term, 20.0, series()))
            .collect();
        for (i, u) in temps().enumerate() {
            let point = state.update(&history, &interval, u);
            assert_eq!([alone[0][i], alone[1][i]], point.plays_c);
            assert_eq!([alone[2][i]], point.lags_c);
        }
        assert!(alone.iter().flatten().any(|value| *value > 0.4));
    }
}
