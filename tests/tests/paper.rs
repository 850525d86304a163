//! The printed tables of Weng et al., Sensors 2020, 20(2), 377.

use tempco_evaluate::figure;
use tempco_set::{CoefficientSet, load_set};
use tempco_tests::{Bench, PAPER_TABLE_2, paper_table_2_of_x, shared};

fn assert_mismatches(set: &CoefficientSet, axis: &str, expected: &[f64]) {
    let channel = &set.channels[0];
    let number = channel.axes.iter().position(|a| a.name == axis).unwrap();
    let found = channel.mismatches(number);
    for (found, expected) in found.iter().zip(expected) {
        let error = found.overlap_mismatch / expected - 1.0;
        assert!(error.abs() < 0.05, "{axis}: {found:?}, expected {expected}");
    }
}

#[test]
fn the_printed_coefficients_load_and_z_raises_the_alarm() {
    let bench = Bench::new();
    bench.write("table2.csv", PAPER_TABLE_2);
    let ran = bench.run("inspect table2.csv --verbose");
    assert_eq!(ran.code, 1, "{}", ran.err);
    assert_eq!(ran.err, "table2.csv rejected, segments_disagree: axis z\n");
    let set = load_set(&bench.path("table2.csv")).unwrap();
    assert_mismatches(&set, "x", &[0.0034, 0.0272, 0.0072]);
    assert_mismatches(&set, "z", &[0.0201, 0.0236, 0.0522]);
    for mismatch in set.channels[0].mismatches(0) {
        let shown = figure(mismatch.overlap_mismatch);
        assert!(ran.out.contains(&shown), "{shown} in\n{}", ran.out);
    }

    // X alone is consistent: no alarm.
    bench.write("x.csv", &paper_table_2_of_x());
    bench.ok("inspect x.csv");
}

#[test]
fn the_whole_printed_table_loads() {
    let Some(path) = shared("seed/table2_static_coefficients.csv") else {
        return;
    };
    let bench = Bench::new();
    let ran = bench.run(&format!("inspect {}", path.display()));
    assert_eq!(ran.code, 1, "{}", ran.err);
    let set = load_set(&path).unwrap();
    assert_mismatches(&set, "x", &[0.0034, 0.0272, 0.0072]);
    // Y as printed, with the doubtful sign of its first segment.
    assert_mismatches(&set, "y", &[0.0164, 0.0125, 0.0195]);
}

#[test]
fn the_table_evaluates_to_the_printed_polynomials() {
    let bench = Bench::new();
    bench.write("table2.csv", PAPER_TABLE_2);
    // Slow enough to have no effect of rate; the imported set has none anyway.
    let mut log = "time_s,temp_c,x_pulses_per_s,z_pulses_per_s\n".to_owned();
    for i in 0..=960 {
        log.push_str(&format!(
            "{},{},0,0\n",
            f64::from(i) * 10.0,
            -15.5 + 0.1 * f64::from(i)
        ));
    }
    bench.write("log.csv", &log);
    bench.ok("apply table2.csv log.csv --out out.csv");
    let out = std::fs::read_to_string(bench.path("out.csv")).unwrap();
    let mut checked = 0;
    for line in out.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let temp_c: f64 = cells[1].parse().unwrap();
        let bias: f64 = cells[3].parse().unwrap();
        let [a0, a1, a2] = match temp_c {
            t if (-15.0..5.0).contains(&t) => [0.0173, -0.0014, 1.7535e-5],
            t if (15.0..25.0).contains(&t) => [0.0064, 0.0004, -4.2567e-5],
            t if (35.0..50.0).contains(&t) => [-0.0551, 0.0026, -3.302e-5],
            t if (60.0..=80.0).contains(&t) => [0.3390, -0.0118, 9.6146e-5],
            _ => continue,
        };
        let expected = a0 + a1 * temp_c + a2 * temp_c * temp_c;
        assert!(
            (bias - expected).abs() < 1e-6,
            "{temp_c}: {bias} {expected}"
        );
        checked += 1;
    }
    assert!(checked > 600);
    assert!(out.contains("temperature_clamped"), "-15.5 degC is outside");
}
