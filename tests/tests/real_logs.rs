//! Measured logs of others, where they are present: the whole chain, and known figures.

use tempco::{Thermal, ThermalSettings};
use tempco_fit::log::{Log, ReadOptions, read_log};
use tempco_fit::rfactor::RFactor;
use tempco_fit::thermal_points;
use tempco_tests::{Bench, shared};

/// Runs a log through every command and returns what `fit` printed.
fn whole_chain(name: &str, tau_s: &str) -> Option<String> {
    let log = shared(&format!("data/{name}"))?;
    let log = log.display();
    let bench = Bench::new();
    let fitted = bench.ok(&format!("fit {log} --serial REAL --out set --tau {tau_s}"));
    bench.ok(&format!("apply set/coefficients.json {log} --out out.csv"));
    bench.ok(&format!(
        "evaluate set/coefficients.json {log} --tau {tau_s}"
    ));
    bench.ok("inspect set/coefficients.json");
    let rows = std::fs::read_to_string(bench.path("out.csv"))
        .unwrap()
        .lines()
        .count()
        - 1;
    for board in ["mps2-an386", "stm32f405"] {
        let out = bench.ok(&format!(
            "replay set/coefficients.json {log} --target qemu --board {board}"
        ));
        let expected = format!("0 of {rows} samples differ between host and {board}");
        assert!(out.contains(&expected), "{out}");
    }
    Some(fitted)
}

#[test]
fn a_chamber_cycle_goes_through_every_command() {
    let Some(fitted) = whole_chain("tofupilot_imu_chamber_cycle.csv", "10.114") else {
        return;
    };
    println!("{fitted}");
    assert!(fitted.contains("4 segments"), "{fitted}");
}

#[test]
fn a_cold_start_goes_through_every_command() {
    let Some(fitted) = whole_chain("freeimu_mpu6050_cold_start.csv", "100") else {
        return;
    };
    println!("{fitted}");
    assert!(fitted.contains("1 segments"), "{fitted}");
}

/// Means over 20 rows: temperature, rate and the values of all axes.
fn means_of_20(log: &Log, tau_s: f32) -> Vec<(f64, f64, Vec<f64>)> {
    let thermal = Thermal::new(ThermalSettings {
        tau_s,
        rate_min_c_per_min: -100.0,
        rate_max_c_per_min: 100.0,
        ..ThermalSettings::DEFAULT
    })
    .unwrap();
    let points = thermal_points(log, 0, &thermal);
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / 20.0;
    (0..log.rows() / 20)
        .map(|block| {
            let rows = 20 * block..20 * block + 20;
            let channel = &log.channels[0];
            (
                mean(&mut rows.clone().map(|row| f64::from(channel.temp_c[row]))),
                mean(
                    &mut rows
                        .clone()
                        .map(|row| f64::from(points[row].rate_c_per_min)),
                ),
                channel
                    .axes
                    .iter()
                    .map(|axis| mean(&mut rows.clone().map(|row| axis.raw[row])))
                    .collect(),
            )
        })
        .collect()
}

/// The residuals that the note beside the log gives for a cubic in T, and for the same with T' and
/// T T', on means of 20 rows. The rate is the core's causal estimate; the note's is not causal, so
/// a short time constant comes nearest to it.
#[test]
fn the_published_residuals_of_the_chamber_cycle_are_reproduced() {
    let Some(path) = shared("data/tofupilot_imu_chamber_cycle.csv") else {
        return;
    };
    let log = read_log(&path, &ReadOptions::default()).unwrap();
    let cubic = [0.00414, 0.00088, 0.00139, 0.0056, 0.0170, 0.0439];
    let with_rate = [0.00303, 0.00065, 0.00134, 0.0025, 0.0067, 0.0171];
    let mut factor = RFactor::new(6, 6);
    for (temp_c, rate, raw) in means_of_20(&log, 20.0) {
        let z = (temp_c - 28.0) / 46.0;
        let regressors = [1.0, z, z * z, z * z * z, rate, z * rate];
        factor.push(regressors.into_iter().chain(raw));
    }
    for (terms, published) in [(4, cubic), (6, with_rate)] {
        let found = factor.solve(terms).unwrap().rms;
        println!("{terms} terms: {found:.5?}, published {published:?}");
        for (found, published) in found.iter().zip(published) {
            assert!(
                (found / published - 1.0).abs() < 0.15,
                "{terms} terms: {found} against {published}"
            );
        }
    }
}
