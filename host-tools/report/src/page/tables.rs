//! The tables below the figures.

use maud::{Markup, html};
use tempco_evaluate::{Evaluation, figure, without_dust};
use tempco_set::{AxisSet, Candidate, ChannelSet, CoefficientSet, HeldOutErrors, SegmentSet};

use super::document::{axis_cell, cell, table};
use crate::band::sigma_at;
use crate::text::{LAGS, held_out_caption, lags, states};

/// Runner-ups that are shown; the set holds all.
const SHOWN: usize = 6;

/// Places at which the band of the fit is looked at.
const STEPS: u32 = 200;

pub(super) fn dash() -> Markup {
    cell("-")
}

/// The axes of all channels, each with its channel and its number in it.
pub(super) fn axes(set: &CoefficientSet) -> impl Iterator<Item = (&ChannelSet, usize, &AxisSet)> {
    set.channels.iter().flat_map(|channel| {
        let axes = channel.axes.iter().enumerate();
        axes.map(move |(number, axis)| (channel, number, axis))
    })
}

/// How wide the band of the fit is, for those who cannot see how narrow it is.
pub(super) fn uncertainty(set: &CoefficientSet) -> Markup {
    let rows: Vec<Vec<Markup>> = axes(set)
        .filter_map(|(channel, number, axis)| {
            let (low, high) = (channel.table.t_min_c, channel.table.t_max_c);
            let (low, high) = (f64::from(low), f64::from(high));
            let temps_c = (0..=STEPS).map(|s| low + (high - low) * f64::from(s) / f64::from(STEPS));
            let sigmas = temps_c.filter_map(|temp_c| sigma_at(axis, temp_c));
            let largest = sigmas.reduce(f64::max)?;
            Some(vec![
                axis_cell(&axis.name, axis.unit),
                cell(figure(channel.table.static_range(number))),
                cell(figure(largest)),
            ])
        })
        .collect();
    html! {
        @if !rows.is_empty() {
            (table(&["axis", "bias range", "largest 1 sigma of the fit"], rows))
        }
    }
}

pub(super) fn boundaries(set: &CoefficientSet) -> Markup {
    let mut rows = Vec::new();
    for (channel, number, axis) in axes(set) {
        let range = channel.table.static_range(number);
        for boundary in tempco_evaluate::boundaries(channel, number) {
            rows.push(vec![
                axis_cell(&axis.name, axis.unit),
                cell(format!(
                    "{:.2} to {:.2}",
                    boundary.t_min_c, boundary.t_max_c
                )),
                cell(figure(without_dust(boundary.overlap_mismatch, range))),
                cell(format!(
                    "{:.1} %",
                    100.0 * boundary.overlap_mismatch / range
                )),
                cell(figure(without_dust(boundary.jump, range))),
            ]);
        }
    }
    let head = [
        "axis",
        "overlap [degC]",
        "mismatch",
        "of the bias range",
        "jump in the table",
    ];
    html! {
        @if rows.is_empty() {
            p { "One segment: there are no boundaries." }
        } @else {
            p { "Mismatch: the largest difference of neighbouring polynomials over their overlap. Jump: "
                "the largest step of the table there, at zero, lowest and highest rate, in the core's "
                "own arithmetic." }
            (table(&head, rows))
        }
    }
}

pub(super) fn coverage(set: &CoefficientSet) -> Markup {
    let mut rows = Vec::new();
    for segment in set.channels.iter().flat_map(|channel| &channel.segments) {
        let mut row = vec![
            cell(format!("{:.2} to {:.2}", segment.t_min_c, segment.t_max_c)),
            cell(segment.terms.join(", ")),
            cell(segment.rows),
        ];
        match &segment.coverage {
            Some(coverage) => row.extend([
                cell(format!("{:.2} h", coverage.time_s / 3600.0)),
                cell(format!("{:.0} %", 100.0 * coverage.width)),
                cell(format!(
                    "{:+.2} to {:+.2}",
                    coverage.rate_min_c_per_min, coverage.rate_max_c_per_min
                )),
                cell(figure(coverage.rate_independent_c_per_min)),
                condition(segment),
            ]),
            None => row.extend((0..5).map(|_| dash())),
        }
        rows.push(row);
    }
    let head = [
        "segment [degC]",
        "terms",
        "rows",
        "time",
        "width",
        "rate [degC/min]",
        "spread",
        "condition",
    ];
    html! {
        p { "What each segment was fitted from. Width: share of the segment that its rows span. Spread: "
            "of the part of the rate that does not follow from the temperature [degC/min]; from it the "
            "rate terms are found." }
        (table(&head, rows))
    }
}

