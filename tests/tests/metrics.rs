//! `tempco evaluate`: what each figure is, end to end, on logs whose answers are known.

use serde_json::Value;
use tempco_tests::Bench;

/// A log at 1 Hz: four ramps between 10 and 40 degC, two up and two down, at 1 and 0.5 degC/min.
/// x is linear in temperature with a loop of 0.02 between heating and cooling, and noise of 0.002;
/// y is x plus noise of 0.3.
fn ramps(gap: bool) -> String {
    let mut log = "time_s,temp_c,x_dph,y_dph\n".to_owned();
    let (mut temp_c, mut loop_half) = (10.0_f64, 0.0);
    let mut time_s = 0;
    let mut noise = white_noise();
    for rate in [1.0, -1.0, 0.5, -0.5] {
        let rows = (1800.0 / f64::abs(rate)) as i32;
        for _ in 0..rows {
            temp_c += rate / 60.0;
            // The loop closes within minutes of a turn.
            loop_half += (0.01 * rate.signum() - loop_half) / 60.0;
            let x = 0.5 + 0.01 * (temp_c - 25.0) + loop_half + 0.002 * noise();
            let y = x + 0.3 * noise();
            log.push_str(&format!("{time_s},{temp_c:.4},{x:.6},{y:.6}\n"));
            time_s += 1;
        }
        if gap && rate == 0.5 {
            time_s += 10;
        }
    }
    log
}

/// White noise of one standard deviation, evenly distributed.
fn white_noise() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        12.0_f64.sqrt() * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
    }
}

fn fitted(log: &str) -> Bench {
    let bench = Bench::new();
    bench.write("log.csv", log);
    bench.ok("fit log.csv --serial S1 --out static --model static --segments 5:45");
    bench.ok("fit log.csv --serial S1 --out set --model composite --segments 5:45");
    bench
}

fn evaluation(bench: &Bench, args: &str) -> Value {
    serde_json::from_str(&bench.ok(&format!("evaluate {args} --json"))).unwrap()
}

