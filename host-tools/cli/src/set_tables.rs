//! Tables of what a set says of its own fit, for `inspect` and `evaluate`.

use anyhow::Result;
use comfy_table::Table;
use tempco_fit::Candidate;
use tempco_fit::set::{ChannelSet, SegmentSet};

use crate::output::{figure, print, table};

/// What each segment was fitted from.
pub(crate) fn show_coverage(segments: &[SegmentSet]) -> Result<()> {
    print("\nWhat each segment was fitted from [degC, degC/min]")?;
    print(coverage(segments))
}

fn coverage(segments: &[SegmentSet]) -> Table {
    let rows = segments.iter().map(|segment| {
        let mut row = vec![
            format!("{:.2}..{:.2}", segment.t_min_c, segment.t_max_c),
            segment.terms.join(" "),
            segment.rows.to_string(),
        ];
        match &segment.coverage {
            Some(coverage) => row.extend([
                format!("{:.2} h", coverage.time_s / 3600.0),
                format!("{:.0} %", 100.0 * coverage.width),
                format!(
                    "{:+.2}..{:+.2}",
                    coverage.rate_min_c_per_min, coverage.rate_max_c_per_min
                ),
                figure(coverage.rate_independent_c_per_min),
            ]),
            None => row.extend(["-"; 4].map(str::to_owned)),
        }
        row.push(if segment.rows > 0 {
            figure(segment.condition)
        } else {
            "-".to_owned()
        });
        row
    });
    let header = [
        "segment",
        "terms",
        "rows",
        "time",
        "width",
        "rate",
        "spread",
        "condition",
    ];
    table(&header, rows)
}

/// Runner-ups that are shown; the set holds all.
const SHOWN: usize = 6;

/// Errors on what was left out of the fit, and from what the model was chosen.
pub(crate) fn show_choice(channel: &ChannelSet) -> Result<()> {
    let held_out = channel
        .axes
        .iter()
        .filter_map(|axis| Some((axis, axis.held_out?)));
    let rows: Vec<Vec<String>> = held_out
        .clone()
        .map(|(axis, errors)| {
            let or_none = |error: Option<f64>| error.map_or_else(|| "-".to_owned(), figure);
            vec![
                format!("{} [{}]", axis.name, axis.unit),
                figure(errors.none),
                or_none(errors.static_model),
                or_none(errors.cubic),
                or_none(errors.composite),
                or_none(errors.chosen),
            ]
        })
        .collect();
    if let Some((_, errors)) = held_out.clone().next() {
        print(format_args!(
            "\nRMS error of means over 10 s that were left out of the fit, in {} parts of {} soaks \
             and ramps",
            errors.folds, errors.legs
        ))?;
        let header = ["axis", "none", "static", "cubic", "composite", "this model"];
        print(table(&header, rows))?;
    }
    if let Some(selection) = &channel.selection {
        print(
            "\nChosen: the model of fewest coefficients whose held-out mean square is within one \
             standard error of the best",
        )?;
        let candidates = std::iter::once(("chosen", &selection.chosen));
        let others = selection.others.iter().map(|other| ("", other));
        let rows = candidates.chain(others.take(SHOWN)).map(candidate);
        let header = [
            "",
            "model",
            "segments",
            "rate",
            "terms",
            "tau",
            "kappa",
            "above best",
            "s.e.",
        ];
        print(table(&header, rows))?;
    }
    Ok(())
}

fn candidate((mark, of): (&str, &Candidate)) -> Vec<String> {
    vec![
        mark.to_owned(),
        of.model.name().to_owned(),
        format!("{} {}", of.segments, of.place.name()),
        of.rate_columns.to_string(),
        of.columns.to_string(),
        format!("{:.0} s", of.tau_s),
        format!("{:.2}", of.kappa),
        format!("{:.2} %", 100.0 * of.excess),
        format!("{:.2} %", 100.0 * of.excess_sigma),
    ]
}
