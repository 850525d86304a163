//! The main job through the command line: simulate, fit, judge, replay.

use serde_json::Value;
use tempco_tests::{Bench, PAPER_SEGMENTS};

fn evaluation(bench: &Bench, args: &str) -> Value {
    serde_json::from_str(&bench.ok(&format!("evaluate {args} --json"))).unwrap()
}

fn sigma(evaluation: &Value, axis: usize, name: &str) -> f64 {
    evaluation["axes"][axis][name].as_f64().unwrap()
}

/// The log with its x pulses changed.
fn with_x_pulses(log: &str, change: impl Fn(i64) -> i64) -> String {
    let lines = log.lines().map(|line| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if let Ok(pulses) = cells[2].parse() {
            cells[2] = change(pulses).to_string();
        }
        cells.join(",")
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn composite_beats_static_and_static_beats_nothing_on_x() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile calibration --seed 11 --out cal.csv");
    bench.ok("simulate --unit paper --profile verification --seed 12 --out ver.csv");
    for model in ["static", "composite"] {
        bench.ok(&format!(
            "fit cal.csv --serial S1 --model {model} --segments {PAPER_SEGMENTS} --out {model}"
        ));
    }
    // What the static model leaves follows the rate, which rejects.
    let of_static = bench.run("evaluate static/coefficients.json ver.csv --json");
    assert_eq!(of_static.code, 1, "{}", of_static.err);
    let of_static: Value = serde_json::from_str(&of_static.out).unwrap();
    assert_eq!(of_static["rejections"][0]["code"], "trend_with_rate");
    let of_composite = evaluation(&bench, "composite/coefficients.json ver.csv");
    for axis in 0..3 {
        let raw = sigma(&of_composite, axis, "sigma_raw");
        let with_static = sigma(&of_static, axis, "sigma_compensated");
        let with_composite = sigma(&of_composite, axis, "sigma_compensated");
        assert!(
            with_composite < 0.7 * with_static,
            "axis {axis}: {with_composite} {with_static}"
        );
        assert!(with_composite < 0.4 * raw, "axis {axis}");
        let improvement = sigma(&of_composite, axis, "improvement");
        assert!((improvement - (1.0 - with_composite / raw)).abs() < 1e-12);
    }
    assert!(sigma(&of_static, 0, "sigma_compensated") < sigma(&of_static, 0, "sigma_raw"));
    assert_eq!(of_composite["tau_s"], 100.0);
    assert_eq!(of_composite["axes"][0]["axis"], "x");
    assert_eq!(of_composite["axes"][0]["unit"], "pulses_per_s");
    for jump in of_composite["max_boundary_jump"].as_array().unwrap() {
        assert_eq!(jump.as_f64(), Some(0.0), "a blended table has no jumps");
    }
}

#[test]
fn a_worse_set_is_rejected_by_exit_code() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 3 --out log.csv");
    let log = std::fs::read_to_string(bench.path("log.csv")).unwrap();
    // What the set takes out is then what it should put in.
    let turned = with_x_pulses(&log, |pulses| -pulses);
    bench.write("turned.csv", &turned);
    bench.ok("fit log.csv --serial S1 --out set --model composite --segments 6:45");
    bench.ok("evaluate set/coefficients.json log.csv");
    let ran = bench.run("evaluate set/coefficients.json turned.csv");
    assert_eq!(ran.code, 1);
    let said = "rejection no_better_than_none: axis x: ";
    assert!(ran.out.contains(said), "{}", ran.out);
    let said = "set/coefficients.json rejected, no_better_than_none: axis x\n\
                set/coefficients.json rejected, trend_with_rate: axis x\n";
    assert_eq!(ran.err, said);
}

#[test]
fn apply_writes_what_the_core_computes() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 4 --out log.csv");
    bench.ok(
        "fit log.csv --serial S1 --out set --scale-factor 1.5 --model composite --segments 6:45",
    );
    bench.ok("apply set/coefficients.json log.csv --out out.csv");
    let out = std::fs::read_to_string(bench.path("out.csv")).unwrap();
    let mut lines = out.lines();
    assert_eq!(
        lines.next().unwrap(),
        "time_s,temp_c,x_raw_dph,x_bias_dph,x_compensated_dph,y_raw_dph,y_bias_dph,\
         y_compensated_dph,z_raw_dph,z_bias_dph,z_compensated_dph,status"
    );
    let mut rows = 0;
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |cell: usize| cells[cell].parse::<f32>().unwrap();
        assert_eq!(number(4), number(2) - number(3), "{line}");
        let expected = if rows < 359 { "settling" } else { "ok" };
        assert_eq!(cells[11], expected, "row {rows}: {line}");
        rows += 1;
    }
    assert_eq!(rows, 10_801);
}

