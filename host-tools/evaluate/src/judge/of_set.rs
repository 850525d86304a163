//! What a set says of its own fit and its table.

use tempco_set::{
    AxisSet, Candidate, ChannelSet, CoefficientSet, Judgement, Model, Rejection, RejectionCode,
    SegmentSet, TERMS, Warning, WarningCode,
};

use super::bad_rows;
use super::merit::{Merit, no_better_than_none};
use super::of_outliers;
use super::of_reading;
use super::of_remains;
use super::of_signals;
use crate::text::figure;

/// A segment of which the rows span less than this share of its width reaches beyond its data.
const LEAST_WIDTH: f64 = 0.8;

/// Condition number beyond which the coefficients of a segment are hardly determined.
const LARGE_CONDITION: f64 = 100.0;

/// A boundary that was moved by more is worth a warning \[degC\].
const LARGE_MOVE_C: f64 = 0.01;

/// A rounding bound beyond this share of the compensated bias stability is worth a warning.
const LARGE_ROUNDING: f64 = 0.01;

/// A time constant of the rate below this is at the shortest that is tried \[s\].
const SHORT_TAU_S: f64 = 12.0;

/// A share of the second lag below this, without one of the first, runs ahead of the temperature.
const AHEAD: f64 = -0.05;

pub(super) fn judge(set: &CoefficientSet, judgement: &mut Judgement) {
    // Spoilt logs come first: what else is wrong may follow from them.
    let is_axis = |column: &str| set.axes().any(|(_, axis)| axis.name == column);
    for input in &set.provenance.inputs {
        let (rejections, warnings) = of_signals::reasons(&input.file, &input.findings, is_axis);
        judgement.rejections.extend(rejections);
        judgement.warnings.extend(warnings);
        let doubts = of_reading::warnings(&input.file, &input.doubts);
        judgement.warnings.extend(doubts);
    }
    // A constant cannot help, and the fit has said so. A set of constants is no compensation.
    let mut axes = set.channels.iter().flat_map(|channel| {
        let axes = 0..channel.axes.len();
        axes.map(|axis| channel.table.is_constant(axis))
    });
    let has_terms = axes.any(|is_constant| !is_constant);
    for channel in &set.channels {
        for (number, axis) in channel.axes.iter().enumerate() {
            let is_judged = !(has_terms && channel.table.is_constant(number));
            let found = rejections(channel, number, is_judged);
            judgement.rejections.extend(found);
            judgement.rejections.extend(of_remains::worse(axis));
            judgement.warnings.extend(of_remains::held_out(axis));
            judgement
                .warnings
                .extend(of_remains::above_noise(channel, axis));
        }
        judgement
            .rejections
            .extend(of_outliers::rejections(channel));
        let warnings = &mut judgement.warnings;
        if let Some(outliers) = &channel.outliers {
            of_outliers::warn(channel, outliers, warnings);
        }
        warn_of_terms(set.settings.model, channel, warnings);
        for segment in &channel.segments {
            warn_of_segment(segment, warnings);
        }
        warn_of_table(channel, warnings);
    }
    for input in &set.provenance.inputs {
        let too_many = bad_rows::rejection(&input.file, input.rows, input.skipped);
        judgement.rejections.extend(too_many);
        if input.unusable_rows > 0 {
            judgement.warnings.push(Warning::new(
                WarningCode::UnusableRows,
                format!(
                    "{}: {} rows were not fitted, since their temperature or interval was not \
                     accepted",
                    input.file, input.unusable_rows
                ),
            ));
        }
    }
}

fn rejections(
    channel: &ChannelSet,
    number: usize,
    is_judged: bool,
) -> impl Iterator<Item = Rejection> {
    let axis = &channel.axes[number];
    let disagree = channel.mismatch_alarm(number).then(|| {
        Rejection::of_axis(
            RejectionCode::SegmentsDisagree,
            &axis.name,
            "neighbouring segments disagree by more than half of the bias range",
        )
    });
    // Bias stability where there are means of it, and the error of single rows.
    let worse = axis.statistics.filter(|_| is_judged).and_then(|of| {
        let stability = Merit::bias_stability(of.sigma_raw, of.sigma_compensated);
        let stability = (of.n > 1).then_some(stability);
        let error = Merit::rms_error(of.rmse_raw, of.rmse_compensated);
        let merits = stability.into_iter().chain([error]);
        no_better_than_none(&axis.name, merits, "the fitted logs")
    });
    disagree.into_iter().chain(worse)
}