/// The condition number; a dash where it was not computed.
fn condition(segment: &SegmentSet) -> Markup {
    match segment.condition {
        0.0 => dash(),
        condition => cell(figure(condition)),
    }
}

/// What is read from the Allan curves.
pub(super) fn allan(evaluation: &Evaluation) -> Markup {
    let mut rows = Vec::new();
    for axis in &evaluation.axes {
        let curves = [
            ("before", &axis.allan.raw),
            ("after", &axis.allan.compensated),
        ];
        for (what, curve) in curves {
            let walk = curve
                .angle_random_walk
                .figure()
                .map(|walk| format!("{} {}", figure(walk.value), axis.allan.random_walk_unit));
            let floor = curve.bias_instability.figure().map(|floor| {
                let limit = if floor.floor_reached { "" } else { "below " };
                format!("{limit}{} {}", figure(floor.value), axis.unit)
            });
            rows.push(vec![
                cell(&axis.axis),
                cell(what),
                walk.map_or_else(dash, cell),
                floor.map_or_else(dash, cell),
            ]);
        }
    }
    table(&["axis", "", "angle random walk", "bias instability"], rows)
}

pub(super) fn models(set: &CoefficientSet) -> Markup {
    let errors: Vec<(&AxisSet, HeldOutErrors)> = axes(set)
        .filter_map(|(_, _, axis)| Some((axis, axis.held_out?)))
        .collect();
    html! {
        section {
            h2 { "Model comparison" }
            @match errors.first() {
                None => p { "This set was not fitted here: no errors on data left out are known." },
                Some((_, first)) => {
                    p { (held_out_caption(first)) "." }
                    (held_out(&errors))
                }
            }
            @for channel in &set.channels {
                @if let Some(selection) = &channel.selection {
                    p { "Lags of " (channel.temperature) ": kappa is the share of a lag that is taken off the "
                        "temperature." }
                    (lag_table(channel))
                    @if !selection.others.is_empty() { p { "Chosen for " (channel.temperature) ": the model of fewest coefficients whose "
                        "held-out mean square is within one standard error of the best." }
                    (candidates(&selection.chosen, &selection.others)) }
                }
            }
        }
    }
}

fn held_out(errors: &[(&AxisSet, HeldOutErrors)]) -> Markup {
    let rows = errors.iter().map(|(axis, errors)| {
        let bar = |error: Option<f64>| {
            let Some(error) = error else {
                return dash();
            };
            let share = (100.0 * error / errors.none).clamp(0.0, 100.0);
            html! { (figure(error)) span.bar { span style=(format!("width:{share:.0}%")) {} } }
        };
        vec![
            axis_cell(&axis.name, axis.unit),
            bar(Some(errors.none)),
            bar(errors.static_model),
            bar(errors.cubic),
            bar(errors.composite),
            bar(errors.chosen),
        ]
    });
    let head = [
        "axis",
        "none",
        "static",
        "one cubic",
        "composite",
        "this model",
    ];
    table(&head, rows.collect())
}

fn lag_table(channel: &ChannelSet) -> Markup {
    let rows = lags(channel).into_iter();
    table(&LAGS, rows.map(|row| row.map(cell).to_vec()).collect())
}

fn candidates(chosen: &Candidate, others: &[Candidate]) -> Markup {
    let row = |(mark, of): (&str, &Candidate)| {
        vec![
            cell(mark),
            cell(of.model.name()),
            cell(of.segments),
            cell(of.place.name()),
            cell(of.columns),
            cell(of.rate_columns),
            cell(format!("{:.0} s", of.tau_s)),
            cell(format!("{:.2}", of.kappa)),
            cell(states(of)),
            cell(format!("{:.2} %", 100.0 * of.excess)),
            cell(format!("{:.2} %", 100.0 * of.excess_sigma)),
        ]
    };
    let others = others.iter().take(SHOWN).map(|other| ("", other));
    let rows = std::iter::once(("chosen", chosen)).chain(others).map(row);
    let head = [
        "",
        "model",
        "segments",
        "place",
        "terms",
        "of rate",
        "tau",
        "kappa",
        "history",
        "above best",
        "s.e.",
    ];
    table(&head, rows.collect())
}
