//! `tempco summarise`, and `fit` from what it writes.

use std::fs;

use serde_json::Value;
use tempco_fit::{FitOptions, SegmentModel, fit};
use tempco_log::{ReadOptions, read_log};
use tempco_tests::Bench;
use tempco_twin::UNITS;

/// Two logs of one unit, of pulses.
fn logs() -> Bench {
    let bench = Bench::new();
    for seed in [1, 2] {
        bench.ok(&format!(
            "simulate --unit wavy --profile verification --seed {seed} --rate 0.5 --out {seed}.csv"
        ));
    }
    bench
}

/// The set without the time at which it was made.
fn set(bench: &Bench, folder: &str) -> Value {
    let text = fs::read_to_string(bench.path(folder).join("coefficients.json")).unwrap();
    let mut set: Value = serde_json::from_str(&text).unwrap();
    set["provenance"]["created"] = Value::Null;
    set
}

#[test]
fn a_fit_from_summaries_is_the_fit_from_the_logs() {
    let bench = logs();
    let plan = "--scale-factor 0.5 --tau 50 --exclude 100:400 --rate-tau 90";
    for seed in [1, 2] {
        let out = bench.ok(&format!(
            "summarise {seed}.csv {plan} --out kept/{seed}.summary"
        ));
        assert!(
            out.contains(&format!("wrote kept/{seed}.summary:")),
            "{out}"
        );
    }
    // In either order, and with logs among the summaries. The model is not part of the plan.
    for (model, given) in [
        ("auto", "kept/2.summary kept/1.summary"),
        ("composite", "2.csv kept/1.summary"),
    ] {
        let method = format!("--serial S1 --model {model}");
        bench.ok(&format!("fit 1.csv 2.csv {method} {plan} --out whole"));
        bench.ok(&format!("fit {given} {method} --out {model}"));
        assert_eq!(set(&bench, model), set(&bench, "whole"));
        for file in ["table.bin", "table.h", "table.rs"] {
            let [found, expected] =
                [model, "whole"].map(|folder| fs::read(bench.path(folder).join(file)).unwrap());
            assert!(found == expected, "{file}");
        }
        let report = |folder| fs::read_to_string(bench.path(folder).join("report.html")).unwrap();
        let (whole, kept) = (report("whole"), report(model));
        assert!(kept.contains("figures of rows are left") && !kept.contains("Allan deviation"));
        assert!(kept.contains("Segments and boundaries"));
        assert!(whole.contains("Allan deviation") && !whole.contains("figures of rows"));
    }
}

#[test]
fn what_comes_too_late_for_a_summary_is_refused() {
    let bench = logs();
    bench.ok("summarise 1.csv --out 1.summary");
    bench.ok("summarise 2.csv --tau 50 --out 2.summary");
    let refused = |args: &str, expected: &str| {
        let ran = bench.run(args);
        assert_eq!(ran.code, 2, "{args}: {}", ran.out);
        assert!(ran.err.contains(expected), "{args}: {}", ran.err);
    };
    for option in [
        "--tau 50",
        "--exclude 1:2",
        "--keep-outliers",
        "--max-slew 3",
        "--rate-tau 90",
        "--kappa 0.1",
        "--scale-factor 2",
        "--skip-bad-rows",
        "--time t:s",
    ] {
        let name = option.split(' ').next().unwrap_or_default();
        let expected = format!("expected {name} with `tempco summarise`");
        refused(
            &format!("fit 1.summary --serial S1 {option} --out set"),
            &expected,
        );
    }
    refused(
        "fit 1.summary 2.summary --serial S1 --out set",
        "2.csv: was summarised with another --tau",
    );
    refused("summarise 1.summary --out 3.summary", "is a summary");
    refused("summarise 1.csv --out 1.csv", "is the log");
    refused("evaluate 1.summary 1.csv", "1.summary");
    let mut bytes = fs::read(bench.path("1.summary")).unwrap();
    bytes.truncate(1000);
    fs::write(bench.path("cut.summary"), bytes).unwrap();
    refused(
        "fit cut.summary --serial S1 --out set",
        "cut.summary: 1000 bytes",
    );
    assert!(!bench.path("set").exists());
}

#[test]
fn a_batch_takes_summaries() {
    let bench = logs();
    for seed in [1, 2] {
        bench.ok(&format!(
            "summarise {seed}.csv --out units/U{seed}/run.summary"
        ));
    }
    bench.run("fit --batch units --out sets");
    bench.run("fit 2.csv --serial U2 --out U2");
    assert_eq!(set(&bench, "sets/U2"), set(&bench, "U2"));
    let ran = bench.run("fit --batch units --out others --tau 50");
    assert_eq!(ran.code, 1);
    assert!(ran.err.contains("another --tau"), "{}", ran.err);
}

/// Profiles of a chamber whose logs can be fitted, calibration apart.
const PROFILES: [&str; 9] = [
    "cold_start",
    "cycles",
    "mid_ramp_start",
    "minor_loops",
    "one_rate",
    "static",
    "swing",
    "verification",
    "wandering",
];

#[test]
fn the_command_makes_the_table_of_the_library() {
    let bench = Bench::new();
    let of_units = UNITS.iter().map(|unit| (*unit, "calibration"));
    let kinds: Vec<_> = of_units
        .chain(PROFILES.map(|profile| ("fog", profile)))
        .collect();
    assert_eq!(kinds.len(), 20);
    for (unit, profile) in kinds {
        bench.ok(&format!(
            "simulate --unit {unit} --profile {profile} --rate 0.2 --out log.csv"
        ));
        // Some are rejected; the set is written.
        bench.run("fit log.csv --serial S1 --model composite --no-report --out set");
        let log = read_log(&bench.path("log.csv"), &ReadOptions::default()).unwrap();
        let fitted = fit(&[log], &FitOptions::new("S1", SegmentModel::Composite)).unwrap();
        let by_command = &set(&bench, "set")["table_crc32"];
        assert_eq!(by_command, &fitted.set.table_crc32, "{unit}, {profile}");
    }
}