/// Terms that the model could have and does not.
fn warn_of_terms(asked_for: Model, channel: &ChannelSet, warnings: &mut Vec<Warning>) {
    let selection = channel.selection.as_ref();
    let model = selection.map_or(asked_for, |selection| selection.chosen.model);
    // Each segment of the paper's models has the terms that its rows can carry.
    if model != Model::Spline {
        let terms = &TERMS[..model.terms()];
        for segment in channel.segments.iter().filter(|of| of.rows > 0) {
            let dropped = terms.get(segment.terms.len()..).unwrap_or_default();
            if !dropped.is_empty() {
                warnings.push(Warning::new(
                    WarningCode::TermsDropped,
                    format!(
                        "{} ({}): the data cannot separate {} from the other terms; dropped",
                        name(segment),
                        channel.temperature,
                        dropped.join(", ")
                    ),
                ));
            }
        }
    }
    let Some(selection) = selection else {
        return;
    };
    let chosen = &selection.chosen;
    if chosen.rate_columns == 0 {
        warnings.push(Warning::new(
            WarningCode::NoRateTerms,
            format!(
                "{}: the model has no rate terms, no lag shift and no history terms. They are tried \
                 where the logs hold four soaks and ramps, or three with ramps of two rates; these \
                 hold {}",
                channel.temperature, selection.soaks_and_ramps
            ),
        ));
    }
    if model != Model::Spline {
        return;
    }
    warn_of_axes(channel, chosen.rate_columns > 0, warnings);
    if chosen.rate_columns > 0 && !selection.can_tell_lags() {
        warnings.push(Warning::new(
            WarningCode::HistoryTermsNotTried,
            format!(
                "{}: plays and second lag are not tried. All ramps are of one rate, so hysteresis \
                 and lags look the same",
                channel.temperature
            ),
        ));
    }
    if let Some(how) = sensor_lags(chosen) {
        warnings.push(Warning::new(
            WarningCode::SensorLags,
            format!(
                "{}: the sensor lags the source of the bias ({how}). The model predicts it; place \
                 the sensor nearer",
                channel.temperature
            ),
        ));
    }
}

/// How the lags of a model say that the temperature comes after the bias.
fn sensor_lags(chosen: &Candidate) -> Option<String> {
    let &Candidate {
        tau_s,
        kappa,
        kappa2,
        ..
    } = chosen;
    if tau_s < SHORT_TAU_S {
        Some(format!("tau {} s", figure(tau_s)))
    } else if kappa == 0.0 && kappa2 < AHEAD {
        Some(format!("kappa 0, kappa2 {}", figure(kappa2)))
    } else {
        None
    }
}

/// Axes of a spline that are left without terms that the model has.
fn warn_of_axes(channel: &ChannelSet, with_rate: bool, warnings: &mut Vec<Warning>) {
    let has_history = |axis: &AxisSet| channel.history(axis).any(|(_, gain)| !gain.is_zero());
    let with_history = channel.axes.iter().any(has_history);
    let axes = channel.axes.iter().enumerate();
    for (_, axis) in axes.filter(|(number, _)| !channel.table.is_constant(*number)) {
        let mut rates = axis.polynomials.iter().flat_map(|of| of.r);
        let no_rate = rates.all(|r| r == 0.0);
        if with_rate && no_rate {
            warnings.push(Warning::of_axis(
                WarningCode::RateTermsDropped,
                &axis.name,
                "the logs are more likely without rate terms; dropped",
            ));
        }
        if with_history && !has_history(axis) {
            warnings.push(Warning::of_axis(
                WarningCode::HistoryTermsDropped,
                &axis.name,
                "the logs are more likely without plays and second lag; dropped",
            ));
        }
    }
}

fn warn_of_segment(segment: &SegmentSet, warnings: &mut Vec<Warning>) {
    let name = name(segment);
    if let Some(coverage) = segment.coverage.filter(|c| c.width < LEAST_WIDTH) {
        warnings.push(Warning::new(
            WarningCode::ThinSegment,
            format!(
                "{name}: the fitted rows span {:.0} % of it",
                100.0 * coverage.width
            ),
        ));
    }
    if segment.condition > LARGE_CONDITION {
        warnings.push(Warning::new(
            WarningCode::IllConditioned,
            format!(
                "{name}: condition number {}, the coefficients are hardly determined",
                figure(segment.condition)
            ),
        ));
    }
}

fn warn_of_table(channel: &ChannelSet, warnings: &mut Vec<Warning>) {
    if channel.boundary_moved_c > LARGE_MOVE_C {
        warnings.push(Warning::new(
            WarningCode::BoundaryMoved,
            format!(
                "{}: boundaries between segments lie on no common grid of 256 cells or fewer and \
                 were moved by up to {:.3} degC",
                channel.temperature, channel.boundary_moved_c
            ),
        ));
    }
    for (number, axis) in channel.axes.iter().enumerate() {
        let rounding = channel.table.rounding_bound(number).total;
        let sigma = axis.statistics.map_or(0.0, |of| of.sigma_compensated);
        if sigma > 0.0 && rounding > LARGE_ROUNDING * sigma {
            warnings.push(Warning::of_axis(
                WarningCode::Rounding,
                &axis.name,
                format_args!(
                    "rounding in f32 can cost {rounding:.1e}, more than {:.0} % of the bias \
                     stability with compensation",
                    100.0 * LARGE_ROUNDING
                ),
            ));
        }
    }
}

fn name(segment: &SegmentSet) -> String {
    format!(
        "segment {:.1} to {:.1} degC",
        segment.t_min_c, segment.t_max_c
    )
}
