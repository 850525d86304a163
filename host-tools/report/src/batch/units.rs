//! A row for every unit, the worst first.

use maud::{Markup, html};
use tempco_evaluate::{figure, percent};
use tempco_fit::batch::{BatchAxis, Outcome, Summary, UnitResult, is_folder_name};
use tempco_set::{REPORT, escape};

use super::{FAILED, anchor, class, codes, verdicts};
use crate::page::axis_cell;

pub(super) fn section(summary: &Summary, with_reports: bool) -> Markup {
    let axes = summary.axes();
    html! {
        section {
            h2 { "Units" }
            p { "The worst first. Of every axis: how much better the bias stability is with "
                "compensation, and what it is then." }
            div.scroll tabindex="0" {
                table.units {
                    thead { tr {
                        th scope="col" { "unit" }
                        @for name in ["verdict", "worst axis"] { th.text scope="col" { (name) } }
                        @for axis in &axes { th scope="col" { (axis_cell(axis.name, axis.unit)) } }
                        th.text scope="col" { "warnings" }
                    } }
                    tbody {
                        @for number in summary.worst_first() {
                            @let unit = &summary.units()[number];
                            tr id=(anchor(number)) class={ "unit " (class(unit)) } {
                                th scope="row" { (serial(unit, with_reports)) }
                                td.text { span.word { (name(unit)) } }
                                @match &unit.result {
                                    Ok(result) => (row(number, result, &axes)),
                                    Err(_) => td.text colspan=(axes.len() + 2) {
                                        "No set was written; the message is at the top."
                                    },
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The serial number, which leads to the unit's report if it has one.
fn serial(unit: &Outcome, with_reports: bool) -> Markup {
    let serial = &unit.serial;
    let link = format!("{}/{REPORT}", escape::url_part(serial));
    html! {
        @if with_reports && class(unit) != FAILED && is_folder_name(serial) {
            a href=(link) { (serial) }
        } @else { (serial) }
    }
}

fn name(unit: &Outcome) -> &'static str {
    let mut verdicts = verdicts().into_iter();
    let found = verdicts.find(|(of, _)| *of == class(unit));
    found.map_or(FAILED, |(_, name)| name)
}

/// The cells of a unit with a set.
fn row(number: usize, result: &UnitResult, axes: &[BatchAxis]) -> Markup {
    let worst = result.worst_axis();
    let rejections = result.judgement.rejections.iter();
    let rejections = codes::once(rejections.map(|of| of.code.name()));
    let warnings = codes::once(result.judgement.warnings.iter().map(|of| of.code.name()));
    html! {
        td.text {
            @if let Some(worst) = worst { (worst.axis) }
            @for code in rejections { " " (codes::link(code)) }
        }
        @for axis in axes {
            @let of = axis.results.iter().find(|of| of.unit() == number);
            @match of {
                None => td { "-" },
                Some(of) => td.worst[worst.is_some_and(|worst| std::ptr::eq(worst, of.result))] {
                    (of.result.improvement().map_or_else(|| "-".to_owned(), percent))
                    @if of.result.n > 1 { span.sigma { (figure(of.result.sigma_after)) } }
                    @if of.is_outlier().contains(&true) { span.sigma { "outlier" } }
                },
            }
        }
        td.text { @for code in warnings { (codes::link(code)) " " } }
    }
}
