//! What `fit`, `evaluate` and `inspect` print: an answer of at most 30 lines and 80 columns.

use std::fs;
use std::process::Command;

use serde_json::{Value, json};
use tempco_set::{RejectionCode, WarningCode};
use tempco_tests::{Bench, Ran, tempco_path};

/// Rows between 10 and 40 degC, up and down, for each axis a slope and noise of 0.02 deg/h.
fn log(seed: u32, axes: &[&str], value: impl Fn(usize, f64, u32) -> f64) -> String {
    let names: Vec<String> = axes.iter().map(|axis| format!("{axis}_dph")).collect();
    let mut log = format!("time_s,temp_c,{}\n", names.join(","));
    let mut random = seed;
    let mut noise = || {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        0.04 * (f64::from(random >> 8) / f64::from(1 << 24) - 0.5)
    };
    for row in 0..2000 {
        let phase = f64::from(row) * std::f64::consts::TAU / 1000.0;
        let temp_c = 25.0 - 15.0 * phase.cos();
        log.push_str(&format!("{row},{temp_c:.3}"));
        for axis in 0..axes.len() {
            log.push_str(&format!(",{:.4}", value(axis, temp_c, row) + noise()));
        }
        log.push('\n');
    }
    log
}

fn line(axis: usize, temp_c: f64, _row: u32) -> f64 {
    0.01 * (axis as f64 + 1.0) * temp_c
}

/// Rises twice over the range, with a spike now and then and a step.
fn bad(axis: usize, temp_c: f64, row: u32) -> f64 {
    let saw_tooth = 0.02 * (temp_c - if temp_c < 25.0 { 10.0 } else { 25.0 });
    let spike = if row % 500 == 250 { 9.0 } else { 0.0 };
    let step = if row > 1000 { 0.2 * axis as f64 } else { 0.0 };
    saw_tooth + spike + step
}

/// Axes of units, the last ones with names that take room.
const UNITS: [&[&str]; 4] = [
    &["x"],
    &["x", "y", "z"],
    &["gx", "gy", "gz", "ax", "ay", "az"],
    &["gyro_left_hand_side", "gyro_right_hand_side", "gyro_up"],
];

/// The answer, after a look at its form.
fn answer(ran: &Ran, verdict: &str) -> String {
    let lines: Vec<&str> = ran.out.lines().collect();
    assert!(lines.len() <= 30, "{} lines\n{}", lines.len(), ran.out);
    for line in &lines {
        assert!(line.chars().count() <= 80, "{line}\n{}", ran.out);
        assert!(!line.contains('\u{1b}'), "{line:?}");
    }
    let start = format!("verdict: {verdict}");
    assert!(ran.out.starts_with(&start), "{}", ran.out);
    let header = "| axis";
    let tables = lines.iter().filter(|line| line.starts_with(header));
    assert_eq!(tables.count(), 1, "{}", ran.out);
    let is_reason = |line: &&&str| line.starts_with("rejection ") || line.starts_with("warning ");
    let last_reason = lines.iter().rposition(|line| is_reason(&line)).unwrap_or(0);
    let table = lines
        .iter()
        .position(|line| line.starts_with(header))
        .unwrap();
    assert!(last_reason < table, "{}", ran.out);
    let is_rejected = verdict.starts_with("rejected");
    assert_eq!(ran.code, i32::from(is_rejected), "{}", ran.out);
    ran.out.clone()
}

#[test]
fn an_answer_fits_on_a_screen_whatever_the_verdict() {
    for axes in UNITS {
        let bench = Bench::new();
        bench.write("log.csv", &log(1, axes, line));
        bench.write("ver.csv", &log(2, axes, line));
        bench.write(
            "turned.csv",
            &log(3, axes, |axis, t, row| -line(axis, t, row)),
        );
        bench.write("bad.csv", &log(4, axes, bad));
        let fit = "--serial S1 --model static --tau 10 --out set --segments 10:25.5,24.5:40";

        let fitted = answer(
            &bench.run(&format!("fit log.csv {fit}")),
            "accepted, not yet verified",
        );
        assert!(
            fitted.contains("wrote set: coefficients.json, table.bin"),
            "{fitted}"
        );
        let set = "set/coefficients.json";
        let evaluate = format!("evaluate {set} ver.csv --tau 10");
        let judged = answer(&bench.run(&evaluate), "accepted, verified");
        assert!(
            judged.contains("on ver.csv, a verification log"),
            "{judged}"
        );
        for axis in axes {
            assert!(
                judged.contains(&format!("| {}", &axis[..axis.len().min(3)])),
                "{judged}"
            );
        }
        let page = bench.run(&format!("{evaluate} --report page.html"));
        assert!(answer(&page, "accepted").ends_with("wrote page.html\n"));
        answer(
            &bench.run(&format!("{evaluate} --against {set}")),
            "accepted",
        );
        answer(
            &bench.run(&format!("inspect {set}")),
            "accepted, not yet verified",
        );

        let turned = bench.run(&format!("evaluate {set} turned.csv --tau 10"));
        let rejected = answer(&turned, "rejected\nrejection no_better_than_none: ax");
        assert_eq!(
            rejected.matches("no_better_than_none").count(),
            1,
            "{rejected}"
        );
        // One line for each code: no help, and a trend.
        assert_eq!(turned.err.lines().count(), 2, "{}", turned.err);
        let training = bench.run(&format!("evaluate {set} log.csv --tau 10"));
        let training = answer(&training, "accepted, not yet verified");
        assert!(
            training.contains("on log.csv, a training log"),
            "{training}"
        );

        let fitted = bench.run(&format!("fit bad.csv {fit}"));
        let fitted = answer(&fitted, "rejected, not yet verified");
        for code in ["many_bias_steps", "spikes"] {
            assert!(fitted.contains(code), "{code}: {fitted}");
        }
        answer(
            &bench.run(&format!("inspect {set}")),
            "rejected, not yet verified",
        );
    }
}

