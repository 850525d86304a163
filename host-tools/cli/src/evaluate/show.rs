//! All tables of an evaluation, of at most 100 columns.

use anyhow::Result;
use comfy_table::Table;
use tempco_evaluate::{AllanCurves, AxisEvaluation, Evaluation, Measured, Role};
use tempco_set::CoefficientSet;

use crate::answer::without_rounding;
use crate::output::{figure, percent, print, print_lines, table, without_dust};
use crate::set_tables::show_coverage;

/// Axes whose Allan curves stand side by side.
const AXES_ABREAST: usize = 3;

pub(super) fn show(set: &CoefficientSet, evaluation: &Evaluation) -> Result<()> {
    let log = &evaluation.log;
    let role = match log.role {
        Role::Training => "training log: the set was fitted to it",
        Role::Verification => "verification log: the set was not fitted to it",
        Role::Unknown => "an image does not say what it was fitted to",
    };
    print(format_args!("\n{} ({} rows), {role}", log.file, log.rows))?;

    print("\nBias stability: sigma of means over tau")?;
    print_lines(stability(&evaluation.axes))?;
    print(format_args!("reference: {}", evaluation.reference))?;
    for axis in &evaluation.axes {
        for at in &axis.bias_stability {
            if let Some(reason) = at.sigma.reason() {
                let (name, tau_s) = (&axis.axis, at.tau_s);
                print(format_args!("not measured: {name} at {tau_s} s: {reason}"))?;
            }
        }
    }

    print(format_args!(
        "\nMeans over {} s: about the mean of the log, and their correlation with temperature",
        evaluation.tau_s
    ))?;
    print_lines(residuals(&evaluation.axes))?;
    print("by chance: |r| with T and with T' stays below it in 99 of 100 logs")?;

    show_hysteresis(&evaluation.axes)?;
    show_allan(&evaluation.axes)?;

    let rows = boundaries(set, &evaluation.axes);
    if !rows.is_empty() {
        print("\nBoundaries between segments")?;
        let header = ["axis", "overlap [degC]", "mismatch", "jump in table"];
        print_lines(table(&header, rows))?;
    }
    let segments = evaluation.segments.iter();
    let mut segments = segments.filter(|segments| !segments.is_empty());
    segments.try_for_each(|s| show_coverage(s))?;
    if !evaluation.status_rows.is_empty() {
        let flags = evaluation.status_rows.iter();
        let flags: Vec<String> = flags.map(|(flag, rows)| format!("{flag} {rows}")).collect();
        print(format_args!("\nrows with status: {}", flags.join(", ")))?;
    }
    Ok(())
}

fn stability(axes: &[AxisEvaluation]) -> Table {
    let mut rows = Vec::new();
    for axis in axes {
        for at in &axis.bias_stability {
            let mut row = vec![
                format!("{} [{}]", axis.axis, axis.unit),
                format!("{} s", figure(at.tau_s)),
                at.n.to_string(),
            ];
            match at.sigma.figure() {
                Some(sigma) => row.extend([
                    figure(sigma.raw),
                    sigma.reference.map_or_else(dash, figure),
                    figure(sigma.compensated),
                    percent(sigma.improvement),
                    sigma.improvement_over_reference.map_or_else(dash, percent),
                ]),
                None => row.extend((0..5).map(|_| dash())),
            }
            rows.push(row);
        }
    }
    let header = [
        "axis",
        "tau",
        "n",
        "raw",
        "reference",
        "comp.",
        "improvement",
        "over reference",
    ];
    table(&header, rows)
}

fn residuals(axes: &[AxisEvaluation]) -> Table {
    let rows = axes.iter().flat_map(|axis| {
        let correlations = [&axis.correlation_raw, &axis.correlation_compensated];
        let figures = [
            ("raw", axis.rmse_raw, axis.max_abs_raw),
            ("comp.", axis.rmse_compensated, axis.max_abs_compensated),
        ];
        correlations
            .into_iter()
            .zip(figures)
            .map(|(correlation, (what, rmse, max_abs))| {
                let r = correlation.figure();
                vec![
                    format!("{} [{}]", axis.axis, axis.unit),
                    what.to_owned(),
                    figure(rmse),
                    figure(max_abs),
                    r.map_or_else(dash, |r| format!("{:+.3}", r.temperature)),
                    r.map_or_else(dash, |r| format!("{:+.3}", r.rate)),
                    r.map_or_else(dash, |r| {
                        format!("{:.2}, {:.2}", r.temperature_chance, r.rate_chance)
                    }),
                ]
            })
    });
    let header = [
        "axis",
        "",
        "RMSE",
        "max |error|",
        "r with T",
        "r with T'",
        "by chance",
    ];
    table(&header, rows)
}

fn show_hysteresis(axes: &[AxisEvaluation]) -> Result<()> {
    print("\nHysteresis: heating minus cooling")?;
    let measured = axes
        .iter()
        .filter_map(|axis| Some((axis, axis.hysteresis.figure()?)));
    let rows: Vec<Vec<String>> = measured
        .clone()
        .map(|(axis, h)| {
            vec![
                format!("{} [{}]", axis.axis, axis.unit),
                h.bins.to_string(),
                figure(h.max_raw),
                figure(h.max_compensated),
                figure(h.rms_raw),
                figure(h.rms_compensated),
            ]
        })
        .collect();
    if !rows.is_empty() {
        let header = [
            "axis",
            "bins",
            "max raw",
            "max comp.",
            "rms raw",
            "rms comp.",
        ];
        print_lines(table(&header, rows))?;
    }
    if let Some((_, h)) = measured.clone().next() {
        print(format_args!(
            "bins of {} degC passed for 30 s or more both ways, at {:.3} degC/min or faster",
            h.bin_c, h.least_rate_c_per_min
        ))?;
    }
    show_reasons(axes, "", |axis| &axis.hysteresis)
}

