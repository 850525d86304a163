//! Chooses the model by what it does on soaks and ramps it was not fitted to.

use tempco::{TableError, Terms, ThermalSettings};
use tempco_set::{Candidate, HeldOutErrors, Model, Place, Segmentation, Selection};

use crate::least_squares::{AxisTerms, Basis, Blocks, RFactor, RateForm, SparseRow};
use crate::method::{Method, SegmentModel};
use crate::segments::solve::{LEAST_SHARE, SENSOR_NOISE_C};
use crate::spline::breakpoints::{Layout, MOST_SEGMENTS};
use crate::spline::candidate::{Choice, Chosen, Spline, Tried};
use crate::spline::cross_validation::HeldOut;
use crate::spline::folds::{Folds, LEAST_FOLDS};
use crate::spline::history_terms::{Shape, block_history};
use crate::spline::lag_search::Search;
use crate::spline::regressors::{FixedLag, Lag, Regressors};
use crate::summary::ChannelData;

/// Segments of the basis with which the lag is searched.
const SEARCH_SEGMENTS: usize = 8;

/// The narrowest segment that is tried \[degC\].
const LEAST_WIDTH_C: f64 = 4.0;

/// What may be chosen from.
pub(crate) struct Question<'a> {
    pub(crate) data: &'a ChannelData<'a>,
    pub(crate) blocks: &'a Blocks,
    pub(crate) settings: ThermalSettings,
    pub(crate) fixed: FixedLag,
    pub(crate) method: &'a Method,
}

/// The models of segments that are fitted by themselves.
const SEGMENT_MODELS: [SegmentModel; 2] = [SegmentModel::Static, SegmentModel::Composite];

