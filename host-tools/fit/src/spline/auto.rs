//! The default model of a channel: which terms the logs allow, its search, and what it is compared
//! with.

use tempco::{TableError, ThermalSettings};
use tempco_set::{
    Candidate, HeldOutErrors, Model, Place, Segmentation, Selection, SimplerModel, Surpassed,
};

use crate::channel_fit::ChannelFit;
use crate::error::FitError;
use crate::least_squares::Blocks;
use crate::method::{LagSearch, Method, SegmentModel};
use crate::spline::folds::Folds;
use crate::spline::held_out::{HeldOut, SegmentRegressors};
use crate::spline::lags::{Form, HALF_WIDTHS_C, Lags, whole_hats};
use crate::spline::regressors::Paths;
use crate::spline::search::Problem;
use crate::spline::sensor_noise::sensor_noise;
use crate::spline::start::Start;
use crate::spline::{drift, fit};
use crate::summary::ChannelData;

/// The most cells of the curve, and the narrowest \[degC\].
const MOST_CELLS: usize = 20;
const LEAST_WIDTH_C: f64 = 4.0;

/// Time constants that are tried \[s\]; a filter must also see several rows per time constant.
const TAU_S: (f64, f64) = (10.0, 2400.0);
const LEAST_ROWS: f64 = 4.0;

/// How many times as long the second time constant is: nearer ones would do the same work.
const APART: (f64, f64) = (2.5, 400.0);

/// The longest time constant that the core takes, and a little less \[s\].
const MOST_TAU2_S: f64 = 50_000.0;

/// A log is this many times as long as its longest time constant.
const LEAST_LOG: f64 = 4.0;

/// Shares of the lags that are tried. The core takes no negative share of the first in `u`.
const KAPPA: (f64, f64) = (0.0, 1.5);
const OTHER_SHARES: (f64, f64) = (-2.0, 2.0);

/// With fewer soaks and ramps no temperature was passed twice at two rates, and what the rate does
/// is not known: with ramps of several rates, and with ramps of one.
const LEAST_PARTS: usize = 3;
const LEAST_PARTS_OF_ONE_RATE: usize = 4;

/// A play takes temperatures over this many half widths.
const LEAST_WIDTHS: f64 = 3.0;

/// A smaller share of the bias is no difference between models.
const LEAST_SHARE: f64 = 1e-4;

/// What a fit of a channel may use.
pub(crate) struct Question<'a> {
    pub(crate) data: &'a ChannelData<'a>,
    pub(crate) blocks: &'a Blocks,
    pub(crate) settings: ThermalSettings,
    pub(crate) method: &'a Method,
}

/// The models of segments that are fitted by themselves.
const SEGMENT_MODELS: [SegmentModel; 2] = [SegmentModel::Static, SegmentModel::Composite];

/// The model that was fitted.
pub(crate) enum Chosen {
    /// One of the paper's.
    Segments(SegmentModel),
    /// The default one, with its errors.
    HeldOut(HeldOut),
}

/// A model with what it is judged by.
pub(crate) struct Answer {
    pub(crate) fit: ChannelFit,
    pub(crate) held_out: HeldOut,
    pub(crate) chosen: Candidate,
}

