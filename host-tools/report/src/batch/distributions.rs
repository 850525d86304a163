//! Every axis over all units, before and after compensation.

use maud::{Markup, html};
use tempco_evaluate::figure;
use tempco_fit::batch::{AxisOfUnit, BatchAxis, LEAST_UNITS, OUTLIER_Z, Summary};

use super::{class, mention};
use crate::ReportError;
use crate::figure::distribution::{Quantiles, Unit, draw};

const NAMES: [&str; 2] = ["Before", "After"];

pub(super) fn section(summary: &Summary) -> Result<Markup, ReportError> {
    let figures = summary
        .axes()
        .into_iter()
        .map(|axis| of_axis(summary, &axis));
    let figures = figures.collect::<Result<Vec<_>, _>>()?;
    Ok(html! {
        section {
            h2 { "Before and after" }
            p { "Bias stability of every unit on the fitted logs: the standard deviation of means. "
                "Outliers are named: the logarithm is more than " (OUTLIER_Z) " robust standard "
                "deviations from the median of all units (from " (LEAST_UNITS) " units on)." }
            div.figures { @for figure in figures { (figure) } }
        }
    })
}

fn of_axis(summary: &Summary, axis: &BatchAxis) -> Result<Markup, ReportError> {
    let groups = [0, 1].map(|which| group(summary, axis, which));
    let symbol = axis.unit.symbol();
    let drawn = draw(axis.name, symbol, &groups)?;
    let texts = NAMES.into_iter().zip(&groups).enumerate().map(|(which, (name, units))| {
        let outliers = axis.results.iter().filter(|of| of.is_outlier()[which]);
        let outliers: Vec<usize> = outliers.map(AxisOfUnit::unit).collect();
        html! {
            p {
                b { (name) ": " }
                @match Quantiles::of(units) {
                    Some(of) => { "median " (figure(of.median)) " " (symbol) ", from " (figure(of.low))
                        " to " (figure(of.high)) " over " (super::count(units.len())) "." }
                    None => "no unit has enough means.",
                }
                @if !outliers.is_empty() {
                    " Outliers: "
                    @for (place, &number) in outliers.iter().enumerate() {
                        @if place > 0 { ", " }
                        (mention(summary, number))
                    }
                    "."
                }
            }
        }
    });
    Ok(html! {
        figure { (drawn.inline()) figcaption { @for text in texts { (text) } } }
    })
}

/// The units that have enough means, by their bias stability before or after.
fn group<'a>(summary: &'a Summary, axis: &BatchAxis, which: usize) -> Vec<Unit<'a>> {
    let unit = |of: &AxisOfUnit| {
        let value = [of.result.sigma_before, of.result.sigma_after][which];
        let outcome = &summary.units()[of.unit()];
        (of.result.n > 1 && value.is_finite() && value > 0.0).then(|| Unit {
            serial: &outcome.serial,
            class: class(outcome),
            value,
            outlier: of.scores[which].filter(|_| of.is_outlier()[which]),
        })
    };
    let mut units: Vec<Unit> = axis.results.iter().filter_map(unit).collect();
    units.sort_by(|a, b| a.value.total_cmp(&b.value));
    units
}
