//! Whole runs, seen from outside.

use tempco_twin::{
    DEFAULT_RATE_HZ, Drift, GyroNoise, PROFILES, Profile, Sample, Simulation, Step,
    TemperatureReading, Unit, write_log, write_log_and_truth,
};

fn paper() -> Unit {
    Unit::named("paper").unwrap()
}

fn quiet() -> Unit {
    let mut unit = paper();
    unit.temperature = TemperatureReading::EXACT;
    for axis in &mut unit.axes {
        axis.noise = GyroNoise::NONE;
    }
    unit
}

fn run(unit: &Unit, profile: &Profile, seed: u64) -> Simulation {
    Simulation::new(unit, profile, seed, DEFAULT_RATE_HZ).unwrap()
}

fn named(profile: &str) -> Profile {
    Profile::named(profile).unwrap()
}

/// Log and truth file of the short profile.
fn files(seed: u64) -> (Vec<u8>, Vec<u8>) {
    let (mut log, mut truth) = (Vec::new(), Vec::new());
    let samples = run(&paper(), &named("short"), seed);
    write_log_and_truth(&mut log, &mut truth, samples).unwrap();
    (log, truth)
}

/// Sample standard deviation of non-overlapping 100 s means of one axis, pulses/s, and the
/// number of means.
fn sigma_100_s(samples: &[Sample], axis: usize) -> (f64, usize) {
    let means: Vec<f64> = samples
        .chunks_exact(200)
        .map(|chunk| chunk.iter().map(|s| s.counts[axis]).sum::<i64>() as f64 / 100.0)
        .collect();
    let n = means.len();
    let mean = means.iter().sum::<f64>() / n as f64;
    let square = means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>();
    ((square / (n - 1) as f64).sqrt(), n)
}

#[test]
fn the_seed_decides_the_noise_and_nothing_else() {
    let (log, truth) = files(1);
    let (same_log, same_truth) = files(1);
    let (other_log, other_truth) = files(2);
    assert!(log == same_log && truth == same_truth);
    assert!(log != other_log);
    assert!(truth == other_truth);
}

#[test]
fn rows_are_pinned() {
    // The same on every machine; a change here is a change of every simulated log.
    let (log, truth) = files(1);
    let log = String::from_utf8(log).unwrap();
    let last_counts: Vec<&str> = log
        .lines()
        .rev()
        .filter(|row| !row.ends_with(",0,0,0"))
        .take(4)
        .collect();
    assert_eq!(
        last_counts,
        [
            "5394.5,19.2500,1,0,0",
            "5394,19.1875,-1,0,0",
            "5393.5,19.1875,1,0,0",
            "5389.5,19.1250,0,0,1"
        ]
    );
    let truth = String::from_utf8(truth).unwrap();
    assert_eq!(
        truth.lines().last().unwrap(),
        "5400,15.171105,14.326319,15.812566,0.058092094,0.020681582,0.042239765,ok"
    );
}

#[test]
fn every_named_profile_runs_to_its_end() {
    for name in PROFILES {
        let profile = named(name);
        let mut log = Vec::new();
        let rows = write_log(&mut log, run(&paper(), &profile, 1)).unwrap();
        let all = (profile.duration_s() * DEFAULT_RATE_HZ + 1e-6) as u64 + 1;
        let lost = if *name == "faults" { 240 } else { 0 };
        assert_eq!(rows, all - lost, "{name}");
        let lines = log.iter().filter(|byte| **byte == b'\n').count();
        assert_eq!(lines as u64, rows + 1, "{name}");
    }
}

#[test]
fn verification_is_long_enough() {
    assert!(run(&paper(), &named("verification"), 1).count() >= 105_000);
}