/// A set with every warning and rejection that there is, on every axis, each with a long message.
#[test]
fn no_code_is_lost_in_the_worst_case() {
    for axes in UNITS {
        let bench = Bench::new();
        bench.write("log.csv", &log(1, axes, line));
        bench.write("ver.csv", &log(2, axes, line));
        let fit = "fit log.csv --serial S1 --tau 10 --out set --segments 10:25.5,24.5:40";
        bench.ok(&format!("{fit} --model static"));
        let text = fs::read_to_string(bench.path("set/coefficients.json")).unwrap();
        let mut set: Value = serde_json::from_str(&text).unwrap();
        let mut warnings = Vec::new();
        for code in WarningCode::ALL {
            for axis in axes {
                let found = format!("{axis} {}", "and much to be said of it ".repeat(8));
                let message = format!("axis {axis}: {found}");
                warnings.push(json!({"code": code.name(), "axis": axis, "message": message}));
            }
        }
        let sign_off = json!({"file": "old.csv", "sha256": "00", "judged": "2020-01-01T00:00:00Z",
            "tau_s": 10.0, "accepted": false, "worse_axes": axes, "warnings": warnings});
        set["sign_offs"] = json!([sign_off]);
        bench.write("set.json", &set.to_string());
        for command in ["inspect set.json", "evaluate set.json ver.csv --tau 10"] {
            let out = answer(&bench.run(command), "rejected\n");
            let words: Vec<&str> = out.split([' ', ',', ':', '\n']).collect();
            let codes = WarningCode::ALL.iter().map(|code| code.name());
            for code in codes.chain([RejectionCode::NoBetterThanNone.name()]) {
                let count = words.iter().filter(|word| **word == code).count();
                assert_eq!(count, 1, "{code}\n{out}");
            }
            assert!(out.contains("--verbose"), "{out}");
            let in_full = bench.run(&format!("{command} --verbose")).out;
            let messages = in_full.matches("and much to be said of it ").count();
            assert_eq!(messages, 8 * axes.len() * WarningCode::ALL.len());
        }
    }
}

#[test]
fn only_a_terminal_has_colours() {
    let bench = Bench::new();
    bench.write("log.csv", &log(1, &["x"], line));
    bench.ok("fit log.csv --serial S1 --tau 10 --out set --model composite --segments 10:40");
    let out = |variables: &[(&str, &str)]| {
        let mut command = Command::new(tempco_path());
        command
            .current_dir(bench.path(""))
            .args(["inspect", "set/coefficients.json"])
            .env_remove("NO_COLOR")
            .env_remove("CLICOLOR_FORCE")
            .envs(variables.iter().copied());
        let output = command.output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let plain = out(&[]);
    assert!(!plain.contains('\u{1b}'), "{plain:?}");
    // As on a terminal: the word of the verdict, and nothing else.
    let coloured = out(&[("CLICOLOR_FORCE", "1")]);
    let (first, rest) = coloured.split_once('\n').unwrap();
    assert!(
        first.contains("\u{1b}[32m") && !rest.contains('\u{1b}'),
        "{coloured:?}"
    );
    assert_eq!(out(&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]), plain);
}

/// A spline meets itself but for the last bits.
#[test]
fn rounding_dust_is_shown_as_0() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 1 --out log.csv");
    bench.ok("fit log.csv --serial S1 --model auto --out set");
    for command in [
        "inspect set/coefficients.json",
        "evaluate set/coefficients.json log.csv",
    ] {
        let out = bench.ok(command);
        let in_full = bench.ok(&format!("{command} --verbose"));
        for text in [&out, &in_full] {
            let dust = (10..30).find(|power| text.contains(&format!("e-{power}")));
            assert_eq!(dust, None, "{text}");
        }
        if command.starts_with("inspect") {
            let note = out.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(
                note.contains("disagree by up to 0 % of the bias range"),
                "{out}"
            );
        }
    }
}

/// The examples of the help, those that need no unit and no compiler, in an order in which each
/// finds the files of the ones before.
#[test]
fn the_examples_of_the_help_work() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile verification --seed 2 --out verification.csv");
    for command in ["simulate", "fit", "evaluate", "inspect", "apply"] {
        let help = bench.ok(&format!("{command} --help"));
        let mut lines = help.lines();
        let example = lines.find_map(|line| line.strip_prefix("Example: tempco "));
        bench.ok(example.unwrap());
    }
}
