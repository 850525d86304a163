//! The verdict and the numbers behind it.

use maud::{Markup, html};
use tempco_evaluate::{Evaluation, Role, figure, percent};
use tempco_set::{ChannelSet, CoefficientSet, Verdict};

use super::document::{axis_cell, cell, table};
use crate::Subject;
use crate::text::seconds;

pub(super) fn summary(subject: &Subject) -> Markup {
    let judgement = subject.judgement;
    let verdict = judgement.verdict();
    html! {
        section class={ "verdict " (class_of(verdict)) } {
            p.word { (verdict.name().replace('_', " ")) }
            p { @if judgement.verified { "Verified on a log that the set was not fitted to. " }
                @else { "Not verified on a log that the set was not fitted to. " }
                (why(subject)) }
            @if !judgement.rejections.is_empty() {
                h3 { "Rejected because" }
                ul { @for of in &judgement.rejections { (reason(of.code.name(), &of.message)) } }
            }
            @if !judgement.warnings.is_empty() {
                h3 { "Warnings" }
                ul { @for of in &judgement.warnings { (reason(of.code.name(), &of.message)) } }
            }
            h3 { "Calibrated for" }
            ul { @for channel in &subject.set.channels { li { (range(channel)) }
                @if let Some(about) = channel.about_reference() { li { (about) } } } }
        }
        section {
            @match subject.evaluation {
                Some(evaluation) => (of_evaluation(evaluation)),
                None => (of_fit(subject.set)),
            }
        }
    }
}

/// The class by which the style sheet and filters know a verdict.
pub(crate) const fn class_of(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Accepted => "accept",
        Verdict::AcceptedWithWarnings => "warnings",
        Verdict::Rejected => "reject",
    }
}

/// The range of temperature and its rate in which a channel is calibrated.
fn range(channel: &ChannelSet) -> String {
    let (table, thermal) = (&channel.table, &channel.table.thermal);
    let ends = [
        table.t_min_c,
        table.t_max_c,
        thermal.rate_min_c_per_min,
        thermal.rate_max_c_per_min,
    ];
    let [t_min, t_max, rate_min, rate_max] = ends.map(|end| figure(end.into()));
    let name = &channel.temperature;
    format!("{name}: T {t_min} to {t_max} degC, T' {rate_min} to {rate_max} degC/min")
}

fn reason(code: &str, message: &str) -> Markup {
    html! { li { (message) " " code { (code) } } }
}

/// The improvement of every axis, in a sentence.
fn why(subject: &Subject) -> String {
    let improvements: Vec<(String, f64)> = match subject.evaluation {
        Some(evaluation) => {
            let axes = evaluation.axes.iter();
            axes.map(|axis| (axis.axis.clone(), axis.improvement))
                .collect()
        }
        None => {
            let axes = subject.set.axes();
            let of_axis = axes.filter_map(|(_, axis)| {
                let s = axis.statistics.filter(|s| s.n > 1)?;
                Some((axis.name.clone(), 1.0 - s.sigma_compensated / s.sigma_raw))
            });
            of_axis.collect()
        }
    };
    let list: Vec<String> = improvements
        .into_iter()
        // What belongs together stays on one line.
        .map(|(name, share)| format!("{name} {}", percent(share)).replace(' ', "\u{a0}"))
        .collect();
    let log = match subject.evaluation.map(|e| e.log.role) {
        Some(Role::Verification) => "a log the set was not fitted to",
        Some(Role::Training) => "a log the set was fitted to",
        Some(Role::Unknown) => "a log the set may have been fitted to",
        None => "the logs the set was fitted to",
    };
    if list.is_empty() {
        return format!("No numbers over {log}.");
    }
    format!("Bias stability on {log}, better by: {}.", list.join(", "))
}

fn of_evaluation(evaluation: &Evaluation) -> Markup {
    let head = [
        "axis",
        "before",
        "after",
        "better by",
        "n",
        "over reference",
        "RMSE after",
        "largest",
        "r with T",
        "r with T'",
    ];
    let rows = evaluation.axes.iter().map(|axis| {
        let at_tau = axis.bias_stability.iter();
        let over = at_tau
            .filter(|at| at.tau_s == evaluation.tau_s)
            .find_map(|at| at.sigma.figure()?.improvement_over_reference);
        let r = axis.correlation_compensated.figure();
        vec![
            axis_cell(&axis.axis, axis.unit),
            cell(figure(axis.sigma_raw)),
            cell(figure(axis.sigma_compensated)),
            cell(percent(axis.improvement)),
            cell(axis.n),
            cell(over.map_or_else(|| "-".to_owned(), percent)),
            cell(figure(axis.rmse_compensated)),
            cell(figure(axis.max_abs_compensated)),
            cell(r.map_or_else(|| "-".to_owned(), |r| format!("{:+.2}", r.temperature))),
            cell(r.map_or_else(|| "-".to_owned(), |r| format!("{:+.2}", r.rate))),
        ]
    });
    html! {
        h2 { "Bias stability" }
        p { "Standard deviation of means over " (seconds(evaluation.tau_s)) " on "
            (evaluation.log.file) ", before and after compensation. Reference: "
            (evaluation.reference) ". Largest: of a mean, about the mean of the log." }
        (table(&head, rows.collect()))
    }
}

fn of_fit(set: &CoefficientSet) -> Markup {
    let tau_s = set
        .axes()
        .find_map(|(_, axis)| Some(axis.statistics?.tau_s));
    let head = [
        "axis",
        "before",
        "after",
        "better by",
        "one cubic",
        "n",
        "RMSE before",
        "RMSE after",
    ];
    let rows = set.axes().filter_map(|(_, axis)| {
        let s = axis.statistics?;
        let sigma = |value: f64| {
            if s.n > 1 {
                figure(value)
            } else {
                "-".to_owned()
            }
        };
        Some(vec![
            axis_cell(&axis.name, axis.unit),
            cell(sigma(s.sigma_raw)),
            cell(sigma(s.sigma_compensated)),
            cell(percent(1.0 - s.sigma_compensated / s.sigma_raw)),
            cell(sigma(s.sigma_cubic)),
            cell(s.n),
            cell(figure(s.rmse_raw)),
            cell(figure(s.rmse_compensated)),
        ])
    });
    html! {
        h2 { "Bias stability" }
        p { "Standard deviation of means over " (seconds(tau_s.unwrap_or_default())) " on the fitted "
            "logs, before compensation, with one cubic in T, and with this set. RMSE: of single rows." }
        (table(&head, rows.collect()))
    }
}