impl Question<'_> {
    /// Fits the default model. `None` where the logs are too short for any.
    pub(crate) fn answer(
        &self,
        search: LagSearch,
        folds: &Folds,
    ) -> Result<Option<Answer>, FitError> {
        let (data, blocks) = (self.data, self.blocks);
        let form = self.form(folds);
        let paths = Paths::new(data, blocks, self.settings);
        let (limits, sensor) = (drift::limits(blocks), sensor_noise(blocks));
        let problem = Problem {
            paths: &paths,
            form,
            sensor: &sensor,
            limits: &limits,
            most_tau2_s: (blocks.longest_log_s() / LEAST_LOG).min(MOST_TAU2_S),
            bounds: self.bounds(&form, search),
        };
        let found = problem.search().map_err(FitError::Settings)?;
        let Some(found) = found else {
            return Ok(None);
        };
        let lags = found.lags;
        let points = paths.points(&form, &lags).map_err(FitError::Settings)?;
        let start = Start::new(&blocks.blocks, &blocks.temp_c, &points, &lags);
        let thermal = start.settings(form.settings(&lags, self.settings));
        let spread = problem.spread(&found).map_err(FitError::Settings)?;
        let (fit, deployed) = fit::fit((data, blocks, &sensor), thermal, &form, (found, &spread))?;
        let Some(held_out) = deployed.held_out(blocks, folds) else {
            return Ok(None);
        };
        let widths = HALF_WIDTHS_C[..form.plays].to_vec();
        let chosen = Candidate {
            model: Model::Spline,
            segments: fit.segments.len(),
            place: Place::Uniform,
            rate_columns: deployed.basis.rate_columns(),
            columns: deployed.basis.columns(),
            tau_s: lags.tau_s,
            kappa: lags.kappa,
            half_widths_c: widths,
            tau2_s: form.lag2.then_some(lags.tau2_s),
            kappa2: lags.kappa2,
            play_kappa: lags.play_kappa,
            play_kappa2: lags.play_kappa2,
            rmse: Vec::new(),
            excess: 0.0,
            excess_sigma: 0.0,
        };
        Ok(Some(Answer {
            fit,
            held_out,
            chosen,
        }))
    }

    /// Which terms the logs allow.
    fn form(&self, folds: &Folds) -> Form {
        let (low, high) = Blocks::range(&self.blocks.temp_c);
        let span_c = high - low;
        // With one rate, a loop and a lag look the same.
        let several = folds.ramp_rates.len() >= Selection::LEAST_RATES;
        let least = match several {
            true => LEAST_PARTS,
            false => LEAST_PARTS_OF_ONE_RATE,
        };
        let rates = folds.soaks_and_ramps >= least;
        let plays = HALF_WIDTHS_C.iter();
        let plays = plays.filter(|&&width_c| span_c > LEAST_WIDTHS * width_c);
        Form {
            cells: whole_hats(((span_c / LEAST_WIDTH_C) as usize).clamp(1, MOST_CELLS)),
            rates,
            lag2: rates && several,
            plays: if rates && several { plays.count() } else { 0 },
        }
    }

    /// Where the search may go.
    fn bounds(&self, form: &Form, search: LagSearch) -> [(f64, f64); Lags::COUNT] {
        let settings = &self.settings;
        let intervals = self.data.logs.iter().map(|log| log.interval_s);
        let least = (LEAST_ROWS * intervals.fold(0.0, f64::max)).clamp(TAU_S.0, TAU_S.1);
        let fixed = |value: f64| (value, value);
        let given = |of: bool, range: (f64, f64), value: f32| {
            if of { range } else { fixed(value.into()) }
        };
        let tau = given(search.tau && form.rates, (least, TAU_S.1), settings.tau_s);
        let kappa = given(search.kappa && form.rates, KAPPA, settings.kappa);
        let only = |of: bool, range: (f64, f64)| if of { range } else { fixed(0.0) };
        let has_plays = form.plays > 0;
        let apart = match form.lag2 {
            true => APART,
            false => fixed(f64::from(settings.tau2_s) / tau.0),
        };
        let ln = |(low, high): (f64, f64)| (libm::log(low), libm::log(high));
        [
            ln(tau),
            ln(apart),
            kappa,
            only(form.lag2, OTHER_SHARES),
            only(has_plays, OTHER_SHARES),
            only(has_plays && form.lag2, OTHER_SHARES),
        ]
    }

    /// The soaks and ramps.
    pub(crate) fn folds(&self) -> Folds {
        Folds::new(self.blocks, &self.blocks.slow_rates())
    }

    /// What the paper's models see.
    fn base(&self) -> Result<SegmentRegressors, TableError> {
        let tau_s = f64::from(self.settings.tau_s);
        let rates = self.blocks.rates(self.data, &self.settings, tau_s)?;
        Ok(SegmentRegressors {
            rates,
            tau_s,
            kappa: self.settings.kappa.into(),
        })
    }

    /// Held-out errors of what a fit is to be compared with, and of the chosen one: the default
    /// model's, else one of the paper's. Terms of the default model are left out on axes on which
    /// a constant does as well.
    pub(crate) fn comparison(
        &self,
        segmentation: &Segmentation,
        folds: &Folds,
        chosen: Chosen,
    ) -> Result<Vec<HeldOutErrors>, TableError> {
        let (blocks, base) = (self.blocks, self.base()?);
        let none = HeldOut::none(blocks, folds);
        let cubic = HeldOut::cubic(blocks, folds);
        let terms = SEGMENT_MODELS.map(|model| Model::from(model).terms());
        let overlap = self.method.overlap_of_segments();
        let of_segments = HeldOut::segments(blocks, folds, &base, terms, segmentation, overlap);
        let [fixed, composite] = of_segments;
        let (is_free, chosen) = match chosen {
            Chosen::HeldOut(held_out) => (true, Some(held_out)),
            Chosen::Segments(SegmentModel::Static) => (false, fixed.clone()),
            Chosen::Segments(SegmentModel::Composite) => (false, composite.clone()),
        };
        // Every model has the same white noise; without it they can be compared.
        let white = chosen.as_ref().unwrap_or(&none).white().to_vec();
        let [cubic, fixed, composite, chosen] = [cubic, fixed, composite, chosen]
            .map(|of: Option<HeldOut>| of.map(|of| of.without(&white)));
        let none = none.without(&white);
        let others = [
            (SimplerModel::Cubic, &cubic),
            (SimplerModel::Static, &fixed),
            (SimplerModel::Composite, &composite),
        ];
        let rmse = |of: &HeldOut, axis: usize| of.mean_square(axis).sqrt();
        let of_axis = |axis: usize| {
            let constant = none.mean_square(axis);
            let chosen_square = chosen.as_ref().map(|of| of.mean_square(axis));
            let left_out = chosen_square.filter(|square| is_free && *square >= constant);
            let excess = chosen.as_ref().map(|of| of.excess(&none, axis, constant));
            // The simpler model that does best, if by more than one standard error.
            let surpassed = others.iter().filter_map(|(by, other)| {
                let (chosen, other) = (chosen.as_ref()?, other.as_ref()?);
                // One that leaves nothing is compared with what there was.
                let whole = other.mean_square(axis).max(LEAST_SHARE * constant);
                let (excess, sigma) = chosen.excess(other, axis, whole);
                (excess > sigma && sigma.is_finite()).then_some(Surpassed {
                    by: *by,
                    rmse: other.mean_square(axis).sqrt(),
                    excess,
                    excess_sigma: sigma,
                })
            });
            let surpassed = surpassed.min_by(|a, b| a.rmse.total_cmp(&b.rmse));
            HeldOutErrors {
                soaks_and_ramps: folds.soaks_and_ramps,
                folds: folds.count,
                none: constant.sqrt(),
                cubic: cubic.as_ref().map(|of| rmse(of, axis)),
                static_model: fixed.as_ref().map(|of| rmse(of, axis)),
                composite: composite.as_ref().map(|of| rmse(of, axis)),
                chosen: match left_out {
                    Some(_) => Some(constant.sqrt()),
                    None => chosen_square.map(f64::sqrt),
                },
                excess_sigma: excess
                    .map(|(_, sigma)| sigma)
                    .filter(|sigma| left_out.is_none() && sigma.is_finite()),
                left_out: left_out.map(f64::sqrt),
                surpassed: surpassed.filter(|_| left_out.is_none()),
            }
        };
        Ok((0..blocks.axes()).map(of_axis).collect())
    }
}
