//! What all pages have in common: the frame with the style sheet, and tables.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use tempco_log::AxisUnit;
use tempco_set::escape;

use crate::figure::dark_rules;

const STYLE: &str = include_str!("style.css");

/// A whole page, which needs no other file.
pub(crate) fn document(title: &str, main: Markup) -> String {
    let dark = format!(
        "@media screen and (prefers-color-scheme:dark){{{}}}",
        dark_rules()
    );
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(dark)) }
            }
            body {
                header { h1 { (title) } }
                main { (main) }
            }
        }
    };
    escape::lines(&page.into_string()) + "\n"
}

/// A table that may be wider than the page, and then moves under its own bar.
pub(crate) fn table(head: &[&str], rows: Vec<Vec<Markup>>) -> Markup {
    html! {
        div.scroll tabindex="0" {
            table {
                thead { tr { @for name in head { th scope="col" { (name) } } } }
                tbody {
                    @for row in rows {
                        tr { @for cell in row { td { (cell) } } }
                    }
                }
            }
        }
    }
}

/// An axis with its unit.
pub(crate) fn axis_cell(name: &str, unit: AxisUnit) -> Markup {
    html! { (name) " " span.unit { "[" (unit) "]" } }
}

pub(crate) fn cell(text: impl std::fmt::Display) -> Markup {
    html! { (text.to_string()) }
}
