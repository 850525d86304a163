//! The summary of a batch of units as a page.

mod codes;
mod distributions;
mod units;

use maud::{Markup, html};
use tempco_fit::batch::{Outcome, Summary};
use tempco_set::Verdict;

use crate::ReportError;
use crate::page::{class_of, document};

/// Class of a unit without a set.
const FAILED: &str = "failed";

/// The summary of a batch as a page that needs no other file. Serial numbers lead to the reports of
/// the units, `SERIAL/report.html` in the same folder, if they have reports.
///
/// # Errors
/// A figure that could not be drawn.
pub fn batch_page(summary: &Summary, with_reports: bool) -> Result<String, ReportError> {
    let title = format!("Batch of {}", count(summary.units().len()));
    let distributions = distributions::section(summary)?;
    Ok(document(
        &title,
        html! {
            (verdict(summary))
            (filter(summary))
            (distributions)
            (units::section(summary, with_reports))
            (codes::section(summary))
        },
    ))
}

/// A number of units in words.
fn count(units: usize) -> String {
    match units {
        1 => "1 unit".to_owned(),
        units => format!("{units} units"),
    }
}

/// The class by which the style sheet and the filter know a unit.
fn class(unit: &Outcome) -> &'static str {
    unit.verdict().map_or(FAILED, class_of)
}

/// Where the row of a unit is on the page.
fn anchor(number: usize) -> String {
    format!("unit-{}", number + 1)
}

/// A serial number that leads to the row of its unit.
fn mention(summary: &Summary, number: usize) -> Markup {
    html! { a href={ "#" (anchor(number)) } { (summary.units()[number].serial) } }
}

/// Verdicts from the worst to the best, each with its class and name.
fn verdicts() -> [(&'static str, &'static str); 4] {
    [
        (FAILED, "failed"),
        (class_of(Verdict::Rejected), "rejected"),
        (
            class_of(Verdict::AcceptedWithWarnings),
            "accepted with warnings",
        ),
        (class_of(Verdict::Accepted), "accepted"),
    ]
}

/// How many units have the verdict of a class.
fn count_of(summary: &Summary, of: &str) -> usize {
    let units = summary.units().iter();
    units.filter(|unit| class(unit) == of).count()
}

/// How many units have which verdict, and why some have no set.
fn verdict(summary: &Summary) -> Markup {
    let units = summary.units();
    let [failed, rejected, warned, clean] = verdicts().map(|(class, _)| count_of(summary, class));
    let worst = match (failed + rejected, warned) {
        (0, 0) => "accept",
        (0, _) => "warnings",
        _ => "reject",
    };
    let messages = units.iter().enumerate();
    let messages =
        messages.filter_map(|(number, unit)| Some((number, unit.result.as_ref().err()?)));
    html! {
        section class={ "verdict " (worst) } {
            p.word { (warned + clean) " of " (count(units.len())) " accepted" }
            p { (clean) " accepted, " (warned) " accepted with warnings, " (rejected) " rejected, "
                (failed) " failed. Judged on the fitted logs; no set is verified yet." }
            @if failed > 0 {
                h3 { "Failed: could not be read or fitted" }
                ul { @for (number, message) in messages {
                    li { (mention(summary, number)) ": " (message) }
                } }
            }
        }
    }
}

/// Shows the units of one verdict only, in figures and table.
fn filter(summary: &Summary) -> Markup {
    html! {
        fieldset.filter {
            legend { "Show" }
            label { input #show-all type="radio" name="show" checked; "all (" (summary.units().len()) ")" }
            @for (class, name) in verdicts() {
                @if count_of(summary, class) > 0 {
                    label { input id={ "show-" (class) } type="radio" name="show";
                        (name) " (" (count_of(summary, class)) ")" }
                }
            }
        }
    }
}
