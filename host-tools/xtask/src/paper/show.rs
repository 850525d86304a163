//! The three tables, those found next to those printed.

use tempco_report::table;

use super::flow::{Outcome, TAU_S};
use super::printed::{SEGMENTS, TABLE_1, TABLE_2, TABLE_3};

const AXES: [&str; 3] = ["X", "Y", "Z"];

/// Column of `auto` in table 3, which is not printed.
const AUTO: usize = 3;

/// Improvements that differ by more are pointed out.
const REMARKABLE: f64 = 0.15;

pub(super) fn tables(outcomes: &[Outcome]) {
    println!(
        "Unit `paper` is simulated: static bias of X and Y from the printed table 2 (Y with the sign\n\
         of the first a2 changed), Z of our own with the printed sigma; noise, lags and chamber runs\n\
         are ours. sigma of {TAU_S} s means in pulses/s, {}.",
        match outcomes.len() {
            1 => "one seed".to_owned(),
            n => format!("mean and sample standard deviation over {n} seeds"),
        }
    );
    table_1(outcomes);
    table_2(outcomes);
    table_3(outcomes);
}

fn table_1(outcomes: &[Outcome]) {
    println!(
        "\nTable 1. Static run, fitted to itself: 11 soaks, 0.2 degC/min between them; overlap blended"
    );
    let rows = (0..3).map(|axis| {
        let mut row = vec![AXES[axis].to_owned()];
        for (column, printed) in TABLE_1[axis].into_iter().enumerate() {
            row.push(format!("{printed:.4}"));
            row.push(cell(outcomes, |o| o.table_1[axis][column]));
        }
        row
    });
    let header = [
        "axis",
        "printed: raw",
        "here",
        "no overlap",
        "here",
        "overlap",
        "here",
    ];
    println!("{}", table(&header, rows));

    println!("\nNot printed: the same models on a second static run, and their boundary jumps");
    let rows = (0..3).map(|axis| {
        vec![
            AXES[axis].to_owned(),
            cell(outcomes, |o| o.unseen[axis][0]),
            cell(outcomes, |o| o.unseen[axis][1]),
            cell(outcomes, |o| o.jumps[axis][0]),
            cell(outcomes, |o| o.jumps[axis][1]),
        ]
    });
    let header = [
        "axis",
        "no overlap",
        "overlap",
        "jump, no overlap",
        "jump, overlap, switched",
    ];
    println!("{}", table(&header, rows));
    for (axis, name) in AXES.iter().enumerate() {
        let per_cent = |from: f64, to: f64| 100.0 * (to / from - 1.0);
        let [_, printed_without, printed_with] = TABLE_1[axis];
        let [without, with] = [0, 1].map(|i| mean(outcomes, |o| o.unseen[axis][i]));
        let [jump_without, jump_with] = [0, 1].map(|i| mean(outcomes, |o| o.jumps[axis][i]));
        println!(
            "{name}: overlap changes sigma by {:+.1} % as printed, {:+.1} % on unseen data here; the \
             jump by {:+.0} %",
            per_cent(printed_without, printed_with),
            per_cent(without, with),
            per_cent(jump_without, jump_with),
        );
    }
    println!(
        "Without overlap each segment is the best fit to its own part of the data; overlap gives up a\n\
         little of that for neighbours that agree. The printed residuals hold more than the noise of\n\
         this unit, 0.005; raw sigmas differ because the printed profile of soaks is not known."
    );
}

fn table_2(outcomes: &[Outcome]) {
    println!(
        "\nTable 2. Static coefficients with overlap, T in degC; farthest: between printed curve\n\
         and ours within the segment"
    );
    let ranges: Vec<(f64, f64)> = SEGMENTS.split(',').filter_map(range).collect();
    let mut rows = Vec::new();
    for (axis, printed) in TABLE_2.iter().enumerate() {
        for (segment, printed) in printed.iter().enumerate() {
            let found = [0, 1, 2].map(|i| mean(outcomes, |o| o.table_2[axis][segment][i]));
            let (low, high) = ranges[segment];
            let mut row = vec![AXES[axis].to_owned(), format!("{low}..{high}")];
            for (printed, found) in printed.iter().zip(found) {
                row.push(format!("{printed:.3e}"));
                row.push(format!("{found:.3e}"));
            }
            row.push(format!("{:.4}", farthest(printed, &found, low, high)));
            rows.push(row);
        }
    }
    let header = [
        "axis", "segment", "a0", "here", "a1", "here", "a2", "here", "farthest",
    ];
    println!("{}", table(&header, rows));
    println!(
        "The unit follows the printed X and Y, blended where segments overlap; there they disagree with\n\
         each other by up to 0.027 (X, 25..35) and 0.020 (Y, 50..60), so that no fit is near both.\n\
         Y, first segment: printed with a minus sign that its own table 1 contradicts. Z: the printed\n\
         segments disagree with each other by up to 0.052, no curve has them; ours is another one."
    );
}

