//! The coefficients of a set, with their uncertainties.

use maud::{Markup, html};
use tempco_evaluate::figure;
use tempco_set::{
    COMPOSITE, CoefficientSet, CoefficientSigmas, HistoryGain, HistoryTerm, LOCAL_TERMS,
};

use super::document::{axis_cell, cell, table};
use super::tables::{axes, dash};
use crate::text::gain;

pub(super) fn coefficients(set: &CoefficientSet) -> Markup {
    let mut rows = Vec::new();
    for (channel, _, axis) in axes(set) {
        for (position, segment) in channel.segments.iter().enumerate() {
            let polynomial = &axis.polynomials[position];
            let sigmas = axis.sigmas.get(position);
            let sigmas = sigmas.map_or([0.0; COMPOSITE], CoefficientSigmas::to_array);
            let mut row = vec![
                axis_cell(&axis.name, axis.unit),
                cell(format!("{:.2} to {:.2}", segment.t_min_c, segment.t_max_c)),
            ];
            row.extend(
                polynomial
                    .coefficients()
                    .into_iter()
                    .zip(sigmas)
                    .map(|(value, sigma)| with_sigma(value, sigma)),
            );
            rows.push(row);
        }
    }
    let terms = LOCAL_TERMS.map(|term| term.replace("^2", "\u{b2}"));
    let mut head = vec!["axis", "segment [degC]"];
    head.extend(terms.iter().map(String::as_str));
    html! {
        section {
            h2 { "Coefficients" }
            p { "With 1 sigma; of 1, z, z\u{b2} in the unit of the axis, of T' and z T' per degC/min, with z "
                "from -1 to 1 over the segment." }
            (table(&head, rows))
            (history(set))
        }
    }
}

fn with_sigma(value: f64, sigma: f64) -> Markup {
    match (value, sigma) {
        (0.0, 0.0) => dash(),
        (_, 0.0) => cell(figure(value)),
        _ => html! { (figure(value)) span.sigma { "\u{b1} " (format!("{sigma:.1e}")) } },
    }
}

fn gain_cell(found: &HistoryGain) -> Markup {
    match gain(found) {
        None => dash(),
        Some(text) if found.sigma == 0.0 => cell(text),
        Some(text) => html! { (text) span.sigma { "\u{b1} " (format!("{:.1e}", found.sigma)) } },
    }
}

/// The terms of the thermal history; nothing where there are none.
fn history(set: &CoefficientSet) -> Markup {
    let mut rows = Vec::new();
    for (channel, _, axis) in axes(set) {
        for (term, found) in channel.history(axis) {
            let number = |value: f32| cell(figure(value.into()));
            let mut row = vec![axis_cell(&axis.name, axis.unit)];
            row.extend(match term {
                HistoryTerm::Play { half_width_c } => {
                    [cell("play"), number(half_width_c), dash(), dash()]
                }
                HistoryTerm::SecondLag { tau2_s, limit_c } => {
                    [cell("second lag"), dash(), number(tau2_s), number(limit_c)]
                }
            });
            row.push(gain_cell(&found));
            rows.push(row);
        }
    }
    let head = [
        "axis",
        "term",
        "w [degC]",
        "tau [s]",
        "lag up to [degC]",
        "gain per degC",
    ];
    html! {
        @if !rows.is_empty() {
            p { "Terms of the thermal history: gains in the unit of the axis per degC that the contact of a "
                "play, of half width w, or the second lag is behind the temperature, with 1 sigma for this "
                "w or tau. The gain of the second lag differs from segment to segment: its lowest and "
                "highest, with the largest sigma in the middle of a segment." }
            (table(&head, rows))
        }
    }
}