fn show_allan(axes: &[AxisEvaluation]) -> Result<()> {
    let Some(first) = axes.first() else {
        return Ok(());
    };
    print(format_args!(
        "\nOverlapping Allan deviation over {} rows without a gap, {} s apart",
        first.allan.rows,
        figure(first.allan.interval_s)
    ))?;
    for axes in axes.chunks(AXES_ABREAST) {
        print_lines(allan(axes))?;
    }
    print("1 sigma: of the least certain of the compensated axes")?;
    print_lines(table(
        &[
            "axis",
            "",
            "angle random walk",
            "at tau",
            "bias instability",
            "at tau",
        ],
        axes.iter().flat_map(|axis| {
            let allan = &axis.allan;
            [("raw", &allan.raw), ("comp.", &allan.compensated)]
                .map(|(what, curve)| readings(axis, what, curve))
        }),
    ))?;
    let reached = |axis: &AxisEvaluation| {
        let floors =
            [&axis.allan.raw, &axis.allan.compensated].map(|c| c.bias_instability.figure());
        floors
            .into_iter()
            .flatten()
            .all(|floor| floor.floor_reached)
    };
    if !axes.iter().all(reached) {
        print("<: the floor is not reached, an upper limit")?;
    }
    show_reasons(axes, "angle random walk, raw, of ", |a| {
        &a.allan.raw.angle_random_walk
    })?;
    show_reasons(axes, "angle random walk, comp., of ", |a| {
        &a.allan.compensated.angle_random_walk
    })?;
    show_reasons(axes, "bias instability of ", |a| {
        &a.allan.compensated.bias_instability
    })
}

/// Names the axes for which a value is missing, with the reason.
fn show_reasons<T>(
    axes: &[AxisEvaluation],
    what: &str,
    figure: impl Fn(&AxisEvaluation) -> &Measured<T>,
) -> Result<()> {
    let missing = axes
        .iter()
        .filter_map(|axis| Some((axis.axis.as_str(), figure(axis).reason()?)));
    let names: Vec<&str> = missing.clone().map(|(name, _)| name).collect();
    match missing.map(|(_, reason)| reason).next() {
        Some(reason) => print(format_args!(
            "not measured: {what}{}: {reason}",
            names.join(", ")
        )),
        None => Ok(()),
    }
}

fn allan(axes: &[AxisEvaluation]) -> Table {
    let mut header = vec!["tau [s]".to_owned(), "n".to_owned(), "1 sigma".to_owned()];
    for axis in axes {
        header.push(format!("{} raw", axis.axis));
        header.push(format!("{} comp.", axis.axis));
    }
    let points = axes[0].allan.raw.deviations.len();
    let rows = (0..points).map(|octave| {
        let [raw, compensated] = [0, 1].map(|which| {
            axes.iter().map(move |axis| {
                let curves = [&axis.allan.raw, &axis.allan.compensated];
                curves[which].deviations[octave]
            })
        });
        let first = &axes[0].allan.raw.deviations[octave];
        let edf = compensated.clone().map(|point| point.edf);
        let edf = edf.fold(f64::INFINITY, f64::min);
        let mut row = vec![
            figure(first.tau_s),
            first.n.to_string(),
            format!("{:.1} %", 100.0 / (2.0 * edf).sqrt()),
        ];
        for (raw, compensated) in raw.zip(compensated) {
            row.extend([figure(raw.deviation), figure(compensated.deviation)]);
        }
        row
    });
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    table(&header, rows)
}

fn readings(axis: &AxisEvaluation, what: &str, curve: &AllanCurves) -> Vec<String> {
    let mut row = vec![format!("{} [{}]", axis.axis, axis.unit), what.to_owned()];
    row.extend(curve.angle_random_walk.figure().map_or_else(
        || [dash(), dash()],
        |walk| {
            [
                format!("{} {}", figure(walk.value), axis.allan.random_walk_unit),
                format!("{} s", figure(walk.tau_s)),
            ]
        },
    ));
    row.extend(curve.bias_instability.figure().map_or_else(
        || [dash(), dash()],
        |floor| {
            let limit = if floor.floor_reached { "" } else { "< " };
            [
                format!("{limit}{}", figure(floor.value)),
                format!("{} s", figure(floor.tau_s)),
            ]
        },
    ));
    row
}

fn boundaries(set: &CoefficientSet, axes: &[AxisEvaluation]) -> Vec<Vec<String>> {
    let channels = set.channels.iter();
    let numbered = channels.flat_map(|of| (0..of.axes.len()).map(move |number| (of, number)));
    let mut rows = Vec::new();
    for (axis, (channel, number)) in axes.iter().zip(numbered) {
        let bias_range = channel.table.static_range(number);
        rows.extend(axis.boundaries.iter().map(|boundary| {
            vec![
                format!("{} [{}]", axis.axis, axis.unit),
                format!("{:.2}..{:.2}", boundary.t_min_c, boundary.t_max_c),
                figure(without_dust(boundary.overlap_mismatch, bias_range)),
                figure(without_rounding(boundary.jump, channel, number)),
            ]
        }));
    }
    rows
}

fn dash() -> String {
    "-".to_owned()
}
