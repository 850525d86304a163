//! Selects history terms by cross-validation over soaks and ramps.

use tempco::TableError;
use tempco_set::Selection;

use crate::least_squares::{Basis, Gram, RateForm};
use crate::spline::breakpoints::Layout;
use crate::spline::candidate::{Choice, Spline, Tried};
use crate::spline::cross_validation::HeldOut;
use crate::spline::folds::Folds;
use crate::spline::history_search::{Bounds, Kind, REFINEMENTS, best};
use crate::spline::history_terms::{Shape, Term, block_history, sort};
use crate::spline::lag_search::Search;
use crate::spline::model_selection::Question;
use crate::spline::regressors::{Lag, Regressors};

impl Question<'_> {
    /// The `chosen` model, or the best spline of the `others` where it has no rate terms, with the
    /// history terms that help: the fewest within one standard error of the best, and only if the
    /// error of `chosen` is more than one standard error above. None where there are none.
    pub(super) fn with_history(
        &self,
        folds: &Folds,
        chosen: &Tried,
        others: &[Tried],
    ) -> Result<Option<Tried>, TableError> {
        if folds.ramp_rates.len() < Selection::LEAST_RATES {
            return Ok(None);
        }
        let has_rate = |tried: &&Tried| matches!(&tried.choice, Choice::Spline(spline) if spline.rate != RateForm::None);
        // The others are sorted, best first.
        let Some(start) = std::iter::once(chosen).chain(others).find(has_rate) else {
            return Ok(None);
        };
        let Choice::Spline(spline) = &start.choice else {
            return Ok(None);
        };
        let Some(lag) = self.lag_with_states(spline)? else {
            return Ok(None);
        };
        let regressors = self.regressors(lag.tau_s)?;
        let Some(columns) = Columns::new(self, &regressors, lag, spline) else {
            return Ok(None);
        };
        let found = self.of_each_kind(folds, start, &columns);
        let all_axes: Vec<usize> = (0..self.blocks.axes()).collect();
        let lowest = found
            .iter()
            .min_by(|a, b| a.held_out.score().total_cmp(&b.held_out.score()));
        let Some(lowest) = lowest.map(|tried| tried.held_out.clone()) else {
            return Ok(None);
        };
        let simplest = found.into_iter().find(|tried| {
            let (excess, sigma) = tried.held_out.excess(&lowest, &all_axes);
            excess <= sigma
        });
        let Some(mut earned) = simplest.filter(|tried| {
            let (excess, sigma) = chosen.held_out.excess(&tried.held_out, &all_axes);
            excess > sigma
        }) else {
            return Ok(None);
        };
        let any = self.drop_states_that_do_not_help(folds, &mut earned)?;
        Ok(any.then_some(earned))
    }

    /// An axis keeps its states only if they lower its held-out error by more than one standard
    /// error; whether any does.
    fn drop_states_that_do_not_help(
        &self,
        folds: &Folds,
        chosen: &mut Tried,
    ) -> Result<bool, TableError> {
        let Choice::Spline(spline) = &mut chosen.choice else {
            return Ok(false);
        };
        let lag = spline.lag;
        let regressors = self.regressors(lag.tau_s)?;
        let basis = self.basis(&regressors, lag.kappa, (&spline.layout, spline.rate));
        let held_out = basis.and_then(|basis| {
            HeldOut::spline(self.blocks, folds, &regressors, lag.kappa, &basis, &[])
        });
        let Some(without) = held_out else {
            return Ok(true);
        };
        for (axis, with) in spline.axes.iter_mut().enumerate() {
            let (excess, sigma) = without.excess(&chosen.held_out, &[axis]);
            with.history = excess > sigma;
            if !with.history {
                chosen.held_out.squares[axis].clone_from(&without.squares[axis]);
                chosen.candidate.rmse[axis] = without.mean_square(axis).sqrt();
            }
        }
        Ok(spline.axes.iter().any(|axis| axis.history))
    }

    /// Time constant and shift that go best with a play and a second lag: without these, they stand
    /// in for them. As they were where these are not found.
    fn lag_with_states(&self, spline: &Spline) -> Result<Option<Lag>, TableError> {
        let regressors = self.regressors(spline.lag.tau_s)?;
        let Some(columns) = Columns::new(self, &regressors, spline.lag, spline) else {
            return Ok(None);
        };
        let Some((_, shape)) = columns.shapes(&[Kind::USUAL]).pop() else {
            return Ok(Some(spline.lag));
        };
        // Quantiles of other temperatures might coincide.
        let layout = Layout::uniform(columns.basis.segments());
        let basis = |range_c| {
            layout
                .basis(range_c, &[], spline.rate, self.blocks.logs())
                .expect("uniform breakpoints ascend")
        };
        let search = Search {
            data: self.data,
            blocks: self.blocks,
            settings: &self.settings,
            fixed: self.fixed,
            layout: &basis,
            shape: &shape,
        };
        Ok(Some(search.near(spline.lag.tau_s)?))
    }

    /// The model with states of each kind that can be fitted, the simplest first.
    fn of_each_kind(&self, folds: &Folds, start: &Tried, columns: &Columns) -> Vec<Tried> {
        let shapes = columns.shapes(&Kind::ALL);
        // Without each fold the choice is from the first grid and from what was found on all data.
        let mut terms = columns.bounds.grid();
        terms.extend(shapes.iter().flat_map(|(_, shape)| shape.terms()));
        sort(&mut terms);
        let grams = columns.grams(&terms, folds);
        let leading = columns.basis.columns_without_history();
        shapes
            .into_iter()
            .filter_map(|(kind, shape)| {
                let pick = |reduced: &Gram| best(reduced, &terms, kind);
                let held_out = HeldOut::picked(self.blocks, folds, &grams, leading, pick)?;
                let mut tried = Tried {
                    held_out,
                    ..start.clone()
                };
                let Choice::Spline(spline) = &mut tried.choice else {
                    return None;
                };
                spline.lag = columns.lag;
                spline.shape = shape.clone();
                for axis in &mut spline.axes {
                    axis.history = true;
                }
                let candidate = &mut tried.candidate;
                candidate.columns += shape.terms().len();
                (candidate.tau_s, candidate.kappa) = (columns.lag.tau_s, columns.lag.kappa);
                (candidate.half_widths_c, candidate.tau2_s) = (shape.half_widths_c, shape.tau2_s);
                let axes = 0..self.blocks.axes();
                candidate.rmse = axes
                    .map(|axis| tried.held_out.mean_square(axis).sqrt())
                    .collect();
                (candidate.excess, candidate.excess_sigma) = (0.0, 0.0);
                Some(tried)
            })
            .collect()
    }
}

