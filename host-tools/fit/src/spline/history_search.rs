//! The search for history terms: which, how wide, how slow.
//!
//! Candidates on a grid are all put into one set of normal equations, from which any combination is
//! a few rows and columns: combinations are compared exhaustively, on all data and again without
//! each fold.

use crate::least_squares::Gram;
use crate::spline::history_terms::{Shape, Term};
use crate::spline::lag_search::log_likelihood;

/// The narrowest play \[degC\].
const LEAST_WIDTH_C: f64 = 0.2;

/// The widest play, as a share of the range of temperature.
const MOST_WIDTH: f64 = 0.3;

/// The second lag is slower than the rate estimator by this factor at least. A closer one only
/// bends the estimator's own lag, and costs accuracy after power-on.
const LEAST_SLOWNESS: f64 = 3.0;

/// The slowest lag, and how many of its time constants a log must last.
const MOST_TAU_S: f64 = 20_000.0;
const TAUS_PER_LOG: f64 = 3.0;

/// Neighbours on the first grid are this factor apart.
const GRID_RATIO: f64 = 1.6;

/// Each pass of refinement divides the distance of neighbours by three, on the scale of the
/// logarithm: after the last, they are 2 % apart.
pub(crate) const REFINEMENTS: usize = 3;

/// A term is at an end of the search within this share.
const AT_END: f64 = 0.01;

/// Two plays have half widths that differ by this factor at least.
const PLAYS_APART: f64 = 1.4;

/// How many terms of each kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Kind {
    pub(crate) plays: usize,
    pub(crate) second_lag: bool,
}

impl Kind {
    /// Those that are tried, the simplest first.
    pub(crate) const ALL: [Self; 5] = [
        Self::of(1, false),
        Self::of(0, true),
        Self::of(2, false),
        Self::of(1, true),
        Self::of(2, true),
    ];

    /// What time constant and shift are searched with again.
    pub(crate) const USUAL: Self = Self::of(1, true);

    const fn of(plays: usize, second_lag: bool) -> Self {
        Self { plays, second_lag }
    }
}

/// Bounds of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) half_width_c: (f64, f64),
    /// None where the logs are too short for a second lag.
    pub(crate) tau_s: Option<(f64, f64)>,
}

impl Bounds {
    /// For a range of lag-compensated temperatures, the time constant of the rate estimator and the
    /// longest log.
    pub(crate) fn new(range_c: (f64, f64), tau_s: f64, longest_log_s: f64) -> Self {
        let slow = (
            LEAST_SLOWNESS * tau_s,
            MOST_TAU_S.min(longest_log_s / TAUS_PER_LOG),
        );
        Self {
            half_width_c: (LEAST_WIDTH_C, MOST_WIDTH * (range_c.1 - range_c.0)),
            tau_s: (slow.1 > slow.0).then_some(slow),
        }
    }

    /// Whether all terms lie within the bounds: at an end of the search, nothing was found.
    pub(crate) fn encloses(&self, shape: &Shape) -> bool {
        let within = |value: f64, (low, high): (f64, f64)| {
            value > low * (1.0 + AT_END) && value < high * (1.0 - AT_END)
        };
        let mut widths = shape.half_widths_c.iter();
        let mut taus = shape.tau2_s.iter().zip(self.tau_s);
        widths.all(|&width| within(width, self.half_width_c))
            && taus.all(|(&tau_s, bounds)| within(tau_s, bounds))
    }

    /// The terms of the first grid, plays first.
    pub(crate) fn grid(&self) -> Vec<Term> {
        let over = |(low, high): (f64, f64)| {
            let steps = ((high / low).ln() / GRID_RATIO.ln()).ceil().max(1.0);
            (0..=steps as u32).map(move |i| low * (high / low).powf(f64::from(i) / steps))
        };
        let plays = over(self.half_width_c).map(|half_width_c| Term::Play { half_width_c });
        let slow = self.tau_s.into_iter().flat_map(over);
        plays
            .chain(slow.map(|tau2_s| Term::SecondLag { tau2_s }))
            .collect()
    }

    /// Terms around those of a shape, a `pass` of refinement on.
    pub(crate) fn around(&self, shape: &Shape, pass: usize) -> Vec<Term> {
        let step = GRID_RATIO.ln() / 3.0_f64.powi(pass as i32);
        let near = |value: f64, (low, high): (f64, f64)| {
            let steps = (-2..=2).map(move |i| value * (f64::from(i) * step).exp());
            steps.filter(move |&value| value >= low && value <= high)
        };
        let mut widths: Vec<f64> = shape
            .half_widths_c
            .iter()
            .flat_map(|&width| near(width, self.half_width_c))
            .collect();
        widths.sort_by(f64::total_cmp);
        let plays = widths
            .into_iter()
            .map(|half_width_c| Term::Play { half_width_c });
        let slow = shape.tau2_s.zip(self.tau_s).into_iter();
        let slow = slow.flat_map(|(tau2_s, bounds)| near(tau2_s, bounds));
        plays
            .chain(slow.map(|tau2_s| Term::SecondLag { tau2_s }))
            .collect()
    }
}

/// The combination of least residual, as ascending positions among `terms`, from the normal
/// equations of these terms after all other columns; with `kind` terms of each kind.
pub(crate) fn best(reduced: &Gram, terms: &[Term], kind: Kind) -> Option<Vec<usize>> {
    let is_play = |position: &usize| matches!(terms[*position], Term::Play { .. });
    let (plays, slow): (Vec<usize>, Vec<usize>) = (0..terms.len()).partition(is_play);
    let are_apart = |a: usize, b: usize| match (terms[a], terms[b]) {
        (Term::Play { half_width_c: a }, Term::Play { half_width_c: b }) => b > PLAYS_APART * a,
        _ => false,
    };
    let plays: Vec<Vec<usize>> = match kind.plays {
        0 => vec![Vec::new()],
        1 => plays.iter().map(|&play| vec![play]).collect(),
        _ => {
            let pairs = plays.iter().enumerate();
            pairs
                .flat_map(|(i, &a)| plays[i + 1..].iter().map(move |&b| [a, b]))
                .filter(|&[a, b]| are_apart(a, b))
                .map(Vec::from)
                .collect()
        }
    };
    let slow: Vec<Option<usize>> = if kind.second_lag {
        slow.into_iter().map(Some).collect()
    } else {
        vec![None]
    };
    let mut lowest = (f64::INFINITY, None);
    for plays in &plays {
        for slow in &slow {
            let positions: Vec<usize> = plays.iter().copied().chain(*slow).collect();
            let part = reduced.only(&positions);
            let cost = log_likelihood(&part, part.observations());
            if cost < lowest.0 {
                lowest = (cost, Some(positions));
            }
        }
    }
    lowest.1
}
