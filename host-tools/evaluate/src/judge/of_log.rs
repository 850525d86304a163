//! What a log that a set was evaluated on says of it, or the sign-off that was made of one.

use tempco_set::{Judgement, Rejection, RejectionCode, SignOff, Warning, WarningCode, build};

use super::merit::{Merit, no_better_than_none};
use super::of_signals;
use crate::evaluation::{AxisEvaluation, Evaluation};
use crate::text::percent;

/// Correlation of what remains with temperature or rate beyond which a quarter of it follows them.
const LARGE_CORRELATION: f64 = 0.5;

/// Rows with a flag in their status, as a share, that are worth a warning.
const MANY_ROWS: f64 = 0.01;

/// The judgement of a log, as it is kept in a set.
pub fn sign_off(evaluation: &Evaluation) -> SignOff {
    let is_worse = |of: &Rejection| of.code == RejectionCode::NoBetterThanNone;
    let (worse, rejections): (Vec<_>, Vec<_>) =
        rejections(evaluation).into_iter().partition(is_worse);
    let worse_axes: Vec<String> = worse.into_iter().filter_map(|of| of.axis).collect();
    SignOff {
        file: evaluation.log.file.clone(),
        sha256: evaluation.log.sha256.clone(),
        judged: build::now(),
        tau_s: evaluation.tau_s,
        accepted: worse_axes.is_empty() && rejections.is_empty(),
        worse_axes,
        rejections,
        warnings: warnings(evaluation),
    }
}

pub(super) fn judge_sign_off(last: &SignOff, judgement: &mut Judgement) {
    judgement.rejections.extend_from_slice(&last.rejections);
    if !last.accepted {
        let found = format!(
            "compensation does not help on {}, as signed off at {}",
            last.file, last.judged
        );
        let of_axis =
            |axis: &String| Rejection::of_axis(RejectionCode::NoBetterThanNone, axis, &found);
        judgement
            .rejections
            .extend(last.worse_axes.iter().map(of_axis));
        // A sign-off that gives no reason rejects all the same.
        if last.worse_axes.is_empty() && last.rejections.is_empty() {
            judgement.rejections.push(Rejection {
                code: RejectionCode::NoBetterThanNone,
                axis: None,
                message: found,
            });
        }
    }
    judgement.warnings.extend_from_slice(&last.warnings);
}

/// What is wrong with the signals of the log.
fn reasons_of_signals(evaluation: &Evaluation) -> (Vec<Rejection>, Vec<Warning>) {
    let is_axis = |column: &str| evaluation.axes.iter().any(|of| of.axis == column);
    let log = &evaluation.log;
    of_signals::reasons(&log.file, &log.findings, is_axis)
}

/// Why the log rejects the set: signals, and axes that show no improvement.
pub(super) fn rejections(evaluation: &Evaluation) -> Vec<Rejection> {
    let axes = evaluation.axes.iter();
    let rejection = |axis: &AxisEvaluation| {
        let merits = [
            Merit::bias_stability(axis.sigma_raw, axis.sigma_compensated),
            Merit::rms_error(axis.rmse_raw, axis.rmse_compensated),
        ];
        no_better_than_none(&axis.axis, merits, &evaluation.log.file)
    };
    let (rejections, _) = reasons_of_signals(evaluation);
    rejections
        .into_iter()
        .chain(axes.filter_map(rejection))
        .collect()
}

/// What the log warns of.
pub(super) fn warnings(evaluation: &Evaluation) -> Vec<Warning> {
    let (_, mut warnings) = reasons_of_signals(evaluation);
    for axis in &evaluation.axes {
        warn_of_residuals(axis, evaluation, &mut warnings);
    }
    for (flag, rows) in &evaluation.status_rows {
        let share = *rows as f64 / evaluation.log.rows as f64;
        if share > MANY_ROWS && *flag != "settling" {
            warnings.push(Warning::new(
                WarningCode::FlaggedRows,
                format!(
                    "{:.1} % of the rows of {} have the status {flag}",
                    100.0 * share,
                    evaluation.log.file
                ),
            ));
        }
    }
    warnings
}

fn warn_of_residuals(axis: &AxisEvaluation, evaluation: &Evaluation, warnings: &mut Vec<Warning>) {
    let mut warn = |code, found: String| warnings.push(Warning::of_axis(code, &axis.axis, found));
    let file = &evaluation.log.file;
    if let Some(r) = axis.correlation_compensated.figure() {
        use WarningCode::{ResidualFollowsRate, ResidualFollowsTemperature};
        let correlations = [
            (ResidualFollowsTemperature, "the temperature", r.temperature),
            (ResidualFollowsRate, "its rate", r.rate),
        ];
        for (code, what, r) in correlations {
            if r.abs() > LARGE_CORRELATION {
                let found = format!("what remains on {file} follows {what} (r = {r:+.2})");
                warn(code, found);
            }
        }
    }
    let mut taus = axis.bias_stability.iter();
    let at_tau = taus.find(|at| at.tau_s == evaluation.tau_s);
    let over = at_tau.and_then(|at| at.sigma.figure()?.improvement_over_reference);
    if let Some(over) = over.filter(|over| *over < 0.0) {
        let found = format!(
            "{} does better on {file} ({})",
            evaluation.reference,
            percent(over)
        );
        warn(WarningCode::ReferenceBetter, found);
    }
}
