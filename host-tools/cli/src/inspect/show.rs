//! A coefficient set as tables: coefficients, coverage, errors, rounding, boundaries.

use anyhow::Result;
use tempco::Terms;
use tempco_set::{AxisSet, ChannelSet, CoefficientSet, LOCAL_TERMS, TERMS};

use crate::answer::without_rounding;
use crate::output::{figure, print, print_lines, table, without_dust};
use crate::set_tables::{show_choice, show_coverage, show_states};

pub(super) fn show(set: &CoefficientSet) -> Result<()> {
    print(format_args!(
        "unit {}, {} model, {} overlap, table CRC-32P4 {}",
        set.serial,
        set.settings.model.name(),
        set.settings.overlap.name(),
        set.table_crc32
    ))?;
    print(format_args!(
        "made by {} at {}",
        set.provenance.tool, set.provenance.created
    ))?;
    for input in &set.provenance.inputs {
        print(format_args!(
            "  from {} ({} rows, {:.0} s), SHA-256 {}",
            input.file, input.rows, input.duration_s, input.sha256
        ))?;
    }
    for verdict in &set.sign_offs {
        let outcome = if verdict.accepted {
            "accepted".to_owned()
        } else {
            format!("rejected: {}", verdict.reasons())
        };
        print(format_args!(
            "  judged on {} at {}: {outcome}",
            verdict.file, verdict.judged
        ))?;
    }
    set.channels.iter().try_for_each(show_channel)
}

fn show_channel(channel: &ChannelSet) -> Result<()> {
    let data = &channel.table;
    let thermal = &data.thermal;
    // Ranges and the thermal path.
    print(format_args!(
        "\n{}: calibrated {} to {} degC and {} to {} degC/min; rate estimator tau {} s, kappa {}; \
         {} cells of {} degC, {} bytes; {:.3} % from the segments at most",
        channel.temperature,
        data.t_min_c,
        data.t_max_c,
        figure(thermal.rate_min_c_per_min.into()),
        figure(thermal.rate_max_c_per_min.into()),
        thermal.tau_s,
        thermal.kappa,
        data.cells.len(),
        figure(f64::from(data.last_edge_c - data.first_edge_c) / data.cells.len() as f64),
        size_of::<Terms>() * channel.axes.len() * data.cells.len(),
        100.0 * channel.table_deviation,
    ))?;
    // Coefficients by segment, their uncertainty, coverage and choice.
    print(format_args!(
        "\nCoefficients of {} with T in degC and T' in degC/min",
        TERMS.join(", ")
    ))?;
    let rows = by_segment(
        channel,
        |axis| &axis.polynomials,
        |polynomial| polynomial.raw().map(|value| format!("{value:.4e}")),
    );
    let names: Vec<String> = (0..TERMS.len()).map(|term| format!("a{term}")).collect();
    let mut header = vec!["axis", "segment"];
    header.extend(names.iter().map(String::as_str));
    print_lines(table(&header, rows))?;
    show_sigmas(channel)?;
    show_states(channel)?;
    show_coverage(&channel.segments)?;
    show_choice(channel)?;

    show_rounding(channel)?;

    // Boundaries between segments, as fitted and as the table has them.
    let mut rows = Vec::new();
    for (number, axis) in channel.axes.iter().enumerate() {
        let bias_range = data.static_range(number);
        let jump = without_rounding(data.max_jump(number).into(), channel, number);
        for mismatch in channel.mismatches(number) {
            let [largest, at_switch] = [mismatch.overlap_mismatch, mismatch.switch_jump]
                .map(|difference| without_dust(difference, bias_range));
            rows.push(vec![
                format!("{} [{}]", axis.name, axis.unit),
                format!("{:.2}..{:.2}", mismatch.t_min_c, mismatch.t_max_c),
                figure(largest),
                figure(at_switch),
                figure(largest / bias_range),
                figure(jump),
            ]);
        }
    }
    if !rows.is_empty() {
        print("\nDisagreement of neighbouring segments, and the largest jump the table makes")?;
        let header = [
            "axis",
            "overlap",
            "mismatch",
            "in the middle",
            "share of bias range",
            "jump in table",
        ];
        print_lines(table(&header, rows))?;
    }
    Ok(())
}

/// What the core's f32 arithmetic can cost, next to what there is to compensate.
fn show_rounding(channel: &ChannelSet) -> Result<()> {
    let rows = channel.axes.iter().enumerate().map(|(number, axis)| {
        let bound = channel.table.rounding_bound(number);
        vec![
            format!("{} [{}]", axis.name, axis.unit),
            figure(channel.table.static_range(number)),
            format!("{:.1e}", bound.total),
            format!("{:.1e}", bound.edge_c),
        ]
    });
    print("\nBias range, and the most that rounding in f32 can add to it")?;
    let header = [
        "axis",
        "static bias range",
        "rounding bound",
        "edges within [degC]",
    ];
    print_lines(table(&header, rows))
}

/// A row for each axis and segment: the cells of what the axis has for the segment.
fn by_segment<T>(
    channel: &ChannelSet,
    of_axis: impl Fn(&AxisSet) -> &[T],
    cells: impl Fn(&T) -> [String; TERMS.len()],
) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for axis in &channel.axes {
        for (segment, of_segment) in channel.segments.iter().zip(of_axis(axis)) {
            let mut row = vec![
                format!("{} [{}]", axis.name, axis.unit),
                format!("{:.2}..{:.2}", segment.t_min_c, segment.t_max_c),
            ];
            row.extend(cells(of_segment));
            rows.push(row);
        }
    }
    rows
}

/// The uncertainty of each coefficient, in the basis in which the coefficients are independent.
fn show_sigmas(channel: &ChannelSet) -> Result<()> {
    let rows = by_segment(
        channel,
        |axis| &axis.sigmas,
        |sigmas| {
            sigmas.to_array().map(|sigma| match sigma {
                0.0 => "-".to_owned(),
                _ => format!("{sigma:.1e}"),
            })
        },
    );
    if rows.is_empty() {
        return Ok(());
    }
    print(format_args!(
        "\n1 sigma of the coefficients of {}, with z from -1 to 1 over the segment",
        LOCAL_TERMS.join(", ")
    ))?;
    let mut header = vec!["axis", "segment"];
    header.extend(LOCAL_TERMS);
    print_lines(table(&header, rows))
}