/// The columns of a model at one lag, to which those of terms are put.
struct Columns<'a> {
    question: &'a Question<'a>,
    regressors: &'a Regressors<'a>,
    lag: Lag,
    basis: Basis,
    bounds: Bounds,
}

impl<'a> Columns<'a> {
    fn new(
        question: &'a Question<'a>,
        regressors: &'a Regressors<'a>,
        lag: Lag,
        spline: &Spline,
    ) -> Option<Self> {
        let basis = question.basis(regressors, lag.kappa, (&spline.layout, spline.rate))?;
        let range_c = regressors.range_c(lag.kappa);
        let longest_log_s = question.blocks.longest_log_s();
        Some(Self {
            question,
            regressors,
            lag,
            basis,
            bounds: Bounds::new(range_c, lag.tau_s, longest_log_s),
        })
    }

    fn grams(&self, terms: &[Term], folds: &Folds) -> Vec<Gram> {
        let blocks = self.question.blocks;
        let states = block_history(blocks, self.regressors, self.lag.kappa, terms);
        let basis = self.basis.clone().with_history(terms.len());
        self.regressors
            .grams(blocks, folds, &basis, self.lag.kappa, &states)
    }

    /// The shape of least residual on all data, from `start`, the best of the grid; none where it
    /// lies at an end of the search.
    fn refined(&self, kind: Kind, start: Shape) -> Option<Shape> {
        let mut shape = start;
        for pass in 1..=REFINEMENTS {
            shape = self
                .best_of(&self.bounds.around(&shape, pass), &[kind])
                .pop()??;
        }
        self.bounds.encloses(&shape).then_some(shape)
    }

    /// The shapes of least residual on all data that `terms` make.
    fn best_of(&self, terms: &[Term], kinds: &[Kind]) -> Vec<Option<Shape>> {
        let whole = Folds::whole(self.question.blocks);
        let gram = &self.grams(terms, &whole)[0];
        let reduced = gram.reduced(self.basis.columns_without_history());
        let of_kind = |&kind: &Kind| {
            let found = best(reduced.as_ref()?, terms, kind)?;
            Some(Shape::of(found.into_iter().map(|position| terms[position])))
        };
        kinds.iter().map(of_kind).collect()
    }

    /// The shapes of some kinds that are found within the bounds.
    fn shapes(&self, kinds: &[Kind]) -> Vec<(Kind, Shape)> {
        let starts = self.best_of(&self.bounds.grid(), kinds);
        let found = kinds.iter().zip(starts);
        found
            .filter_map(|(&kind, start)| Some((kind, self.refined(kind, start?)?)))
            .collect()
    }
}
