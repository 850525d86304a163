//! What a log that a set was evaluated on says of it, or the sign-off that was made of one.

use tempco_set::{Judgement, Rejection, RejectionCode, SignOff, Warning, WarningCode, build};

use super::merit::{Merit, no_better_than_none};
use crate::evaluation::{AxisEvaluation, Evaluation};
use crate::text::percent;

/// Correlation of what remains with temperature or rate beyond which a quarter of it follows them.
const LARGE_CORRELATION: f64 = 0.5;

/// Rows with a flag in their status, as a share, that are worth a warning.
const MANY_ROWS: f64 = 0.01;

/// The judgement of a log, as it is kept in a set.
pub fn sign_off(evaluation: &Evaluation) -> SignOff {
    let worse = rejections(evaluation).into_iter();
    let worse_axes: Vec<String> = worse.filter_map(|rejection| rejection.axis).collect();
    SignOff {
        file: evaluation.log.file.clone(),
        sha256: evaluation.log.sha256.clone(),
        judged: build::now(),
        tau_s: evaluation.tau_s,
        accepted: worse_axes.is_empty(),
        worse_axes,
        warnings: warnings(evaluation),
    }
}

pub(super) fn judge_sign_off(last: &SignOff, judgement: &mut Judgement) {
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
        // A sign-off that names no axis rejects all the same.
        if last.worse_axes.is_empty() {
            judgement.rejections.push(Rejection {
                code: RejectionCode::NoBetterThanNone,
                axis: None,
                message: found,
            });
        }
    }
    judgement.warnings.extend_from_slice(&last.warnings);
}

/// The axes on which the log shows no improvement.
pub(super) fn rejections(evaluation: &Evaluation) -> Vec<Rejection> {
    let axes = evaluation.axes.iter();
    let rejection = |axis: &AxisEvaluation| {
        let merits = [
            Merit::bias_stability(axis.sigma_raw, axis.sigma_compensated),
            Merit::rms_error(axis.rmse_raw, axis.rmse_compensated),
        ];
        no_better_than_none(&axis.axis, merits, &evaluation.log.file)
    };
    axes.filter_map(rejection).collect()
}

/// What the log warns of.
pub(super) fn warnings(evaluation: &Evaluation) -> Vec<Warning> {
    let mut warnings = Vec::new();
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