fn table_3(outcomes: &[Outcome]) {
    println!(
        "\nTable 3. Variable-temperature run that no model has seen: 5 to 35 degC at 0.7 to 1.5 degC/min;\n\
         composite model and `--model auto` fitted to the static run and a run at 0.5 to 2 degC/min"
    );
    let rows = (0..3).map(|axis| {
        let mut row = vec![AXES[axis].to_owned()];
        for (column, printed) in TABLE_3[axis].into_iter().enumerate() {
            row.push(format!("{printed:.4}"));
            row.push(cell(outcomes, |o| o.table_3[axis][column]));
        }
        row.push(cell(outcomes, |o| o.table_3[axis][AUTO]));
        row
    });
    let header = [
        "axis",
        "printed: raw",
        "here",
        "static",
        "here",
        "composite",
        "here",
        "auto here",
    ];
    println!("{}", table(&header, rows));
    // The same as improvements.
    let gain = |sigmas: &[f64], model: usize| 1.0 - sigmas[model] / sigmas[0];
    let rows = (0..3).map(|axis| {
        let mut row = vec![AXES[axis].to_owned()];
        for model in [1, 2] {
            row.push(format!("{:+.1} %", 100.0 * gain(&TABLE_3[axis], model)));
            let found = mean(outcomes, |o| gain(&o.table_3[axis], model));
            row.push(format!("{:+.1} %", 100.0 * found));
        }
        let found = mean(outcomes, |o| gain(&o.table_3[axis], AUTO));
        row.push(format!("{:+.1} %", 100.0 * found));
        row
    });
    let header = [
        "improvement",
        "printed: static",
        "here",
        "composite",
        "here",
        "auto here",
    ];
    println!("{}", table(&header, rows));
    // Where this unit and the paper differ, in words.
    for (axis, name) in AXES.iter().enumerate() {
        let [composite, auto] = [2, AUTO].map(|i| mean(outcomes, |o| o.table_3[axis][i]));
        if auto > composite {
            println!(
                "{name}: auto leaves {:.1} % more than the composite model",
                100.0 * (auto / composite - 1.0)
            );
        }
        for (model, what) in [(1, "static"), (2, "composite")] {
            let printed = gain(&TABLE_3[axis], model);
            let found = mean(outcomes, |o| gain(&o.table_3[axis], model));
            if (found - printed).abs() > REMARKABLE {
                println!(
                    "{name}, {what}: {:.0} % printed, {:.0} % here",
                    100.0 * printed,
                    100.0 * found
                );
            }
        }
    }
    println!(
        "After compensation by the composite model the printed sigmas are 0.0187, 0.0193 and 0.0454:\n\
         far above the noise of this unit, 0.005. What remains there does not follow T and T' in the\n\
         way of the model, whatever it is; the simulated unit has no such part, so that its\n\
         improvements are larger."
    );
}

/// The largest difference of two quadratics over a range.
fn farthest(a: &[f64; 3], b: &[f64; 3], low: f64, high: f64) -> f64 {
    let value = |p: &[f64; 3], t: f64| p[0] + t * (p[1] + t * p[2]);
    (0..=100)
        .map(|step| low + (high - low) * f64::from(step) / 100.0)
        .map(|t| (value(a, t) - value(b, t)).abs())
        .fold(0.0, f64::max)
}

fn range(segment: &str) -> Option<(f64, f64)> {
    let (low, high) = segment.split_once(':')?;
    Some((low.parse().ok()?, high.parse().ok()?))
}

fn mean(outcomes: &[Outcome], figure: impl Fn(&Outcome) -> f64) -> f64 {
    outcomes.iter().map(figure).sum::<f64>() / outcomes.len() as f64
}

/// A figure, or mean and sample standard deviation of several.
fn cell(outcomes: &[Outcome], figure: impl Fn(&Outcome) -> f64) -> String {
    let mean = mean(outcomes, &figure);
    if outcomes.len() == 1 {
        return format!("{mean:.4}");
    }
    let squares = outcomes.iter().map(|o| (figure(o) - mean).powi(2));
    let spread = (squares.sum::<f64>() / (outcomes.len() - 1) as f64).sqrt();
    format!("{mean:.4} ±{spread:.4}")
}
