//! Measured logs of others, where they are present: the whole chain, and known figures.

use std::ops::Range;

use tempco::{Thermal, ThermalSettings};
use tempco_fit::least_squares::RFactor;
use tempco_fit::{FitOptions, fit};
use tempco_log::{Log, ReadOptions, read_log};
use tempco_set::run::{apply, thermal_points};
use tempco_set::{Model, Warning, WarningCode};
use tempco_tests::{Bench, shared};

/// Runs a log through every command, and returns what `fit` printed of the paper's model and of the
/// default, which goes on.
fn whole_chain(name: &str, tau_s: &str) -> Option<[String; 2]> {
    let log = shared(&format!("data/{name}"))?;
    let log = log.display();
    let bench = Bench::new();
    let fit = format!("fit {log} --serial REAL --out set --tau {tau_s}");
    let fitted = ["composite", "auto"].map(|model| bench.ok(&format!("{fit} --model {model}")));
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
    let [composite, default] = fitted;
    println!("{default}");
    assert!(composite.contains("4 segments"), "{composite}");
}

#[test]
fn a_cold_start_goes_through_every_command() {
    let Some(fitted) = whole_chain("freeimu_mpu6050_cold_start.csv", "100") else {
        return;
    };
    let [composite, default] = fitted;
    println!("{default}");
    assert!(composite.contains(": 1 segment,"), "{composite}");
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

/// The residuals that the note with the log gives for a cubic in T, and for the same with T' and
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

/// The rows of a log, as a log.
fn part(log: &Log, rows: Range<usize>) -> Log {
    let mut part = log.clone();
    part.sha256 = format!("{rows:?}");
    part.time_s = log.time_s[rows.clone()].to_vec();
    for channel in &mut part.channels {
        channel.temp_c = channel.temp_c[rows.clone()].to_vec();
        for axis in &mut channel.axes {
            axis.raw = axis.raw[rows.clone()].to_vec();
        }
    }
    part
}

/// Root mean square of means over 20 rows about their mean.
fn rms_of_20(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let means = values
        .chunks_exact(20)
        .map(|c| c.iter().sum::<f64>() / 20.0);
    let means: Vec<f64> = means.collect();
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    let squares: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
    (squares / means.len() as f64).sqrt()
}

/// What a cubic in T, fitted to means over 20 rows, leaves of another part of the log.
fn cubic(train: &Log, judge: &Log) -> Vec<f64> {
    let axes = train.channels[0].axes.len();
    let mut factor = RFactor::new(4, axes);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (temp_c, _, raw) in means_of_20(train, 20.0) {
        let z = (temp_c - 28.0) / 46.0;
        (low, high) = (low.min(z), high.max(z));
        factor.push([1.0, z, z * z, z * z * z].into_iter().chain(raw));
    }
    let coefficients = factor.solve(4).unwrap().coefficients;
    let of_axis = judge.channels[0].axes.iter().zip(&coefficients);
    of_axis
        .map(|(axis, c)| {
            let rows = axis.raw.iter().zip(&judge.channels[0].temp_c);
            rms_of_20(rows.map(|(raw, &temp_c)| {
                let z = ((f64::from(temp_c) - 28.0) / 46.0).clamp(low, high);
                raw - c.iter().rev().fold(0.0, |sum, c| sum * z + c)
            }))
        })
        .collect()
}

/// The cycle passes each temperature hardly twice, at one rate each way: rate terms fitted to one
/// part make the other worse. The fit sees that it cannot judge them, says so, and what is left is
/// about as good as a cubic.
#[test]
fn one_part_of_the_chamber_cycle_does_not_spoil_the_other() {
    let Some(path) = shared("data/tofupilot_imu_chamber_cycle.csv") else {
        return;
    };
    let log = read_log(&path, &ReadOptions::default()).unwrap();
    for (train, judge) in [(2800..log.rows(), 0..2700), (0..2700, 2800..log.rows())] {
        let (train, judge) = (part(&log, train), part(&log, judge));
        let cubic = cubic(&train, &judge);
        let mut options = FitOptions::new("REAL", Model::Auto);
        options.plan.tau_s = 10.114;
        let fitted = fit(std::slice::from_ref(&train), &options).unwrap();
        let set = &fitted.set;
        let applied = apply(set, &judge).unwrap();
        let channel = &set.channels[0];
        for ((axis, output), cubic) in channel.axes.iter().zip(&applied.axes).zip(&cubic) {
            let left = rms_of_20(output.compensated.iter().map(|&v| f64::from(v)));
            println!(
                "{}: {left:.5}, cubic {cubic:.5}, ratio {:.3}",
                axis.name,
                left / cubic
            );
            assert!(axis.polynomials.iter().all(|p| p.r == [0.0; 2]));
            assert!(left < 1.2 * cubic, "{}", axis.name);
        }
        assert_eq!(channel.table.thermal.kappa, 0.0);
        let judgement = fitted.judge();
        let said = |of: &Warning| of.code == WarningCode::NoRateTerms;
        assert!(judgement.warnings.iter().any(said), "{judgement:?}");
    }
}
