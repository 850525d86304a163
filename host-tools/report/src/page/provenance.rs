//! What the set was made from, and with which settings.

use maud::{Markup, html};
use tempco_evaluate::{Role, figure};
use tempco_set::{ChannelSet, CoefficientSet, Input};

use super::document::{cell, table};
use crate::Subject;
use crate::text::seconds;

pub(super) fn provenance(subject: &Subject) -> Markup {
    let set = subject.set;
    html! {
        section {
            h2 { "Provenance" }
            dl {
                dt { "Unit" } dd { (set.serial) }
                dt { "Set made by" } dd { (set.provenance.tool) ", " (set.provenance.created) }
                dt { "Table" } dd { "CRC-32P4 " code { (set.table_crc32) } }
                dt { "Model" }
                dd { (set.settings.model.name()) ", overlap " (set.settings.overlap.name()) }
                @if let Some(scale_factor) = set.settings.scale_factor_arcsec {
                    dt { "Scale factor" } dd { (scale_factor) " arcsec per pulse" }
                }
                @if let Some(evaluation) = subject.evaluation {
                    dt { "Judged on" }
                    dd { (evaluation.log.file) ", " (evaluation.log.rows) " rows, "
                        (match evaluation.log.role {
                            Role::Training => "a training log",
                            Role::Verification => "a verification log",
                            Role::Unknown => "perhaps a training log",
                        })
                        ", SHA-256 " code { (evaluation.log.sha256) } }
                }
            }
            h3 { "Fitted to" }
            (inputs(set))
            @for channel in &set.channels { (settings(channel)) }
            (sign_offs(set))
        }
    }
}

fn inputs(set: &CoefficientSet) -> Markup {
    let rows = set.provenance.inputs.iter().map(|input| {
        vec![
            cell(&input.file),
            cell(input.rows),
            cell(skipped(input)),
            cell(input.unusable_rows),
            cell(format!("{} s", figure(input.interval_s))),
            cell(format!("{:.2} h", input.duration_s / 3600.0)),
            html! { code { (input.sha256) } },
        ]
    });
    let head = [
        "file",
        "rows",
        "skipped",
        "not accepted",
        "interval",
        "duration",
        "SHA-256",
    ];
    table(&head, rows.collect())
}

/// Rows left out on reading, with the reasons where they are known.
fn skipped(input: &Input) -> String {
    let reasons = input.skipped.to_string();
    if reasons.is_empty() {
        return input.skipped_rows.to_string();
    }
    format!("{}: {reasons}", input.skipped_rows)
}

fn settings(channel: &ChannelSet) -> Markup {
    let (table, thermal) = (&channel.table, &channel.table.thermal);
    let number = |value: f32| figure(value.into());
    html! {
        h3 { "Settings of " (channel.temperature) }
        dl {
            dt { "Rate estimator" } dd { "tau " (number(thermal.tau_s)) " s, kappa " (thermal.kappa) }
            dt { "Sensor" }
            dd { (number(thermal.sensor_min_c)) " to " (number(thermal.sensor_max_c)) " degC, spikes beyond "
                (number(thermal.spike_gate_c)) " degC, fastest accepted change "
                (number(thermal.max_slew_c_per_min)) " degC/min, held for " (number(thermal.hold_s))
                " s, healed after " (number(thermal.heal_s)) " s" }
            dt { "Table" }
            dd { (table.cells.len()) " cells; " (format!("{:.3} %", 100.0 * channel.table_deviation))
                " of the bias range from the segments at most" }
            @if let Some(outliers) = &channel.outliers {
                dt { "Left out" }
                dd { (outliers.excluded_rows) " rows by request, " (outliers.spike_rows)
                    " spikes, " (outliers.disturbed_rows) " disturbed; " (outliers.steps.len())
                    " steps of a bias found" }
            }
        }
    }
}

fn sign_offs(set: &CoefficientSet) -> Markup {
    let rows: Vec<Vec<Markup>> = set
        .sign_offs
        .iter()
        .map(|sign_off| {
            let outcome = if sign_off.accepted {
                "accepted".to_owned()
            } else {
                format!("rejected: {}", sign_off.reasons())
            };
            vec![
                cell(&sign_off.file),
                cell(&sign_off.judged),
                cell(seconds(sign_off.tau_s)),
                cell(outcome),
                html! { code { (sign_off.sha256) } },
            ]
        })
        .collect();
    html! {
        @if !rows.is_empty() {
            h3 { "Signed off" }
            (table(&["log", "judged", "tau", "outcome", "SHA-256"], rows))
        }
    }
}
