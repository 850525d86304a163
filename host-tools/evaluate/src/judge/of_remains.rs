//! What a model leaves of an axis: where it was not fitted, and beyond the noise of rows.

use tempco_set::{
    AxisSet, ChannelSet, Rejection, RejectionCode, SimplerModel, Surpassed, Warning, WarningCode,
};

use crate::text::figure;

/// A model that does better by this share on what was left out is worth a warning, if it is not by
/// chance ...
const CLEARLY_BETTER: f64 = 0.05;

/// ... and the difference is this share of the error without compensation.
const WORTH_IT: f64 = 0.01;

/// Terms whose error is so many times the error of a constant do harm.
const CLEARLY_WORSE: f64 = 1.25;

/// What remains of means is far above the noise of rows beyond this factor ...
const FAR_ABOVE_NOISE: f64 = 10.0;

/// ... and it is much if it is more than this share of what there was.
const MUCH_LEFT: f64 = 0.3;

/// The least variance of rows about their means, as a share of the variance of rows.
const LEAST_NOISE: f64 = 1e-4;

/// Terms that do harm, by more than one standard error, where they were not fitted. Terms that do
/// nothing are a little worse than a constant too: they are fitted to noise.
pub(super) fn worse(axis: &AxisSet) -> Option<Rejection> {
    let errors = axis.held_out?;
    let (excess, sigma) = (errors.excess()?, errors.excess_sigma?);
    let is_clear = errors.chosen? >= CLEARLY_WORSE * errors.none;
    (is_clear && excess > sigma).then(|| {
        Rejection::of_axis(
            RejectionCode::HeldOutWorse,
            &axis.name,
            format_args!(
                "on soaks and ramps left out of the fit, the model is worse than a constant ({} \
                 against {} {}), by {:.1} standard errors",
                figure(errors.chosen.unwrap_or_default()),
                figure(errors.none),
                axis.unit,
                excess / sigma
            ),
        )
    })
}

/// What the held-out errors warn of.
pub(super) fn held_out(axis: &AxisSet) -> Option<Warning> {
    let errors = axis.held_out?;
    if let Some(left_out) = errors.left_out {
        return Some(Warning::of_axis(
            WarningCode::ConstantAlone,
            &axis.name,
            format_args!(
                "on soaks and ramps left out of the fit, terms of temperature are not better than a \
                 constant ({} against {} {}). It keeps the constant alone",
                figure(left_out),
                figure(errors.none),
                axis.unit
            ),
        ));
    }
    let chosen = errors.chosen?;
    if worse(axis).is_some() {
        return None;
    }
    if chosen >= errors.none {
        return Some(Warning::of_axis(
            WarningCode::HeldOutNoBetter,
            &axis.name,
            "on soaks and ramps left out of the fit, the model does not help",
        ));
    }
    let least = (CLEARLY_BETTER * chosen).max(WORTH_IT * errors.none);
    let is_clear = |better: &Surpassed| chosen - better.rmse > least;
    let better = errors.surpassed.filter(is_clear)?;
    let (name, advice) = match better.by {
        SimplerModel::Cubic => ("one cubic in T", "calibrate with more soaks and ramps"),
        SimplerModel::Static => ("the static model", "fit `--model static`"),
        SimplerModel::Composite => ("the composite model", "fit `--model composite`"),
    };
    Some(Warning::of_axis(
        WarningCode::SimplerModelBetter,
        &axis.name,
        format_args!(
            "on soaks and ramps left out of the fit, {name} does better ({} against {} {}), by \
             {:.1} standard errors; {advice}",
            figure(better.rmse),
            figure(chosen),
            axis.unit,
            better.excess / better.excess_sigma
        ),
    ))
}

/// What the model leaves of an axis, where it is far above what the noise of rows leaves of their
/// means, and much of what there was. What is known to be disturbed is said elsewhere.
pub(super) fn above_noise(channel: &ChannelSet, axis: &AxisSet) -> Option<Warning> {
    let of = axis.statistics.filter(|of| of.n > 1)?;
    let disturbed = channel.outliers.iter().flat_map(|of| &of.disturbances);
    if disturbed.into_iter().any(|of| of.axis == axis.name) {
        return None;
    }
    // The noise of rows is what their means do not show. As a difference it has a least size.
    let rows_per_mean = of.rows as f64 / of.n as f64;
    let variance = of.rmse_compensated.powi(2);
    let noise = (variance - of.sigma_compensated.powi(2)).max(LEAST_NOISE * variance);
    let ratio = of.sigma_compensated / (noise / rows_per_mean).sqrt();
    let share = of.sigma_compensated / of.sigma_raw;
    (ratio > FAR_ABOVE_NOISE && share > MUCH_LEFT).then(|| {
        Warning::of_axis(
            WarningCode::ResidualAboveNoise,
            &axis.name,
            format_args!(
                "means over {} s keep {} {} of {}, {ratio:.0} times what the noise of their rows \
                 explains",
                of.tau_s,
                figure(of.sigma_compensated),
                axis.unit,
                figure(of.sigma_raw)
            ),
        )
    })
}
