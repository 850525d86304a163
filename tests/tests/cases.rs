//! Spoilt and unusual logs, as people reported them in public: each is read right, or refused or
//! rejected with its cause. The script that writes them is not part of the project; it holds the truth.

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
    // Signals that are not a bias.
    ("saturated_axis/sat3pct.csv", "", Rejected(&["full_scale"])),
    ("saturated_axis/sat8pct.csv", "", Rejected(&["full_scale"])),
    ("saturated_axis/sat27pct.csv", "", Rejected(&["full_scale"])),
    (
        "rotated_during_run/carried.csv",
        "",
        Fits(0.02, &["spikes"]),
    ),
    (
        "rotated_during_run/turntable.csv",
        "",
        Rejected(&["disturbed_share"]),
    ),
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
    ("power_cycle_inside/run1.csv", "", Fits(0.02, &[])),
    (
        "power_cycle_inside/concatenated.csv",
        "",
        Fits(ANY, &["bias_step"]),
    ),
    // Temperatures that are not the part's.
    (
        "temperature_folds/fold.csv",
        "",
        Rejected(&["temperature_jump"]),
    ),
    ("temperature_folds/right.csv", "", Fits(0.03, &[])),
    ("fahrenheit/log.csv", "", Fits(ANY, &["fahrenheit"])),
    // Time.
    (
        "milliseconds/millis.csv",
        "",
        Refused(&["`GyX` has no unit", "--axis"]),
    ),
    ("milliseconds/millis.csv", MILLIS, Fits(0.2, &[])),
    ("milliseconds/seconds.csv", "", Fits(0.2, &[])),
    ("microseconds_wrap/log.csv", "", Fits(0.02, &[])),
    ("time_restarts/log.csv", "", Fits(0.02, &["time_restarts"])),
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
    ("bursts/log.csv", "", Fits(0.02, &[])),
    (
        "alternating_sources/log.csv",
        "",
        Rejected(&["alternating_sources"]),
    ),
    (
        "alternating_sources/log.csv",
        "--where I=0",
        Fits(0.02, &[]),
    ),
    // Thin runs.
    ("three_minutes/log.csv", "", Rejected(&["thin_run"])),
    ("hot_air_gun/log.csv", "", Rejected(&["thin_run"])),
    // Files as loggers write them.
    ("px4_csv/log_sensor_gyro_0.csv", "", Fits(ANY, &[])),
    (
        "ardupilot_csv/log.csv",
        "--instance 0",
        Fits(ANY, &["own_correction"]),
    ),
    (
        "ardupilot_csv/log.csv",
        "--where I=0",
        Fits(ANY, &["own_correction"]),
    ),
    ("raw_counts/log.csv", "", Refused(&["`gyx` has no unit"])),
    ("raw_counts/log.csv", COUNTS, Fits(0.02, &[])),
    ("european_spreadsheet/log.csv", "", Fits(0.02, &[])),
    ("european_spreadsheet/brackets.csv", "", Fits(0.02, &[])),
    (
        "clock_times/iso.csv",
        "",
        Refused(&["`gx` has no unit", "--temp"]),
    ),
    ("clock_times/iso.csv", CLOCK, Fits(ANY, &[])),
    ("blank_temperatures/log.csv", "", Fits(0.02, &[])),
    ("two_imus_wide/log.csv", "", Fits(ANY, &[])),
    (
        "temperature_in_another_file/gyroscope.csv",
        "",
        Refused(&["--join"]),
    ),
    (
        "temperature_in_another_file/gyroscope.csv",
        "--join temperature.csv",
        Fits(0.02, &[]),
    ),
];

/// Units that are not deg/s, or no truth to compare with.
const ANY: f64 = f64::INFINITY;

const MILLIS: &str = "--temp Temp:degc --axis gx=GyX:dps --axis gy=GyY:dps --axis gz=GyZ:dps";

const COUNTS: &str = "--temp tmp*0.0029411765+36.53:degc --axis gx=gyx*0.0076335878:dps \
                      --axis gy=gyy*0.0076335878:dps --axis gz=gyz*0.0076335878:dps";

const CLOCK: &str = "--time timestamp:iso --temp temperature:degc --axis gx=gx:radps \
                     --axis gy=gy:radps --axis gz=gz:radps";

/// Set and log of it, a second log, and the rejections there.
const SECOND_LOGS: &[(&str, &str, &[&str])] = &[
    (
        "temperature_formula_changed/before.csv",
        "temperature_formula_changed/after.csv",
        &["trend_with_temperature"],
    ),
    ("bursts/log.csv", "bursts/verification.csv", &[]),
    (
        "power_cycle_inside/run1.csv",
        "power_cycle_inside/run2.csv",
        &[],
    ),
    (
        "milliseconds/seconds.csv",
        "saturated_axis/sat8pct.csv",
        &["full_scale"],
    ),
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

/// The script's cases in a folder; `None` where script or Python are absent.
fn made(bench: &Bench) -> Option<PathBuf> {
    let (script, python) = (shared("cases/make.py")?, python()?);
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
    // A joined log lies where the command runs.
    let temperatures = logs.join("temperature_in_another_file/temperature.csv");
    std::fs::copy(temperatures, bench.path("temperature.csv")).unwrap();
    Some(logs)
}

#[test]
fn every_case_is_read_right_or_refused_with_its_cause() {
    let bench = Bench::new();
    let Some(logs) = made(&bench) else {
        return;
    };
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

#[test]
fn second_logs_are_judged_right() {
    let bench = Bench::new();
    let Some(logs) = made(&bench) else {
        return;
    };
    for (number, (first, second, expected)) in SECOND_LOGS.iter().enumerate() {
        let (first, second) = (logs.join(first), logs.join(second));
        bench.ok(&format!(
            "fit {} --serial S --out {number} --no-report",
            first.display()
        ));
        let evaluate = format!(
            "evaluate {number}/coefficients.json {} --json",
            second.display()
        );
        let ran = bench.run(&evaluate);
        assert_eq!(
            ran.code,
            i32::from(!expected.is_empty()),
            "{}{}",
            ran.out,
            ran.err
        );
        let found = codes(&serde_json::from_str(&ran.out).unwrap(), "rejections");
        for code in *expected {
            assert!(found.iter().any(|of| of == code), "{code}: {found:?}");
        }
    }
}

/// An accelerometer keeps gravity: fitted level, then tilted by 30 degrees at 45 degC.
#[test]
fn gravity_stays() {
    let bench = Bench::new();
    let Some(logs) = made(&bench) else {
        return;
    };
    let of = |name: &str| {
        logs.join("accelerometer_at_one_g")
            .join(name)
            .display()
            .to_string()
    };
    bench.ok(&format!(
        "fit {} --serial S --out set --no-report",
        of("level.csv")
    ));
    bench.ok(&format!(
        "apply set/coefficients.json {} --out out.csv",
        of("tilted30.csv")
    ));
    let mut rows = csv::Reader::from_path(bench.path("out.csv")).unwrap();
    let header = rows.headers().unwrap().clone();
    let column = header
        .iter()
        .position(|name| name.starts_with("az_compensated"))
        .unwrap();
    let values = rows
        .records()
        .map(|row| row.unwrap()[column].parse::<f64>().unwrap());
    let values: Vec<f64> = values.collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    assert!((mean + 8.5).abs() < 0.06, "{mean}");
}
