//! `tempco inspect`: what is in a coefficient set.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use serde_json::{Value, json};
use tempco::Terms;
use tempco_evaluate::{boundaries, judge};
use tempco_set::{
    ChannelSet, CoefficientSet, Judgement, LOCAL_TERMS, RejectionCode, TERMS, read_set,
};

use crate::Exit;
use crate::image;
use crate::judgement::{self, say_rejections};
use crate::output::{figure, print, print_lines, table};
use crate::set_tables::{show_choice, show_coverage, show_states};

/// Show a coefficient set: segments, ranges, mismatches, jumps, CRC, provenance
///
/// Also reads printed static coefficients from CSV (gyro, segment, temp_min_c, temp_max_c,
/// a0_pulses, ...), and flash images, which it can compare with the set they are made from. Exits
/// with 1 where the set is rejected, where an image is not that of the set, and where the files in
/// the folder of the set are not of one set.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Coefficient set (coefficients.json, or printed coefficients as .csv) or flash image (.bin)
    #[arg(value_name = "SET")]
    set: PathBuf,
    /// Of a flash image: the coefficients.json it should be made from
    #[arg(long, value_name = "SET")]
    against: Option<PathBuf>,
    /// Print one JSON object instead of tables: the set and what is derived from it
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    if image::is_image(&args.set) {
        ensure!(!args.json, "--json: expected with a coefficient set only");
        return image::inspect(&args.set, args.against.as_deref());
    }
    ensure!(
        args.against.is_none(),
        "--against: expected with a flash image (.bin) only"
    );
    let set = read_set(&args.set)?;
    let judgement = judge(&set, None);
    if args.json {
        judgement::print_as_json(derived(&set, &judgement), &judgement)?;
    } else {
        show(&set)?;
        judgement::show(&judgement)?;
    }
    say_rejections(args.set.display(), &judgement);
    let is_whole = image::is_folder_whole(&args.set);
    Ok(Exit::of(judgement.is_accepted() && is_whole))
}

/// The set with what follows from it.
fn derived(set: &CoefficientSet, judgement: &Judgement) -> Value {
    let of_channel = |channel: &ChannelSet| {
        let axes = channel.axes.iter().enumerate().map(|(number, axis)| {
            json!({
                "axis": axis.name,
                "unit": axis.unit,
                "static_range": channel.table.static_range(number),
                "rounding_bound": channel.table.rounding_bound(number).total,
                "max_jump": channel.table.max_jump(number),
                "boundaries": boundaries(channel, number),
            })
        });
        json!({"temperature": channel.temperature, "axes": axes.collect::<Vec<_>>()})
    };
    let channels: Vec<Value> = set.channels.iter().map(of_channel).collect();
    let rejections = judgement.rejections.iter();
    let alarms = rejections.filter(|of| of.code == RejectionCode::SegmentsDisagree);
    let alarms: Vec<_> = alarms.map(|of| of.axis.as_deref()).collect();
    json!({
        "set": set,
        "rejected": !judgement.is_accepted(),
        "alarms": alarms,
        "channels": channels,
    })
}

fn show(set: &CoefficientSet) -> Result<()> {
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
            format!(
                "rejected: no better than none on {}",
                verdict.worse_axes.join(", ")
            )
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
    print(format_args!(
        "\nCoefficients of {} with T in degC and T' in degC/min",
        TERMS.join(", ")
    ))?;
    let mut rows = Vec::new();
    for axis in &channel.axes {
        for (segment, polynomial) in channel.segments.iter().zip(&axis.polynomials) {
            let mut row = vec![
                format!("{} [{}]", axis.name, axis.unit),
                format!("{:.2}..{:.2}", segment.t_min_c, segment.t_max_c),
            ];
            row.extend(polynomial.raw().map(|value| format!("{value:.4e}")));
            rows.push(row);
        }
    }
    let names: Vec<String> = (0..TERMS.len()).map(|term| format!("a{term}")).collect();
    let mut header = vec!["axis", "segment"];
    header.extend(names.iter().map(String::as_str));
    print_lines(table(&header, rows))?;
    show_sigmas(channel)?;
    show_states(channel)?;
    show_coverage(&channel.segments)?;
    show_choice(channel)?;

    show_rounding(channel)?;

    let mut rows = Vec::new();
    for (number, axis) in channel.axes.iter().enumerate() {
        for mismatch in channel.mismatches(number) {
            rows.push(vec![
                format!("{} [{}]", axis.name, axis.unit),
                format!("{:.2}..{:.2}", mismatch.t_min_c, mismatch.t_max_c),
                format!("{:.4}", mismatch.overlap_mismatch),
                format!("{:+.4}", mismatch.switch_jump),
                figure(mismatch.overlap_mismatch / data.static_range(number)),
                figure(data.max_jump(number).into()),
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

/// What the core's f32 arithmetic can cost, beside what there is to compensate.
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

/// The uncertainty of each coefficient, in the basis in which the coefficients are independent.
fn show_sigmas(channel: &ChannelSet) -> Result<()> {
    let mut rows = Vec::new();
    for axis in &channel.axes {
        for (segment, sigmas) in channel.segments.iter().zip(&axis.sigmas) {
            let mut row = vec![
                format!("{} [{}]", axis.name, axis.unit),
                format!("{:.2}..{:.2}", segment.t_min_c, segment.t_max_c),
            ];
            row.extend(sigmas.to_array().map(|sigma| match sigma {
                0.0 => "-".to_owned(),
                _ => format!("{sigma:.1e}"),
            }));
            rows.push(row);
        }
    }
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
