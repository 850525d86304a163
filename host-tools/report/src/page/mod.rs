//! The page.

mod coefficients;
mod document;
mod provenance;
mod record_next;
mod summary;
mod tables;

pub(crate) use document::{axis_cell, document};
pub(crate) use summary::class_of;

use maud::{Markup, html};

use crate::Subject;
use crate::figure::{AxisFigures, Figure, Figures};
use crate::gather::Gathered;
use crate::text::seconds;

/// The whole page.
pub(crate) fn page(subject: &Subject, gathered: Option<&Gathered>, figures: &Figures) -> String {
    let set = subject.set;
    let what = match subject.evaluation {
        Some(_) => "Verification",
        None => "Calibration",
    };
    let title = format!("{what} of unit {}", set.serial);
    document(
        &title,
        html! {
            (summary::summary(subject))
            @match gathered {
                Some(gathered) => (of_rows(subject, gathered, figures)),
                None => section {
                    h2 { "Figures of the logs" }
                    p { "The set was fitted to summaries, which have no rows: figures of rows are left "
                        "out. To see them, run " code { "tempco evaluate" } " over a log of the unit, "
                        "with " code { "--report" } "." }
                    (tables::uncertainty(set))
                },
            }
            section {
                h2 { "Segments and boundaries" }
                div.figures { @for axis in &figures.segments { figure { (axis.inline()) } } }
                (tables::boundaries(set))
            }
            section {
                h2 { "Coverage" }
                @if let Some(gathered) = gathered {
                    p { "Where the logs of this report were in temperature and rate. Outside of the "
                        "frame the set is held at its edge." }
                    div.figures { @for map in &figures.coverage { figure { (map.inline()) } } }
                    @if subject.evaluation.is_none() { (record_next::record_next(set, gathered)) }
                }
                (tables::coverage(set))
            }
            (tables::models(set))
            (coefficients::coefficients(set))
            (provenance::provenance(subject))
        },
    )
}

/// What the rows of the logs show.
fn of_rows(subject: &Subject, gathered: &Gathered, figures: &Figures) -> Markup {
    let set = subject.set;
    let tau = seconds(gathered.tau_s);
    let has_history = set.channels.iter().any(|of| of.table.has_history());
    let of_axes = |figure: fn(&AxisFigures) -> &Figure| {
        html! { div.figures { @for axis in &figures.axes { figure { (figure(axis).inline()) } } } }
    };
    html! {
        section {
            h2 { "Bias against temperature" }
            p { "Marks: means over " (tau) ", by temperature, less the constant offset of each log "
                "from the fit. Thin lines: what the set took out while heating and cooling. "
                "Thick line: the same at a steady temperature, with the 1-sigma band of its "
                "coefficients"
                @if has_history { "; the terms of the thermal history are left out of it" } "." }
            (of_axes(|axis| &axis.bias))
            (tables::uncertainty(set))
        }
        section {
            h2 { "Before and after" }
            p { "Means over " (tau) " about the mean of the log; where several fall into one column "
                "of the drawing, their mean, in a band from the lowest to the highest." }
            (of_axes(|axis| &axis.traces))
        }
        section {
            h2 { "What remains" }
            p { "About the mean of the log. Against time: means over " (tau) ", and below them the "
                "lowest and highest single row of each column, none left out." }
            (of_axes(|axis| &axis.over_time))
            p { "Against temperature and its rate: means over " (tau) ", with the lowest and highest "
                "of each place. Nothing should follow from either; marks of heating and cooling that "
                "keep apart are lag or hysteresis that is not described." }
            (of_axes(|axis| &axis.over_temperature))
            (of_axes(|axis| &axis.over_rate))
        }
        section {
            h2 { "Allan deviation" }
            p { "Overlapping, over the longest stretch without a gap, with 1-sigma intervals." }
            (of_axes(|axis| &axis.allan))
            @if let Some(evaluation) = subject.evaluation { (tables::allan(evaluation)) }
        }
    }
}