#[test]
fn the_same_seed_gives_the_same_bytes_throughout() {
    let bench = Bench::new();
    for run in ["a", "b"] {
        bench.ok(&format!(
            "simulate --unit paper --profile short --seed 5 --out {run}.csv --truth {run}.truth.csv"
        ));
        bench.ok(&format!(
            "fit {run}.csv --serial S1 --out {run} --model composite --segments 6:45"
        ));
    }
    let read = |name: &str| std::fs::read(bench.path(name)).unwrap();
    assert_eq!(read("a.csv"), read("b.csv"));
    assert_eq!(read("a.truth.csv"), read("b.truth.csv"));
    assert_eq!(read("a/table.rs"), read("b/table.rs"));
}

#[test]
fn a_damaged_set_is_refused() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 6 --out log.csv");
    bench.ok("fit log.csv --serial S1 --out set --model composite --segments 6:45");
    let json = std::fs::read_to_string(bench.path("set/coefficients.json")).unwrap();
    for (file, change) in [
        ("cell.json", &["cells", "0", "0", "1"][..]),
        ("tau.json", &["thermal", "tau_s"]),
        ("range.json", &["t_max_c"]),
    ] {
        let mut set: Value = serde_json::from_str(&json).unwrap();
        let number = set
            .pointer_mut(&format!("/channels/0/table/{}", change.join("/")))
            .unwrap();
        *number = Value::from(number.as_f64().unwrap() * 0.999);
        bench.write(file, &set.to_string());
    }
    bench.write("cut.json", &json[..json.len() / 2]);
    bench.write(
        "other.json",
        &json.replace("\"format_version\": 2", "\"format_version\": 3"),
    );
    for (file, part) in [
        ("cell.json", "damaged or changed by hand"),
        ("tau.json", "damaged or changed by hand"),
        ("range.json", "damaged or changed by hand"),
        ("cut.json", "expected a coefficient set"),
        (
            "other.json",
            "version 3 of the format: expected 2, or 1 of tempco 0.1",
        ),
        // The words are the system's, the number is that of Unix and Windows.
        ("none.json", "(os error 2)"),
    ] {
        let ran = bench.run(&format!("inspect {file}"));
        assert_eq!(ran.code, 2, "{file}");
        assert!(ran.err.contains(part), "{file}: {}", ran.err);
    }
}

#[test]
fn temperatures_per_axis_are_fitted_and_replayed_apart() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 7 --out log.csv");
    let log = std::fs::read_to_string(bench.path("log.csv")).unwrap();
    let three: Vec<String> = log
        .lines()
        .enumerate()
        .map(|(row, line)| {
            let cells: Vec<&str> = line.split(',').collect();
            let temps = match (row, cells[1].parse::<f64>()) {
                (_, Ok(temp_c)) => format!("{},{},{}", temp_c, temp_c + 0.5, temp_c - 1.0),
                _ => "temp_x_c,temp_y_c,temp_z_c".to_owned(),
            };
            format!("{},{temps},{}", cells[0], cells[2..].join(","))
        })
        .collect();
    bench.write("three.csv", &three.join("\n"));
    bench.ok("fit three.csv --serial S1 --out set --model composite --segments 5:45");
    let out = bench.ok("evaluate set/coefficients.json three.csv --tau 10");
    assert!(out.contains("| z "), "{out}");
    let out = bench.ok("replay set/coefficients.json three.csv --target qemu");
    assert!(out.contains("3 channel(s) of 1 axes"), "{out}");
    assert!(out.contains("0 of 10801 samples differ"), "{out}");
}

#[test]
fn rounding_that_matters_is_warned_of() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 3 --out log.csv");
    let log = std::fs::read_to_string(bench.path("log.csv")).unwrap();
    // So large a constant on x that an f32 of it is coarse beside what is to be removed.
    let shifted = with_x_pulses(&log, |pulses| pulses + 30_000);
    bench.write("shifted.csv", &shifted);
    for (file, warned) in [("log.csv", false), ("shifted.csv", true)] {
        let ran = bench.run(&format!(
            "fit {file} --serial S1 --model composite --segments 5:45 --out {file}.set"
        ));
        assert_eq!(ran.code, 0, "{}", ran.err);
        let said = format!("{}{}", ran.out, ran.err);
        let warning = |axis: &str| said.contains(&format!("axis {axis}: rounding in f32 can cost"));
        assert_eq!(warning("x"), warned, "{file}: {said}");
        assert!(!warning("y"), "{file}: {said}");
        let shown = bench.ok(&format!("inspect {file}.set/coefficients.json --verbose"));
        assert!(shown.contains("rounding bound"), "{shown}");
    }
}
