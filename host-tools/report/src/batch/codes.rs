//! What rejects units and what warns of them, once by code.

use std::collections::BTreeMap;

use maud::{Markup, html};
use tempco_fit::batch::Summary;
use tempco_set::{Judgement, RejectionCode, WarningCode};

use super::{count, mention};

/// A code, what it means and what to do about it.
type Code = [&'static str; 3];

/// Axes by the number of their unit; none where a message is of no axis.
type Hits<'a> = BTreeMap<usize, Vec<&'a str>>;

/// Codes without repetition, in order.
pub(super) fn once(codes: impl Iterator<Item = &'static str>) -> Vec<&'static str> {
    let mut codes: Vec<&str> = codes.collect();
    codes.sort_unstable();
    codes.dedup();
    codes
}

/// A code that leads to its explanation.
pub(super) fn link(code: &str) -> Markup {
    html! { a href={ "#code-" (code) } { code { (code) } } }
}

pub(super) fn section(summary: &Summary) -> Markup {
    let rejections = RejectionCode::ALL.iter().map(|&code| {
        let found = hits(summary, |judgement| {
            let of_code = judgement.rejections.iter().filter(|of| of.code == code);
            of_code.map(|of| of.axis.as_deref()).collect()
        });
        ([code.name(), code.meaning(), code.advice()], found)
    });
    let warnings = WarningCode::ALL.iter().map(|&code| {
        let found = hits(summary, |judgement| {
            let of_code = judgement.warnings.iter().filter(|of| of.code == code);
            of_code.map(|of| of.axis.as_deref()).collect()
        });
        ([code.name(), code.meaning(), code.advice()], found)
    });
    let [rejections, warnings] = [rejections.collect(), warnings.collect()];
    html! {
        (list("Rejections", summary, rejections))
        (list("Warnings", summary, warnings))
    }
}

/// The axes of every unit whose judgement has any, in the order of the units.
fn hits<'a>(
    summary: &'a Summary,
    axes_of: impl Fn(&'a Judgement) -> Vec<Option<&'a str>>,
) -> Hits<'a> {
    let units = summary.units().iter().enumerate();
    let judged = units.filter_map(|(number, unit)| {
        let axes = axes_of(&unit.result.as_ref().ok()?.judgement);
        let mut names: Vec<&str> = axes.iter().copied().flatten().collect();
        names.dedup();
        (!axes.is_empty()).then_some((number, names))
    });
    judged.collect()
}

fn list(heading: &str, summary: &Summary, mut codes: Vec<(Code, Hits)>) -> Markup {
    codes.retain(|(_, hits)| !hits.is_empty());
    html! {
        @if !codes.is_empty() {
            section {
                h2 { (heading) }
                @for ([code, meaning, advice], hits) in codes {
                    div.code id={ "code-" (code) } {
                        h3 { code { (code) } " " span.unit { (count(hits.len())) } }
                        p { (meaning.replace('`', "")) " " b { (advice.replace('`', "")) } }
                        p {
                            @for (place, (&number, axes)) in hits.iter().enumerate() {
                                @if place > 0 { ", " }
                                (mention(summary, number))
                                @if !axes.is_empty() { " (" (axes.join(", ")) ")" }
                            }
                        }
                    }
                }
            }
        }
    }
}
