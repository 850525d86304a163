//! A model fitted to logs, and the error of the bias that it applies.

use anyhow::Result;
use tempco_fit::{Fit, FitOptions, fit};
use tempco_log::Log;
use tempco_set::run::apply;
use tempco_set::{Model, RejectionCode, WarningCode};

use crate::figures::{mean, means, rms_about};
use crate::run::Run;

/// Averaging time of the error \[s\].
const TAU_S: f64 = 100.0;

/// Averaging time just after power-on \[s\].
const START_TAU_S: f64 = 10.0;

/// Minutes 1 to 10 after power-on \[s\].
const START_S: std::ops::Range<f64> = 60.0..600.0;

/// Rejections that say that a model is no better than the composite model, or none.
const REJECTIONS: [RejectionCode; 2] =
    [RejectionCode::NoBetterThanNone, RejectionCode::HeldOutWorse];

/// Warnings that say so.
const WARNINGS: [WarningCode; 3] = [
    WarningCode::HeldOutNoBetter,
    WarningCode::SimplerModelBetter,
    WarningCode::ConstantAlone,
];

/// A fitted model.
pub(crate) struct Fitted(Fit);

impl Fitted {
    /// Fits a model with its defaults, as `tempco fit` does.
    ///
    /// # Errors
    /// The errors of the fit.
    pub(crate) fn new(model: Model, logs: &[Log]) -> Result<Self> {
        Ok(Self(fit(logs, &FitOptions::new("TRIAL", model))?))
    }

    /// For each axis, rms of applied bias less true bias over a mission, as means over 100 s with
    /// the mean over the mission removed \[unit of the axis\].
    ///
    /// # Errors
    /// A set that cannot be run over the log.
    pub(crate) fn errors(&self, mission: &Run) -> Result<Vec<f64>> {
        let time_s = &mission.log.time_s;
        let rows = self.row_errors(mission)?;
        Ok(rows.iter().map(|errors| error(time_s, errors)).collect())
    }

    /// For each axis, rms of the error in minutes 1 to 10 about its mean over the later mission
    /// \[unit of the axis\].
    ///
    /// # Errors
    /// A set that cannot be run over the log.
    pub(crate) fn start_errors(&self, mission: &Run) -> Result<Vec<f64>> {
        let time_s = &mission.log.time_s;
        let rows = self.row_errors(mission)?;
        Ok(rows
            .iter()
            .map(|errors| start_error(time_s, errors))
            .collect())
    }

    /// For each axis, applied bias less true bias of each row.
    fn row_errors(&self, mission: &Run) -> Result<Vec<Vec<f64>>> {
        let applied = apply(&self.0.set, &mission.log)?;
        let axes = applied.axes.iter().zip(&mission.truth);
        let errors = axes.map(|(output, truth)| {
            let rows = output.bias.iter().zip(truth);
            rows.map(|(bias, truth)| f64::from(*bias) - truth).collect()
        });
        Ok(errors.collect())
    }

    /// For each axis, the codes by which the fit says that the model is no better than the composite
    /// model, or none.
    pub(crate) fn said(&self) -> Vec<Vec<&'static str>> {
        let judgement = self.0.judge();
        let rejections = judgement.rejections.iter();
        let rejections = rejections
            .filter(|of| REJECTIONS.contains(&of.code))
            .map(|of| (of.axis.as_deref(), of.code.name()));
        let warnings = judgement.warnings.iter();
        let warnings = warnings
            .filter(|of| WARNINGS.contains(&of.code))
            .map(|of| (of.axis.as_deref(), of.code.name()));
        let said: Vec<_> = rejections.chain(warnings).collect();
        let axes = self.0.set.channels.iter().flat_map(|channel| &channel.axes);
        let of_axis = |name: &str| {
            let of_it = said
                .iter()
                .filter(|(axis, _)| axis.is_none_or(|axis| axis == name));
            of_it.map(|(_, code)| *code).collect()
        };
        axes.map(|axis| of_axis(&axis.name)).collect()
    }

    /// What was chosen: time constants and history.
    pub(crate) fn description(&self) -> String {
        let channel = &self.0.set.channels[0];
        let Some(selection) = &channel.selection else {
            return String::new();
        };
        let of = &selection.chosen;
        format!(
            "{} segments, {} columns, tau {:.0} s, kappa {:.2}, plays {:.2?} degC, second lag {:.0?} s",
            of.segments, of.columns, of.tau_s, of.kappa, of.half_widths_c, of.tau2_s
        )
    }
}

/// Rms of means over 100 s, the mean of all removed.
pub(crate) fn error(time_s: &[f64], errors: &[f64]) -> f64 {
    let values = values(time_s, errors, TAU_S, 0.0..f64::INFINITY);
    rms_about(&values, mean(&values))
}

/// Rms of means over 10 s in minutes 1 to 10, about the mean of the time after them.
fn start_error(time_s: &[f64], errors: &[f64]) -> f64 {
    let later = values(time_s, errors, TAU_S, START_S.end..f64::INFINITY);
    rms_about(&values(time_s, errors, START_TAU_S, START_S), mean(&later))
}

/// The means that begin in a span of time since the first row \[s\].
fn values(time_s: &[f64], errors: &[f64], tau_s: f64, span_s: std::ops::Range<f64>) -> Vec<f64> {
    let means = means(time_s, errors, tau_s).into_iter();
    let inside = means.filter(|mean| span_s.contains(&mean.begin_s));
    inside.map(|mean| mean.value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time_s() -> Vec<f64> {
        (0..=7200).map(f64::from).collect()
    }

    #[test]
    fn a_perfect_bias_has_no_error_and_a_constant_one_has_none_either() {
        let time_s = time_s();
        for constant in [0.0, 0.25, -3.5] {
            let errors = vec![constant; time_s.len()];
            assert_eq!(error(&time_s, &errors), 0.0);
            assert_eq!(start_error(&time_s, &errors), 0.0);
        }
    }

    #[test]
    fn the_error_is_what_is_left_without_the_mean() {
        let time_s = time_s();
        let errors: Vec<f64> = time_s
            .iter()
            .map(|time_s| if *time_s < 3600.0 { 7.0 } else { 9.0 })
            .collect();
        assert_eq!(error(&time_s, &errors), 1.0);
    }

    #[test]
    fn noise_from_row_to_row_averages_out() {
        let time_s = time_s();
        let errors: Vec<f64> = time_s
            .iter()
            .map(|time_s| 1.0 - time_s % 2.0 * 2.0)
            .collect();
        assert_eq!(error(&time_s, &errors), 0.0);
    }

    #[test]
    fn the_start_is_minutes_1_to_10_about_what_comes_later() {
        let time_s = time_s();
        let errors: Vec<f64> = time_s
            .iter()
            .map(|time_s| match time_s {
                ..60.0 => 100.0,
                60.0..600.0 => 5.0,
                _ => 2.0,
            })
            .collect();
        assert_eq!(start_error(&time_s, &errors), 3.0);
    }
}