/// The same of a log that rejects the set, since what remains follows the rate.
fn evaluation_with_trend(bench: &Bench, args: &str) -> Value {
    let ran = bench.run(&format!("evaluate {args} --json"));
    assert_eq!(ran.code, 1, "{}", ran.err);
    let found: Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(found["rejections"][0]["code"], "trend_with_rate");
    found
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

#[test]
fn hysteresis_and_correlation_are_those_of_the_log() {
    let bench = fitted(&ramps(false));
    let of_static = evaluation(&bench, "static/coefficients.json log.csv");
    let x = &of_static["axes"][0];
    let hysteresis = &x["hysteresis"];
    assert_eq!(hysteresis["bin_c"], 2.0);
    assert!(number(&hysteresis["bins"]) >= 14.0);
    // The static model takes out the slope and leaves the loop.
    for name in ["max_raw", "rms_raw", "max_compensated", "rms_compensated"] {
        let found = number(&hysteresis[name]);
        assert!((0.015..0.025).contains(&found), "{name}: {found}");
    }
    assert!(number(&x["correlation_raw"]["temperature"]) > 0.95);
    assert!(number(&x["correlation_compensated"]["temperature"]).abs() < 0.05);
    assert!(number(&x["correlation_compensated"]["rate"]) > 0.9);

    // The rate terms take out much of the loop.
    let of_set = evaluation(&bench, "set/coefficients.json log.csv");
    let left = number(&of_set["axes"][0]["hysteresis"]["rms_compensated"]);
    assert!(
        left < 0.5 * number(&hysteresis["rms_compensated"]),
        "{left}"
    );
    let r = number(&of_set["axes"][0]["correlation_compensated"]["rate"]);
    assert!(r.abs() < 0.1, "{r}");
}

#[test]
fn bias_stability_has_its_tau_its_count_and_its_reference() {
    let bench = fitted(&ramps(false));
    let both = evaluation(&bench, "set/coefficients.json log.csv --tau 50");
    for (axis, at) in both["axes"].as_array().unwrap().iter().zip([0, 1]) {
        let taus: Vec<f64> = axis["bias_stability"]
            .as_array()
            .unwrap()
            .iter()
            .map(|at| number(&at["tau_s"]))
            .collect();
        assert_eq!(taus, [10.0, 50.0, 100.0]);
        let stability = &axis["bias_stability"][1];
        assert_eq!(stability["n"], 216);
        assert_eq!(stability["n"], axis["n"]);
        let sigma = &stability["sigma"];
        assert_eq!(sigma["raw"], axis["sigma_raw"]);
        assert_eq!(sigma["compensated"], axis["sigma_compensated"]);
        let [raw, reference, compensated] =
            ["raw", "reference", "compensated"].map(|name| number(&sigma[name]));
        assert!(compensated < reference && reference < raw, "axis {at}");
        let improvement = number(&sigma["improvement_over_reference"]);
        assert!((improvement - (1.0 - compensated / reference)).abs() < 1e-12);
    }
    assert_eq!(both["reference"], "the static part of the set");

    // Against another set, the reference is what that set does on the same log.
    let alone = evaluation(&bench, "static/coefficients.json log.csv");
    let against = evaluation(
        &bench,
        "set/coefficients.json log.csv --against static/coefficients.json",
    );
    assert_eq!(
        against["axes"][0]["bias_stability"][1]["sigma"]["reference"],
        alone["axes"][0]["sigma_compensated"]
    );
    assert!(
        against["reference"]
            .as_str()
            .unwrap()
            .starts_with("the set of unit S1")
    );
    assert!(alone["axes"][0]["bias_stability"][1]["sigma"]["reference"].is_null());
    assert_eq!(alone["reference"], "none: the set makes no use of the rate");
}

#[test]
fn allan_deviations_of_known_noise() {
    let bench = fitted(&ramps(false));
    let evaluation = evaluation(&bench, "set/coefficients.json log.csv");
    let y = &evaluation["axes"][1]["allan"];
    assert_eq!(y["rows"], 10_800);
    assert_eq!(y["interval_s"], 1.0);
    assert_eq!(y["random_walk_unit"], "deg/sqrt(h)");
    let first = &y["compensated"]["deviations"][0];
    assert_eq!(
        (&first["tau_s"], &first["n"]),
        (&1.0.into(), &10_799.into())
    );
    // White noise of 0.3 at 1 Hz falls by the root of the time.
    assert!((number(&first["deviation"]) - 0.3).abs() < 0.01);
    let second = &y["compensated"]["deviations"][1];
    let expected = 0.3 / number(&second["tau_s"]).sqrt();
    assert!((number(&second["deviation"]) - expected).abs() < 0.01);
    let [low, high] = [0, 1].map(|end| number(&first["confidence"][end]));
    assert!(low < number(&first["deviation"]) && number(&first["deviation"]) < high);
    // 0.3 deg/h at 1 s is 0.3/60 deg/sqrt(h).
    let walk = number(&y["compensated"]["angle_random_walk"]["value"]);
    assert!((walk - 0.005).abs() < 2e-4, "{walk}");
    assert!(number(&y["compensated"]["bias_instability"]["value"]) > 0.0);
}

#[test]
fn a_gap_shortens_the_allan_deviation_and_is_said() {
    let bench = fitted(&ramps(true));
    let evaluation = evaluation(&bench, "set/coefficients.json log.csv");
    assert_eq!(evaluation["log"]["rows"], 10_800);
    assert_eq!(evaluation["axes"][0]["allan"]["rows"], 7200);
    let text = bench.ok("evaluate set/coefficients.json log.csv --verbose");
    assert!(
        text.contains("over 7200 rows without a gap, 1.000 s apart"),
        "{text}"
    );
}

#[test]
fn a_log_is_known_by_its_hash() {
    let log = ramps(false);
    let bench = fitted(&log);
    bench.write("renamed.csv", &log);
    bench.write("other.csv", &log.replacen("10.0167", "10.0168", 1));
    for (file, role) in [
        ("log.csv", "training"),
        ("renamed.csv", "training"),
        ("other.csv", "verification"),
    ] {
        let found = evaluation(&bench, &format!("set/coefficients.json {file}"));
        assert_eq!(found["log"]["role"], role, "{file}");
        let text = bench.ok(&format!("evaluate set/coefficients.json {file}"));
        assert!(text.contains(&format!("on {file}, a {role} log")), "{text}");
    }
}

#[test]
fn coverage_and_uncertainties_are_in_the_set() {
    let bench = fitted(&ramps(false));
    let evaluation = evaluation(&bench, "set/coefficients.json log.csv");
    let coverage = &evaluation["segments"][0][0]["coverage"];
    assert_eq!(coverage["time_s"], 10_800.0);
    assert!((number(&coverage["width"]) - 0.75).abs() < 0.01);
    assert!((number(&coverage["rate_max_c_per_min"]) - 1.0).abs() < 0.01);
    assert!((number(&coverage["rate_min_c_per_min"]) + 1.0).abs() < 0.01);
    assert!((0.6..0.8).contains(&number(&coverage["rate_independent_c_per_min"])));
    for axis in evaluation["axes"].as_array().unwrap() {
        let sigmas = &axis["coefficient_sigmas"][0];
        for name in ["a", "r"] {
            for sigma in sigmas[name].as_array().unwrap() {
                assert!((1e-6..1e-1).contains(&number(sigma)), "{sigmas}");
            }
        }
    }
    let text = bench.ok("inspect set/coefficients.json --verbose");
    assert!(text.contains("1 sigma of the coefficients"), "{text}");
    assert!(text.contains("Data of each segment"), "{text}");
}

#[test]
fn what_is_too_short_is_not_measured_and_says_why() {
    let bench = fitted(&ramps(false));
    // Every twentieth row: 10 s means do not exist.
    let log = ramps(false);
    let mut lines = log.lines();
    let sparse = format!(
        "{}\n{}\n",
        lines.next().unwrap(),
        lines.step_by(20).collect::<Vec<_>>().join("\n")
    );
    bench.write("sparse.csv", &sparse);
    let found = evaluation(&bench, "set/coefficients.json sparse.csv");
    let at_10_s = &found["axes"][0]["bias_stability"][0];
    assert_eq!(at_10_s["sigma"]["not_measured"], "rows are 20 s apart");
    let text = bench.ok("evaluate set/coefficients.json sparse.csv --verbose");
    assert!(
        text.contains("not measured: x at 10 s: rows are 20 s apart"),
        "{text}"
    );

    let ran = bench.run("evaluate set/coefficients.json sparse.csv --tau 10");
    assert_eq!(ran.code, 2);
    assert!(
        ran.err.contains("rows are 20 s apart: expected a --tau"),
        "{}",
        ran.err
    );
    let ran = bench.run("evaluate set/coefficients.json log.csv --tau 9000");
    assert_eq!(ran.code, 2);
    assert!(
        ran.err.contains("1 full stretches of 9000 s"),
        "{}",
        ran.err
    );
    let ran = bench.run("evaluate set/coefficients.json log.csv --against none.json");
    assert_eq!(ran.code, 2);
    assert!(ran.err.contains("none.json"), "{}", ran.err);

    // Heating alone has no up-curve and down-curve.
    let up: String = log
        .lines()
        .take(1800)
        .map(|line| format!("{line}\n"))
        .collect();
    bench.write("up.csv", &up);
    let found = evaluation_with_trend(&bench, "set/coefficients.json up.csv");
    let reason = &found["axes"][0]["hysteresis"]["not_measured"];
    assert!(reason.as_str().unwrap().contains("both ways"), "{reason}");
}

#[test]
fn tables_fit_into_100_columns() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 3 --out log.csv");
    bench.ok("fit log.csv --serial S1 --out set --model composite --segments 6:45");
    let text = bench.ok("evaluate set/coefficients.json log.csv --verbose");
    // Messages are whole, on a line each.
    for line in text.lines().filter(|line| !line.starts_with("warning ")) {
        assert!(line.chars().count() <= 100, "{line}");
    }
}

/// Printed coefficients know no rate, but the log has one all the same.
#[test]
fn printed_coefficients_are_judged_too() {
    let bench = Bench::new();
    bench.write(
        "printed.csv",
        "gyro,segment,temp_min_c,temp_max_c,a0_pulses,a1_pulses_per_c,a2_pulses_per_c2\n\
         X,1,5,45,0.25,0.01,0\n",
    );
    bench.write("log.csv", &ramps(false).replace("x_dph", "x_pulses_per_s"));
    let found = evaluation_with_trend(&bench, "printed.csv log.csv");
    let x = &found["axes"][0];
    assert!(number(&x["correlation_compensated"]["rate"]) > 0.9);
    assert!(number(&x["hysteresis"]["rms_compensated"]) > 0.015);
    assert!(found["segments"][0][0]["coverage"].is_null());
    assert_eq!(found["log"]["role"], "verification");
}