#[test]
fn pulses_hold_the_integral_of_the_true_bias() {
    let unit = quiet();
    let mut pulses = [0_i64; 3];
    let mut angle = [0.0; 3];
    let mut largest = 0;
    let mut before = None;
    for sample in run(&unit, &named("calibration"), 1) {
        let now = sample.truth.bias;
        let last = before.replace(now).unwrap_or(now);
        for axis in 0..3 {
            pulses[axis] += sample.counts[axis];
            angle[axis] += 0.5 * (last[axis] + now[axis]) / DEFAULT_RATE_HZ;
            let rest = angle[axis] - pulses[axis] as f64;
            assert!((-1e-6..1.0 + 1e-6).contains(&rest), "axis {axis}: {rest}");
            largest = largest.max(pulses[axis].abs());
        }
    }
    assert!(largest > 500, "{largest}");
}

#[test]
fn the_sensor_lags_the_air_and_the_cavity_lags_the_sensor() {
    let ramp = Step::Ramp {
        to_c: 80.0,
        rate_c_per_min: 1.0,
    };
    let profile = Profile::new("ramp", -15.0, &[ramp]).unwrap();
    let unit = quiet();
    let last = run(&unit, &profile, 1).last().unwrap();
    // 95 min are 13 of the longest time constants.
    let air_c = profile.air_c(last.time_s);
    assert!((air_c - last.temp_c - 6.0).abs() < 0.001);
    for (cavity_c, lag_c) in last.truth.cavity_c.into_iter().zip([5.0, 7.0, 4.0]) {
        let actual_c = last.temp_c - cavity_c;
        assert!((actual_c - lag_c).abs() < 0.001, "{actual_c} degC");
    }
}

#[test]
fn at_one_temperature_only_the_stated_noise_is_left() {
    let soak = Step::Soak {
        air_c: 20.0,
        duration_min: 2000.0,
    };
    let profile = Profile::new("constant", 20.0, &[soak]).unwrap();
    let samples: Vec<Sample> = run(&paper(), &profile, 7).collect();
    for axis in 0..3 {
        let (sigma, n) = sigma_100_s(&samples, axis);
        assert_eq!(n, 1200);
        assert!((sigma / 0.0051 - 1.0).abs() < 0.1, "axis {axis}: {sigma}");
        let pulses: i64 = samples.iter().map(|s| s.counts[axis]).sum();
        let mean = pulses as f64 / 120_000.0;
        let bias = samples[0].truth.bias[axis];
        assert!((mean - bias).abs() < 4.0 * 0.03 / 120_000_f64.sqrt());
    }
}

#[test]
fn the_thermal_part_stands_out_of_the_noise() {
    // Worth compensating: on every axis several times the noise of the 100 s means.
    let samples: Vec<Sample> = run(&paper(), &named("calibration"), 1).collect();
    for axis in 0..3 {
        let (sigma, _) = sigma_100_s(&samples, axis);
        assert!(sigma > 4.0 * 0.0051, "axis {axis}: {sigma}");
    }
}

#[test]
fn a_slow_loop_of_the_hysteretic_unit_is_open_by_its_plays() {
    let mut unit = Unit::named("hysteretic").unwrap();
    for axis in &mut unit.axes {
        axis.rate_sensitivity = 0.0;
        axis.gradient_sensitivity = 0.0;
        axis.modes = None;
        axis.drift = Drift::default();
    }
    // Biases of X where its cavity passes 40 degC, upwards and downwards.
    let (mut up, mut down) = (Vec::new(), Vec::new());
    let mut last: Option<Sample> = None;
    for sample in run(&unit, &named("cycles"), 1) {
        if let Some(last) = last.replace(sample) {
            let (before, now) = (last.truth.cavity_c[0], sample.truth.cavity_c[0]);
            if before < 40.0 && now >= 40.0 {
                up.push(sample.truth.bias[0]);
            } else if before >= 40.0 && now < 40.0 {
                down.push(sample.truth.bias[0]);
            }
        }
    }
    assert_eq!((up.len(), down.len()), (6, 6));
    let open = 2.0 * (0.0008 * 2.0 + 0.0004 * 6.0 + 0.0002 * 15.0);
    // The cavity lags too far to reach all stops on the faster cycles; on the last one it does.
    let found = up[5] - down[5];
    assert!((found - open).abs() < 0.0001, "{found} {open}");
    assert!(up[1] - down[1] < 0.9 * open);
}
