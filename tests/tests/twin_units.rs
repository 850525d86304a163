//! The named units are what their descriptions say, as a calibration sees them.

use serde_json::Value;
use tempco_tests::{Bench, PAPER_SEGMENTS};

const EIGHT_SEGMENTS: &str = "-15:0,-5:12,6:24,18:36,30:48,42:60,54:72,66:80";

/// Sigma of the 100 s means of each axis of a verification run, before and after compensation.
fn sigmas(unit: &str, segments: &str) -> [(f64, f64); 3] {
    let bench = Bench::new();
    bench.ok(&format!(
        "simulate --unit {unit} --profile calibration --seed 1 --out cal.csv"
    ));
    bench.ok(&format!(
        "simulate --unit {unit} --profile verification --seed 2 --out ver.csv"
    ));
    bench.ok(&format!(
        "fit cal.csv --serial S1 --model composite --segments {segments} --out set"
    ));
    let ran = bench.run("evaluate set/coefficients.json ver.csv --json");
    let evaluation: Value = serde_json::from_str(&ran.out).unwrap();
    core::array::from_fn(|axis| {
        let figure = |name: &str| evaluation["axes"][axis][name].as_f64().unwrap();
        let pair = (figure("sigma_raw"), figure("sigma_compensated"));
        println!("{unit} {segments} axis {axis}: {pair:.5?}");
        pair
    })
}

/// Sigma of 100 s means by random walk and counting alone: 0.004 deg/h and 1 / (sqrt(6) 100) pulses/s at
/// 0.5 arcsec per pulse.
const NOISE: f64 = 0.00898;

#[test]
fn smooth_is_fitted_down_to_the_noise() {
    for (raw, compensated) in sigmas("smooth", PAPER_SEGMENTS) {
        assert!(raw > 2.0 * NOISE, "{raw}");
        assert!(compensated < 1.15 * NOISE, "{compensated}");
    }
}

#[test]
fn wavy_has_more_waves_than_four_segments() {
    let four = sigmas("wavy", PAPER_SEGMENTS);
    let eight = sigmas("wavy", EIGHT_SEGMENTS);
    for ((_, four), (_, eight)) in four.into_iter().zip(eight) {
        assert!(four > 1.5 * NOISE, "{four}");
        assert!(eight < 1.35 * NOISE, "{eight}");
    }
}

#[test]
fn hysteretic_keeps_what_no_function_of_temperature_and_rate_can_remove() {
    for (raw, compensated) in sigmas("hysteretic", EIGHT_SEGMENTS) {
        assert!(compensated < 0.5 * raw, "{compensated} {raw}");
        assert!(compensated > 1.2 * NOISE, "{compensated}");
    }
}

#[test]
fn mems_and_fog_put_out_rates_and_gain_by_compensation() {
    for unit in ["mems", "fog"] {
        for (raw, compensated) in sigmas(unit, PAPER_SEGMENTS) {
            assert!(compensated < 0.5 * raw, "{unit}: {compensated} {raw}");
        }
    }
}

#[test]
fn the_paper_s_model_leaves_what_lags_hops_and_loops_make() {
    for unit in ["gradient", "mode_hops", "loop"] {
        for (raw, compensated) in sigmas(unit, PAPER_SEGMENTS) {
            assert!(compensated < 0.8 * raw, "{unit}: {compensated} {raw}");
            assert!(compensated > 1.3 * NOISE, "{unit}: {compensated}");
        }
    }
}

#[test]
fn a_hub_thermometer_costs_more_than_the_noise() {
    // 0.02 deg/h by random walk.
    for (raw, compensated) in sigmas("fibre", PAPER_SEGMENTS) {
        assert!(compensated < 0.6 * raw, "{compensated} {raw}");
        assert!(compensated > 1.2 * 0.02, "{compensated}");
    }
}

#[test]
fn a_drawn_unit_is_another_one_and_its_seed_decides_it() {
    let bench = Bench::new();
    for (file, unit) in [
        ("named.csv", "smooth"),
        ("seven.csv", "smooth --draw 7"),
        ("again.csv", "smooth --draw 7"),
        ("eight.csv", "smooth --draw 8"),
    ] {
        bench.ok(&format!(
            "simulate --unit {unit} --profile short --out {file}"
        ));
    }
    let read = |file: &str| std::fs::read(bench.path(file)).unwrap();
    assert!(read("seven.csv") == read("again.csv"));
    assert!(read("seven.csv") != read("eight.csv"));
    assert!(read("seven.csv") != read("named.csv"));
}
