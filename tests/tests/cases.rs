//! Spoilt and unusual logs, as people reported them in public: each is read right, or refused or
//! rejected with its cause. The script that writes them lies beside the project; the truth is in it.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tempco_log::{ReadOptions, read_log};
use tempco_set::load_set;
use tempco_set::run::apply;
use tempco_tests::{Bench, root, shared};

/// What must come of a log.
#[derive(Clone, Copy, Debug)]
enum Right {
    /// A set that nobody rejects, within this of the truth \[deg/s\], with these warnings.
    Fits(f64, &'static [&'static str]),
    /// A set with these rejections; the exit code is 1.
    Rejected(&'static [&'static str]),
    /// No set; the message names all of this. The exit code is 2.
    Refused(&'static [&'static str]),
}

use Right::{Fits, Refused, Rejected};

/// File, options, what is right.
const CASES: &[(&str, &str, Right)] = &[
    ("saturated_axis/sat3pct.csv", "", Rejected(&["full_scale"])),
    ("saturated_axis/sat8pct.csv", "", Rejected(&["full_scale"])),
    ("saturated_axis/sat27pct.csv", "", Rejected(&["full_scale"])),
    (
        "frozen_axis/gy_freezes.csv",
        "",
        Rejected(&["identical_values"]),
    ),
    (
        "frozen_axis/gy_zero.csv",
        "",
        Rejected(&["identical_values"]),
    ),
    (
        "frozen_temperature/log.csv",
        "",
        Rejected(&["frozen_temperature"]),
    ),
    (
        "running_total/cumulative.csv",
        "",
        Rejected(&["running_total"]),
    ),
    (
        "temperature_folds/fold.csv",
        "",
        Rejected(&["temperature_jump"]),
    ),
    ("temperature_folds/right.csv", "", Fits(0.02, &[])),
    (
        "alternating_sources/log.csv",
        "",
        Rejected(&["alternating_sources"]),
    ),
    (
        "fahrenheit/log.csv",
        "",
        Fits(f64::INFINITY, &["fahrenheit"]),
    ),
    ("bursts/log.csv", "", Fits(0.02, &[])),
    ("microseconds_wrap/log.csv", "", Fits(0.02, &[])),
    ("time_restarts/log.csv", "", Fits(0.02, &[])),
    (
        "one_future_stamp/log.csv",
        "",
        Refused(&[":2002:1:", "93877.3 s between"]),
    ),
    (
        "one_future_stamp/log.csv",
        "--skip-bad-rows",
        Fits(0.02, &[]),
    ),
    ("milliseconds/seconds.csv", "", Fits(0.2, &[])),
];

/// A Python with numpy: the system's, or one that is installed below `target`.
fn python() -> Option<PathBuf> {
    let has_numpy = |python: &Path| {
        let mut import = Command::new(python);
        import
            .args(["-c", "import numpy"])
            .output()
            .is_ok_and(|of| of.status.success())
    };
    let usual = PathBuf::from("python3");
    if has_numpy(&usual) {
        return Some(usual);
    }
    let folder = root().join("target/python");
    let own = folder.join("bin/python");
    if !has_numpy(&own) {
        let done = |command: &mut Command| command.output().is_ok_and(|of| of.status.success());
        let made = done(Command::new(&usual).args(["-m", "venv"]).arg(&folder));
        let install = ["-m", "pip", "install", "--quiet", "numpy==2.3.5"];
        if !made || !done(Command::new(&own).args(install)) {
            println!("skipped: no Python with numpy");
            return None;
        }
    }
    Some(own)
}

/// True bias \[deg/s\] of an axis at a temperature: `bias` and `CURVES` of the script.
fn truth(axis: usize, temp_c: f64) -> f64 {
    let [a, b, c] = [
        [0.5, 0.012, 1.2e-4],
        [-0.3, -0.008, 0.8e-4],
        [0.1, 0.005, -0.5e-4],
    ][axis];
    let d = temp_c - 25.0;
    a + b * d + c * d * d
}

/// Largest distance of a set's bias from the truth at steady temperatures \[deg/s\].
fn error(bench: &Bench, set: &str) -> f64 {
    let set = load_set(&bench.path(set)).unwrap();
    let axes: Vec<String> = set.axes().map(|(_, a)| format!("{}_dps", a.name)).collect();
    let zeros = ",0".repeat(axes.len());
    let at = |temp_c: f64| {
        let text = format!(
            "time_s,temp_c,{}\n0,{temp_c}{zeros}\n1,{temp_c}{zeros}\n",
            axes.join(",")
        );
        bench.write("steady.csv", &text);
        let log = read_log(&bench.path("steady.csv"), &ReadOptions::default()).unwrap();
        let applied = apply(&set, &log).unwrap();
        let biases = applied.axes.iter().map(|axis| f64::from(axis.bias[1]));
        let errors = biases
            .enumerate()
            .map(|(axis, bias)| (bias - truth(axis, temp_c)).abs());
        errors.fold(0.0, f64::max)
    };
    (0..=8)
        .map(|step| at(5.0 * f64::from(step)))
        .fold(0.0, f64::max)
}

/// The codes in a list of a judgement.
fn codes(judgement: &Value, list: &str) -> Vec<String> {
    let found = judgement[list].as_array().expect("a list");
    found
        .iter()
        .map(|of| of["code"].as_str().expect("a code").to_owned())
        .collect()
}

/// What is wrong with how a log is judged; `None` if nothing is.
fn fault(bench: &Bench, logs: &Path, file: &str, options: &str, right: Right) -> Option<String> {
    let log = logs.join(file);
    let _ = std::fs::remove_dir_all(bench.path("set"));
    let fit = format!(
        "fit {} --serial S --out set --no-report --json {options}",
        log.display()
    );
    let ran = bench.run(&fit);
    let found = format!("exit code {}: {}{}", ran.code, ran.out, ran.err);
    let judgement = || serde_json::from_str::<Value>(&ran.out).unwrap_or_default();
    let is_right = match right {
        Refused(words) => ran.code == 2 && words.iter().all(|word| ran.err.contains(word)),
        Rejected(expected) => {
            let codes = if ran.code == 1 {
                codes(&judgement(), "rejections")
            } else {
                Vec::new()
            };
            expected
                .iter()
                .all(|code| codes.iter().any(|found| found == code))
        }
        Fits(most, expected) => {
            let codes = if ran.code == 0 {
                codes(&judgement(), "warnings")
            } else {
                Vec::new()
            };
            let said = expected
                .iter()
                .all(|code| codes.iter().any(|found| found == code));
            ran.code == 0 && said && {
                let error = if most.is_finite() {
                    error(bench, "set/coefficients.json")
                } else {
                    0.0
                };
                if error > most {
                    return Some(format!("{file} {options}: {error} deg/s off\n{found}"));
                }
                true
            }
        }
    };
    (!is_right).then(|| format!("{file} {options}: expected {right:?}\n{found}"))
}

#[test]
fn every_case_is_read_right_or_refused_with_its_cause() {
    let (Some(script), Some(python)) = (shared("cases/make.py"), python()) else {
        return;
    };
    let bench = Bench::new();
    let logs = bench.path("cases");
    let made = Command::new(python)
        .arg(script)
        .arg(&logs)
        .output()
        .unwrap();
    assert!(
        made.status.success(),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
    let faults: Vec<String> = CASES
        .iter()
        .filter_map(|&(file, options, right)| fault(&bench, &logs, file, options, right))
        .collect();
    assert!(
        faults.is_empty(),
        "{} faults\n{}",
        faults.len(),
        faults.join("\n\n")
    );
}
