//! Tables of the fit that a set came from: coverage, history terms, errors of models, lags.

use anyhow::Result;
use comfy_table::Table;
use tempco_report::{LAGS, gain, held_out_caption, lags, states};
use tempco_set::{Candidate, ChannelSet, HistoryTerm, SegmentSet};

use crate::output::{figure, print, print_lines, table};

/// The data of each segment.
pub(crate) fn show_coverage(segments: &[SegmentSet]) -> Result<()> {
    print("\nData of each segment [degC, degC/min]")?;
    print_lines(coverage(segments))
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
        // Segments that are fitted together have no condition number of their own.
        row.push(match segment.condition {
            0.0 => "-".to_owned(),
            condition => figure(condition),
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

/// History terms with their gains; nothing where there are none.
pub(crate) fn show_states(channel: &ChannelSet) -> Result<()> {
    let mut rows = Vec::new();
    for axis in &channel.axes {
        for (term, found) in channel.history(axis) {
            let sigma = (found.sigma != 0.0).then(|| format!("{:.1e}", found.sigma));
            let [value, sigma] =
                [gain(&found), sigma].map(|text| text.unwrap_or_else(|| "-".to_owned()));
            let term = match term {
                HistoryTerm::Play { half_width_c } => {
                    format!("play, half width {} degC", figure(half_width_c.into()))
                }
                HistoryTerm::SecondLag { tau2_s, limit_c } => format!(
                    "second lag, tau {} s, up to {} degC",
                    figure(tau2_s.into()),
                    figure(limit_c.into())
                ),
            };
            rows.push(vec![
                format!("{} [{}]", axis.name, axis.unit),
                term,
                value,
                sigma,
            ]);
        }
    }
    if rows.is_empty() {
        return Ok(());
    }
    print("\nHistory terms: bias per degC that the part lags behind")?;
    print_lines(table(&["axis", "history term", "gain", "1 sigma"], rows))
}

/// Other candidates that are shown; the set holds all.
const SHOWN: usize = 6;

/// Errors on soaks and ramps left out of the fit, the lags that were found, and the candidates for
/// the model, where there were some.
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
        print(format_args!("\n{}", held_out_caption(&errors)))?;
        let header = ["axis", "none", "static", "cubic", "composite", "this model"];
        print_lines(table(&header, rows))?;
    }
    let Some(selection) = &channel.selection else {
        return Ok(());
    };
    print("\nLags: kappa is the share of a lag that is taken off the temperature")?;
    print_lines(table(&LAGS, lags(channel).into_iter().map(Vec::from)))?;
    if !selection.others.is_empty() {
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
            "history",
            "above best",
            "s.e.",
        ];
        print_lines(table(&header, rows))?;
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
        states(of),
        format!("{:.2} %", 100.0 * of.excess),
        format!("{:.2} %", 100.0 * of.excess_sigma),
    ]
}