impl Question<'_> {
    /// Tries all candidates and takes the simplest within one standard error of the best. None where
    /// no model can be fitted without a part of the data.
    pub(crate) fn answer(&self) -> Result<Option<(Choice, Selection, HeldOut)>, TableError> {
        let base = self.base()?;
        let folds = Folds::new(self.blocks, base.rates());
        let mut tried = Vec::new();
        if matches!(self.method, Method::Auto { .. }) {
            self.try_segments(&base, &folds, &mut tried);
        }
        self.try_splines(&base, &folds, &mut tried)?;
        let best = tried
            .iter()
            .min_by(|a, b| a.held_out.score().total_cmp(&b.held_out.score()))
            .map(|best| best.held_out.clone());
        let Some(best) = best else {
            return Ok(None);
        };
        compare(&mut tried, &best);
        let chosen = tried
            .iter()
            .enumerate()
            .filter(|(_, t)| t.candidate.excess <= t.candidate.excess_sigma)
            .min_by_key(|(_, t)| t.candidate.columns)
            .map_or(0, |(position, _)| position);
        let mut chosen = tried.remove(chosen);
        if self.method.search().history
            && let Some(with_history) = self.with_history(&folds, &chosen, &tried)?
        {
            tried.push(std::mem::replace(&mut chosen, with_history));
            compare(&mut tried, &chosen.held_out);
        }
        self.drop_rates_that_do_not_help(&folds, &mut chosen)?;
        let selection = Selection {
            soaks_and_ramps: folds.soaks_and_ramps,
            folds: folds.count,
            ramp_rates_c_per_min: folds.ramp_rates,
            chosen: chosen.candidate,
            others: tried.into_iter().map(|of| of.candidate).collect(),
        };
        Ok(Some((chosen.choice, selection, chosen.held_out)))
    }

    fn base(&self) -> Result<Regressors<'_>, TableError> {
        self.regressors(self.settings.tau_s.into())
    }

    /// Held-out errors of what a fit is to be compared with, and of the `chosen` one. Where a model
    /// was to be chosen, its terms are left out on axes on which a constant does as well.
    pub(crate) fn comparison(
        &self,
        segmentation: &Segmentation,
        chosen: Chosen,
    ) -> Result<Vec<HeldOutErrors>, TableError> {
        let base = self.base()?;
        let folds = Folds::new(self.blocks, base.rates());
        let none = HeldOut::none(self.blocks, &folds);
        let cubic = HeldOut::cubic(self.blocks, &folds);
        let [fixed, composite] = self.of_segments(&base, &folds, segmentation);
        let is_free = matches!(chosen, Chosen::HeldOut(_));
        let chosen = match chosen {
            Chosen::HeldOut(held_out) => Some(held_out),
            Chosen::Segments(SegmentModel::Static) => fixed.clone(),
            Chosen::Segments(SegmentModel::Composite) => composite.clone(),
        };
        let rmse = |held_out: &Option<HeldOut>, axis: usize| {
            let held_out = held_out.as_ref()?;
            Some(held_out.mean_square(axis).sqrt())
        };
        let of_axis = |axis: usize| {
            let constant = none.mean_square(axis).sqrt();
            let chosen_rmse = rmse(&chosen, axis);
            let left_out = chosen_rmse.filter(|chosen| is_free && *chosen >= constant);
            let excess = chosen.as_ref().map(|of| of.excess(&none, &[axis]));
            HeldOutErrors {
                soaks_and_ramps: folds.soaks_and_ramps,
                folds: folds.count,
                none: constant,
                cubic: rmse(&cubic, axis),
                static_model: rmse(&fixed, axis),
                composite: rmse(&composite, axis),
                chosen: left_out.map_or(chosen_rmse, |_| Some(constant)),
                excess_sigma: excess
                    .map(|(_, sigma)| sigma)
                    .filter(|sigma| left_out.is_none() && sigma.is_finite()),
                left_out,
            }
        };
        Ok((0..self.blocks.axes()).map(of_axis).collect())
    }

    /// The static and the composite model.
    fn of_segments(
        &self,
        base: &Regressors,
        folds: &Folds,
        segmentation: &Segmentation,
    ) -> [Option<HeldOut>; 2] {
        let terms = SEGMENT_MODELS.map(|model| Model::from(model).terms());
        let form = (self.settings.kappa.into(), terms);
        let overlap = self.method.overlap_of_segments();
        HeldOut::segments(self.blocks, folds, base, form, segmentation, overlap)
    }

    pub(super) fn regressors(&self, tau_s: f64) -> Result<Regressors<'_>, TableError> {
        Regressors::new(self.blocks, self.data, &self.settings, tau_s)
    }

    /// An axis keeps its rate terms only if they lower its held-out error by more than one
    /// standard error.
    fn drop_rates_that_do_not_help(
        &self,
        folds: &Folds,
        chosen: &mut Tried,
    ) -> Result<(), TableError> {
        let Choice::Spline(spline) = &mut chosen.choice else {
            return Ok(());
        };
        if spline.rate == RateForm::None {
            return Ok(());
        }
        let (lag, terms) = (spline.lag, spline.shape.terms());
        let regressors = self.regressors(lag.tau_s)?;
        let history = block_history(self.blocks, &regressors, lag.kappa, &terms);
        let basis = self.basis(&regressors, lag.kappa, (&spline.layout, RateForm::None));
        let held_out = basis.and_then(|basis| {
            let basis = basis.with_history(terms.len());
            HeldOut::spline(self.blocks, folds, &regressors, lag.kappa, &basis, &history)
        });
        let Some(without) = held_out else {
            return Ok(());
        };
        for (axis, with) in spline.axes.iter_mut().enumerate() {
            let (excess, sigma) = without.excess(&chosen.held_out, &[axis]);
            with.rate = excess > sigma;
            if !with.rate {
                chosen.held_out.squares[axis].clone_from(&without.squares[axis]);
                chosen.candidate.rmse[axis] = without.mean_square(axis).sqrt();
            }
        }
        Ok(())
    }

    /// The basis of a layout over the lag-compensated temperatures of a lag.
    pub(super) fn basis(
        &self,
        regressors: &Regressors,
        kappa: f64,
        (layout, rate): (&Layout, RateForm),
    ) -> Option<Basis> {
        let mut sorted_c = self.blocks.temp_c.clone();
        sorted_c.sort_by(f64::total_cmp);
        let logs = self.blocks.logs();
        layout.basis(regressors.range_c(kappa), &sorted_c, rate, logs)
    }

    fn try_segments(&self, base: &Regressors, folds: &Folds, tried: &mut Vec<Tried>) {
        let range_c = base.range_c(self.settings.kappa.into());
        let divisions: Vec<Segmentation> = match self.method.segmentation() {
            Some(given) => vec![given.clone()],
            None => (1..=4)
                .filter_map(|count| Segmentation::of(count, range_c.0, range_c.1).ok())
                .collect(),
        };
        for segmentation in divisions {
            let tried_here = self.of_segments(base, folds, &segmentation);
            for (segment_model, held_out) in SEGMENT_MODELS.into_iter().zip(tried_here) {
                let Some(held_out) = held_out else { continue };
                let model = Model::from(segment_model);
                if segment_model == SegmentModel::Composite && folds.soaks_and_ramps < LEAST_FOLDS {
                    continue;
                }
                let kappa = f64::from(self.settings.kappa);
                let segments = segmentation.segments().len();
                let place = match self.method.segmentation() {
                    Some(_) => Place::Given,
                    None => Place::Uniform,
                };
                let columns = segments * model.terms();
                let rate_columns = segments * (model.terms() - Terms::STATIC);
                let lag = Lag {
                    tau_s: base.tau_s(),
                    kappa,
                };
                tried.push(Tried {
                    candidate: candidate(
                        model,
                        segments,
                        place,
                        (columns, rate_columns),
                        lag,
                        &held_out,
                    ),
                    held_out,
                    choice: Choice::Segments {
                        model: segment_model,
                        segmentation: segmentation.clone(),
                    },
                });
            }
        }
    }

    fn try_splines(
        &self,
        base: &Regressors,
        folds: &Folds,
        tried: &mut Vec<Tried>,
    ) -> Result<(), TableError> {
        // How fine a spline the range of temperature allows, and whether the rates allow more than
        // a static one.
        let mut sorted_c = self.blocks.temp_c.clone();
        sorted_c.sort_by(f64::total_cmp);
        let logs = self.blocks.logs();
        let (low, high) = base.range_c(0.0);
        let most = (((high - low) / LEAST_WIDTH_C) as usize).clamp(1, MOST_SEGMENTS);
        let start = Layout::uniform(SEARCH_SEGMENTS.min(most));
        let with_rates = folds.soaks_and_ramps >= LEAST_FOLDS
            && self.rates_are_separable(base, &start, &sorted_c);
        let none = Lag {
            tau_s: base.tau_s(),
            kappa: self.fixed.kappa.unwrap_or(0.0),
        };
        // Layouts: as given, else all numbers of segments, of equal width or of equal data.
        let uniform = (1..=most).map(Layout::uniform);
        let quantile = (2..=most).map(|segments| Layout::Rule {
            place: Place::Quantile,
            segments,
        });
        let (uniform, all): (Vec<Layout>, Vec<Layout>) = match self.method.segmentation() {
            Some(given) => (vec![Layout::given(given)], vec![Layout::given(given)]),
            None => (uniform.clone().collect(), uniform.chain(quantile).collect()),
        };
        // A static spline is always tried. Rate terms are tried at the best lag, and without shift.
        let mut lags = vec![(none, &uniform, vec![RateForm::None])];
        if with_rates {
            let basis = |range_c| {
                start
                    .basis(range_c, &sorted_c, RateForm::Line, logs)
                    .expect("uniform breakpoints ascend")
            };
            let search = Search {
                data: self.data,
                blocks: self.blocks,
                settings: &self.settings,
                fixed: self.fixed,
                layout: &basis,
                shape: &Shape::default(),
            };
            let found = search.everywhere()?;
            lags.push((found.best, &all, vec![RateForm::Line, RateForm::Hats]));
            if self.fixed.kappa.is_none() {
                lags.push((found.unshifted, &uniform, vec![RateForm::Line]));
            }
        }
        // Every combination is judged on the soaks and ramps that it was not fitted to.
        for (lag, layouts, forms) in lags {
            let regressors = self.regressors(lag.tau_s)?;
            let range_c = regressors.range_c(lag.kappa);
            for layout in layouts {
                for &rate in &forms {
                    let Some(basis) = layout.basis(range_c, &sorted_c, rate, logs) else {
                        continue;
                    };
                    let held_out =
                        HeldOut::spline(self.blocks, folds, &regressors, lag.kappa, &basis, &[]);
                    let Some(held_out) = held_out else { continue };
                    let columns = basis.static_columns() + basis.rate_columns();
                    let columns = (columns, basis.rate_columns());
                    tried.push(Tried {
                        candidate: candidate(
                            Model::Spline,
                            basis.segments(),
                            layout.place(),
                            columns,
                            lag,
                            &held_out,
                        ),
                        held_out,
                        choice: Choice::Spline(Spline {
                            layout: layout.clone(),
                            rate,
                            lag,
                            shape: Shape::default(),
                            axes: vec![
                                AxisTerms {
                                    rate: rate != RateForm::None,
                                    history: false,
                                };
                                self.blocks.axes()
                            ],
                        }),
                    });
                }
            }
        }
        Ok(())
    }

    /// Whether the rate moves enough by itself, as in the fit of a segment.
    fn rates_are_separable(&self, base: &Regressors, layout: &Layout, sorted_c: &[f64]) -> bool {
        let logs = self.blocks.logs();
        let Some(basis) = layout.basis(base.range_c(0.0), sorted_c, RateForm::Line, logs) else {
            return false;
        };
        let mut factor = RFactor::new(basis.columns(), 0);
        let mut row = SparseRow::new();
        for (i, block) in self.blocks.blocks.iter().enumerate() {
            basis.row(
                block.log,
                base.effective_c(i, 0.0),
                base.rates()[i],
                &mut row,
            );
            let mut dense = vec![0.0; basis.columns()];
            for &(column, value) in &row {
                dense[column] = value;
            }
            factor.push(dense);
        }
        let rate = factor.independence()[basis.columns_without_rate()];
        rate.independent >= LEAST_SHARE * rate.whole
            && rate.independent >= SENSOR_NOISE_C / (base.tau_s() / 60.0)
    }
}

/// Says how much worse each candidate is than the best one, and sorts them by that.
fn compare(tried: &mut [Tried], best: &HeldOut) {
    let axes: Vec<usize> = (0..best.squares.len()).collect();
    for of in &mut *tried {
        (of.candidate.excess, of.candidate.excess_sigma) = of.held_out.excess(best, &axes);
    }
    tried.sort_by(|a, b| a.candidate.excess.total_cmp(&b.candidate.excess));
}

fn candidate(
    model: Model,
    segments: usize,
    place: Place,
    (columns, rate_columns): (usize, usize),
    lag: Lag,
    held_out: &HeldOut,
) -> Candidate {
    Candidate {
        model,
        segments,
        place,
        rate_columns,
        columns,
        tau_s: lag.tau_s,
        kappa: lag.kappa,
        half_widths_c: Vec::new(),
        tau2_s: None,
        rmse: (0..held_out.squares.len())
            .map(|axis| held_out.mean_square(axis).sqrt())
            .collect(),
        excess: 0.0,
        excess_sigma: 0.0,
    }
}
