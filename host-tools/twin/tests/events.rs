//! Faults, motion, lost rows and cold starts, in whole runs.

use tempco_twin::{
    Fault, FaultKind, Flags, GyroNoise, Motion, MotionKind, Profile, ProfileParts, RateUnit,
    Sample, Simulation, Step, TemperatureReading, Unit,
};

const RATE_HZ: f64 = 4.0;

fn quiet(name: &str) -> Unit {
    let mut unit = Unit::named(name).unwrap();
    unit.temperature = TemperatureReading::EXACT;
    for axis in &mut unit.axes {
        axis.noise = GyroNoise::NONE;
    }
    unit
}

fn at_rest() -> ProfileParts {
    ProfileParts {
        start_c: 20.0,
        step: vec![Step::Soak {
            air_c: 20.0,
            duration_min: 10.0,
        }],
        ..ProfileParts::default()
    }
}

fn run(unit: &Unit, parts: ProfileParts) -> Vec<Sample> {
    let profile = Profile::from_parts("test", parts).unwrap();
    Simulation::new(unit, &profile, 1, RATE_HZ)
        .unwrap()
        .collect()
}

fn with_fault(what: FaultKind) -> ProfileParts {
    let fault = Fault {
        at_min: 2.0,
        duration_min: 1.0,
        what,
    };
    ProfileParts {
        fault: vec![fault],
        ..at_rest()
    }
}

/// Times of the samples that satisfy a condition, first and last.
fn span(samples: &[Sample], condition: impl Fn(&Sample) -> bool) -> (f64, f64) {
    let times: Vec<f64> = samples
        .iter()
        .filter(|sample| condition(sample))
        .map(|sample| sample.time_s)
        .collect();
    (times[0], times[times.len() - 1])
}

#[test]
fn temperature_faults_are_where_the_profile_says_and_flagged() {
    for (what, reading_c) in [
        (FaultKind::TemperatureOpen, 199.0),
        (FaultKind::TemperatureShort, -99.0),
        (FaultKind::TemperatureOffset { by_c: 7.0 }, 27.0),
    ] {
        let samples = run(&quiet("paper"), with_fault(what));
        assert_eq!(span(&samples, |s| s.temp_c == reading_c), (120.0, 179.75));
        let flagged = |s: &Sample| s.truth.flags.contains(Flags::TEMPERATURE_FAULT);
        assert_eq!(span(&samples, flagged), (120.0, 179.75));
        assert!(
            samples
                .iter()
                .all(|s| s.temp_c == reading_c || s.temp_c == 20.0)
        );
    }
    let samples = run(&quiet("paper"), with_fault(FaultKind::TemperatureMissing));
    assert_eq!(span(&samples, |s| s.temp_c.is_nan()), (120.0, 179.75));
    let spike = FaultKind::TemperatureSpike { by_c: 30.0 };
    let samples = run(&quiet("paper"), with_fault(spike));
    assert_eq!(span(&samples, |s| s.temp_c == 50.0), (120.0, 120.0));
}

#[test]
fn a_stuck_sensor_repeats_its_last_reading_on_a_ramp() {
    let mut parts = with_fault(FaultKind::TemperatureStuck);
    parts.step = vec![Step::Ramp {
        to_c: 40.0,
        rate_c_per_min: 2.0,
    }];
    let samples = run(&quiet("paper"), parts);
    let before = samples.iter().find(|s| s.time_s == 119.75).unwrap().temp_c;
    assert_eq!(span(&samples, |s| s.temp_c == before), (119.75, 179.75));
}

#[test]
fn a_dead_gyro_puts_out_nothing_and_the_others_go_on() {
    let mut parts = with_fault(FaultKind::GyroDead {
        axis: tempco_twin::AxisName::Y,
    });
    parts.input_rate_dph = [36.0; 3];
    let samples = run(&quiet("paper"), parts);
    let dead = |s: &Sample| s.truth.flags.contains(Flags::GYRO_FAULT);
    assert_eq!(span(&samples, dead), (120.0, 179.75));
    for sample in &samples {
        assert_eq!(sample.counts[1] == 0, dead(sample), "{} s", sample.time_s);
        assert!(sample.counts[0] >= 8 && sample.counts[2] >= 8);
    }
}

#[test]
fn lost_rows_are_missing_and_the_row_after_them_says_so() {
    let samples = run(&quiet("paper"), with_fault(FaultKind::RowsLost));
    assert_eq!(samples.len(), 2401 - 240);
    let after = |s: &Sample| s.truth.flags.contains(Flags::ROWS_LOST);
    assert_eq!(span(&samples, after), (180.0, 180.0));

    let mut unit = quiet("paper");
    unit.lost_rows = 0.1;
    let samples = run(&unit, at_rest());
    let lost = 2401 - samples.len();
    assert!((180..300).contains(&lost), "{lost}");
    let gaps = samples
        .windows(2)
        .filter(|pair| pair[1].time_s - pair[0].time_s > 0.3)
        .count();
    assert_eq!(gaps, samples[1..].iter().filter(|s| after(s)).count());
}

#[test]
fn motion_and_earth_rate_turn_the_gyros_by_their_angle() {
    let motion = Motion {
        at_min: 3.0,
        duration_min: 2.0,
        what: MotionKind::Turn {
            rate_dps: [0.1, 0.0, -0.05],
        },
    };
    for name in ["paper", "ln100", "mems", "fog"] {
        let mut unit = quiet(name);
        unit.tone.clear();
        let sums = |parts: ProfileParts| {
            let mut sums = [0_i64; 3];
            for sample in run(&unit, parts) {
                for (sum, count) in sums.iter_mut().zip(sample.counts) {
                    *sum += count;
                }
            }
            sums
        };
        let rest = sums(at_rest());
        let moved = sums(ProfileParts {
            motion: vec![motion],
            input_rate_dph: [0.0, 3600.0, 0.0],
            ..at_rest()
        });
        // 12 and -6 degrees of motion; 1 deg/s, the first sample having an interval as well.
        for (axis, angle_deg) in [12.0, 600.25, -6.0].into_iter().enumerate() {
            let count = (moved[axis] - rest[axis]) as f64;
            let arcsec_per_count = match (unit.output, unit.rate_unit) {
                (
                    tempco_twin::Output::Pulses {
                        scale_factor_arcsec,
                    },
                    _,
                ) => scale_factor_arcsec,
                (tempco_twin::Output::Rate { step, .. }, RateUnit::Dps) => 3600.0 * step / RATE_HZ,
                (tempco_twin::Output::Rate { step, .. }, _) => step / RATE_HZ,
            };
            let error = (count * arcsec_per_count - 3600.0 * angle_deg).abs();
            // Steps of a rate are rounded sample by sample.
            assert!(
                error <= 0.5 * arcsec_per_count * 2401.0 + 1e-6,
                "{name} {axis}: {error}"
            );
        }
    }
}

#[test]
fn power_comes_on_at_a_cold_start_only() {
    let unit = quiet("hysteretic");
    let cold = run(
        &unit,
        ProfileParts {
            cold_start: true,
            ..at_rest()
        },
    );
    let warm = run(&unit, at_rest());
    assert_eq!(cold[0].temp_c, 20.0);
    assert_eq!(warm[0].temp_c, 24.0);
    assert_eq!(warm[2400].truth.cavity_c, warm[0].truth.cavity_c);
    let rise_c = cold[2400].temp_c - 20.0;
    assert!((3.0..4.0).contains(&rise_c), "{rise_c}");
}
