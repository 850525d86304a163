//! What a log that a set was evaluated on says of it, or the sign-off that was made of one.

use tempco_set::{Judgement, Rejection, RejectionCode, SignOff, Warning, WarningCode, build};

use super::bad_rows;
use super::merit::{Merit, no_better_than_none};
use super::of_reading;
use super::of_signals;
use crate::evaluation::{AxisEvaluation, Evaluation, Role};
use crate::text::percent;

/// Correlation of what remains with temperature or rate beyond which a quarter of it follows them.
const LARGE_CORRELATION: f64 = 0.5;

/// Rows with a flag in their status, as a share, that are worth a warning.
const MANY_ROWS: f64 = 0.01;

/// Rows outside the calibrated range, as a share, from which there is a warning.
const MANY_OUTSIDE: f64 = 0.05;

/// The same from which the log cannot tell of the set, so that it is rejected.
const MOSTLY_OUTSIDE: f64 = 0.2;

/// Flags of rows outside the calibrated range.
const OUTSIDE_FLAGS: [&str; 2] = ["temperature_clamped", "rate_clamped"];

/// The judgement of a log, as it is kept in a set.
pub fn sign_off(evaluation: &Evaluation) -> SignOff {
    let rejections = rejections(evaluation);
    let mut worse_axes: Vec<String> = Vec::new();
    for axis in rejections.iter().filter_map(|of| of.axis.as_ref()) {
        if !worse_axes.contains(axis) {
            worse_axes.push(axis.clone());
        }
    }
    SignOff {
        file: evaluation.log.file.clone(),
        sha256: evaluation.log.sha256.clone(),
        judged: build::now(),
        tau_s: evaluation.tau_s,
        accepted: rejections.is_empty(),
        worse_axes,
        rejections,
        warnings: warnings(evaluation),
    }
}

pub(super) fn judge_sign_off(last: &SignOff, judgement: &mut Judgement) {
    judgement.rejections.extend_from_slice(&last.rejections);
    // Older sets do not keep why.
    if !last.accepted && last.rejections.is_empty() {
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
            let code = RejectionCode::NoBetterThanNone;
            judgement.rejections.push(Rejection::new(code, found));
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

/// Why the log rejects the set: signals, axes without improvement, trends, and a log that cannot tell.
pub(super) fn rejections(evaluation: &Evaluation) -> Vec<Rejection> {
    let log = &evaluation.log;
    let axes = &evaluation.axes;
    let has_terms = axes.iter().any(|axis| !axis.constant_alone);
    let (mut rejections, _) = reasons_of_signals(evaluation);
    for axis in axes {
        let merits = [
            Merit::bias_stability(axis.sigma_raw, axis.sigma_compensated),
            Merit::rms_error(axis.rmse_raw, axis.rmse_compensated),
        ];
        // A constant cannot help, and the fit has said so. A set of constants is no compensation.
        if !(axis.constant_alone && has_terms) {
            rejections.extend(no_better_than_none(&axis.axis, merits, &log.file));
        }
        let large = trends(axis).into_iter().filter(|of| rejects(of, log.role));
        rejections.extend(large.map(|trend| {
            let message = trend.message(&log.file);
            Rejection::of_axis(trend.rejection, &axis.axis, message)
        }));
    }
    if let Some((share, found)) = outside(evaluation)
        && share >= MOSTLY_OUTSIDE
    {
        let code = RejectionCode::OutsideCalibratedRange;
        rejections.push(Rejection::new(code, found));
    }
    rejections.extend(bad_rows::rejection(&log.file, log.rows, log.skipped));
    rejections
}

/// What remains on an axis follows the temperature or its rate further than by chance.
struct Trend {
    what: &'static str,
    r: f64,
    chance: f64,
    rejection: RejectionCode,
    warning: WarningCode,
}

impl Trend {
    fn message(&self, file: &str) -> String {
        format!(
            "what remains on {file} follows {} (r = {:+.2}, by chance up to {:.2})",
            self.what, self.r, self.chance
        )
    }
}

fn trends(axis: &AxisEvaluation) -> Vec<Trend> {
    let Some(r) = axis.correlation_compensated.figure() else {
        return Vec::new();
    };
    let both = [
        Trend {
            what: "the temperature",
            r: r.temperature,
            chance: r.temperature_chance,
            rejection: RejectionCode::TrendWithTemperature,
            warning: WarningCode::ResidualFollowsTemperature,
        },
        Trend {
            what: "its rate",
            r: r.rate,
            chance: r.rate_chance,
            rejection: RejectionCode::TrendWithRate,
            warning: WarningCode::ResidualFollowsRate,
        },
    ];
    let beyond = both.into_iter().filter(|of| of.r.abs() > of.chance);
    beyond.collect()
}

/// A training log shows what the model cannot follow, but rejects nothing by it.
fn rejects(trend: &Trend, role: Role) -> bool {
    role != Role::Training && trend.r.abs() > LARGE_CORRELATION
}

/// Share of the rows outside the calibrated range, and what to say of them.
fn outside(evaluation: &Evaluation) -> Option<(f64, String)> {
    let (log, outside) = (&evaluation.log, evaluation.outside?);
    let share = outside.rows as f64 / log.rows as f64;
    let found = format!(
        "{:.1} % of the rows of {} lie outside the calibrated range of temperature or rate, from \
         {:.0} to {:.0} s",
        100.0 * share,
        log.file,
        outside.from_s,
        outside.to_s
    );
    Some((share, found))
}

/// What the log warns of.
pub(super) fn warnings(evaluation: &Evaluation) -> Vec<Warning> {
    let (_, mut warnings) = reasons_of_signals(evaluation);
    let log = &evaluation.log;
    warnings.extend(of_reading::warnings(&log.file, &log.doubts));
    for axis in &evaluation.axes {
        warn_of_residuals(axis, evaluation, &mut warnings);
    }
    for (flag, rows) in &evaluation.status_rows {
        let share = *rows as f64 / evaluation.log.rows as f64;
        if share > MANY_ROWS && *flag != "settling" && !OUTSIDE_FLAGS.contains(flag) {
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
    if let Some((share, found)) = outside(evaluation)
        && (MANY_OUTSIDE..MOSTLY_OUTSIDE).contains(&share)
    {
        warnings.push(Warning::new(WarningCode::FlaggedRows, found));
    }
    warnings
}

fn warn_of_residuals(axis: &AxisEvaluation, evaluation: &Evaluation, warnings: &mut Vec<Warning>) {
    let mut warn = |code, found: String| warnings.push(Warning::of_axis(code, &axis.axis, found));
    let file = &evaluation.log.file;
    let role = evaluation.log.role;
    for trend in trends(axis).iter().filter(|of| !rejects(of, role)) {
        warn(trend.warning, trend.message(file));
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
