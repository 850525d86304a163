//! Rules of the judge and of the making of a set, swept over logs whose bias is known.

mod worlds;

use tempco_evaluate::{evaluate, judge, sign_off};
use tempco_fit::{Fit, FitOptions, fit};
use tempco_log::{Axis, AxisUnit, Channel, Log, Reading, SkippedRows};
use tempco_set::run::apply;
use tempco_set::{Judgement, Model, RejectionCode, WarningCode};

use worlds::Random;

const MODELS: [Model; 3] = [Model::Static, Model::Composite, Model::Auto];

/// Temperatures [degC], one a second: two cycles between `low` and `high`, of 40 min each, with
/// soaks at both ends.
fn cycles(low: f64, high: f64) -> Vec<f64> {
    let place = |row: u32| {
        let phase = f64::from(row) * std::f64::consts::TAU / 2400.0;
        0.5 * (1.0 - (1.2 * phase.cos()).clamp(-1.0, 1.0))
    };
    (0..4800)
        .map(|row| low + (high - low) * place(row))
        .collect()
}

fn axis(name: &str, unit: AxisUnit, raw: Vec<f64>) -> Axis {
    let name = name.to_owned();
    Axis { name, unit, raw }
}

fn log(name: &str, temp_c: &[f64], axes: Vec<Axis>) -> Log {
    Log {
        file: name.to_owned(),
        sha256: name.to_owned(),
        time_s: (0..temp_c.len()).map(|row| row as f64).collect(),
        channels: vec![Channel {
            column: "temp_c".to_owned(),
            temp_c: temp_c.iter().map(|&temp_c| temp_c as f32).collect(),
            axes,
        }],
        ignored_columns: Vec::new(),
        reading: Reading::default(),
        skipped_rows: SkippedRows::default(),
        interval_s: 1.0,
    }
}

/// Three axes that follow the temperature, but for axis `flat`.
fn gyros(temp_c: &[f64], flat: Option<usize>, random: &mut Random) -> Vec<Axis> {
    let curves = [(0.012, 1.2e-4), (-0.008, 0.8e-4), (0.005, -0.5e-4)];
    let axes = curves.into_iter().zip(["x", "y", "z"]).enumerate();
    axes.map(|(number, ((slope, curve), name))| {
        let raw = temp_c.iter().map(|temp_c| {
            let from_25 = temp_c - 25.0;
            let bias = slope * from_25 + curve * from_25 * from_25;
            let bias = if flat == Some(number) { 0.1 } else { bias };
            bias + 0.05 * random.normal()
        });
        axis(name, AxisUnit::Dps, raw.collect())
    })
    .collect()
}

fn fitted(log: &Log, model: Model) -> Fit {
    fit(std::slice::from_ref(log), &FitOptions::new("S1", model)).unwrap()
}

fn has(judgement: &Judgement, code: WarningCode, axis: Option<&str>) -> bool {
    let mut warnings = judgement.warnings.iter();
    warnings.any(|of| of.code == code && of.axis.as_deref() == axis)
}

/// Wherever the flat axis is: the default leaves its terms out and says so, or it is better than a
/// constant; the others stay as they are, and so do the paper's models.
#[test]
fn an_axis_whose_terms_do_not_help_keeps_the_constant_alone() {
    let temp_c = cycles(-10.0, 50.0);
    let mut left_out = 0;
    for flat in 0..3 {
        for seed in 1..=3 {
            let log = log(
                "a.csv",
                &temp_c,
                gyros(&temp_c, Some(flat), &mut Random::new(seed)),
            );
            for model in MODELS {
                let fit = fitted(&log, model);
                let judgement = fit.judge();
                let case = format!("axis {flat}, seed {seed}, {model:?}: {:?}", judgement);
                // Segments of an axis without bias disagree by the noise, which is all there is, and
                // may be worse than a constant.
                let is_free = model == Model::Auto;
                let may_be = |code: RejectionCode| match code {
                    RejectionCode::SegmentsDisagree => true,
                    RejectionCode::HeldOutWorse => !is_free,
                    _ => false,
                };
                let mut rejections = judgement.rejections.iter();
                assert!(rejections.all(|of| may_be(of.code)), "{case}");
                let channel = &fit.set.channels[0];
                for (number, axis) in channel.axes.iter().enumerate() {
                    let errors = axis.held_out.unwrap();
                    let is_constant = channel.table.is_constant(number);
                    let is_said = has(&judgement, WarningCode::ConstantAlone, Some(&axis.name));
                    assert_eq!(is_constant, is_said, "{case}");
                    assert_eq!(is_constant, errors.left_out.is_some(), "{case}");
                    assert!(!is_constant || number == flat, "{case}");
                    assert!(is_free || !is_constant, "{case}");
                    if is_free && number == flat {
                        assert!(
                            is_constant || errors.chosen.unwrap() < errors.none,
                            "{case}"
                        );
                        left_out += u32::from(is_constant);
                    }
                }
            }
        }
    }
    println!("terms left out in {left_out} of 9");
    assert!(left_out >= 4, "{left_out}");
}

/// A set whose axes all keep the constant alone is no compensation.
#[test]
fn a_set_of_constants_is_rejected() {
    let temp_c = cycles(-10.0, 50.0);
    let mut rejected = 0;
    for seed in 1..=4 {
        let mut axes = gyros(&temp_c, Some(0), &mut Random::new(seed));
        axes.truncate(1);
        let fit = fitted(&log("a.csv", &temp_c, axes), Model::Auto);
        let is_constant = fit.set.channels[0].table.is_constant(0);
        assert_eq!(fit.judge().is_accepted(), !is_constant);
        rejected += u32::from(is_constant);
    }
    assert!(rejected > 0);
}

/// Gravity stays in the output of an accelerometer, whatever axis it is on, and numbers about the
/// mean are those of an axis whose constant is taken out.
#[test]
fn gravity_stays_in_the_output_of_an_accelerometer() {
    let level = cycles(10.0, 55.0);
    let flight: Vec<f64> = cycles(20.0, 45.0);
    for (unit, gravity) in [(AxisUnit::Mps2, -9.81), (AxisUnit::G, 1.0)] {
        for down in 0..3 {
            let thermal = |temp_c: f64| 5e-4 * gravity * (temp_c - 34.0);
            let axes = |temp_c: &[f64], unit, scale: f64| {
                let mut random = Random::new(5);
                let of_axis = ["x", "y", "z"]
                    .into_iter()
                    .enumerate()
                    .map(|(number, name)| {
                        let constant = if number == down {
                            scale * gravity
                        } else {
                            0.05
                        };
                        let raw = temp_c.iter().map(|&temp_c| {
                            constant + thermal(temp_c) + 1e-3 * gravity * random.normal()
                        });
                        axis(name, unit, raw.collect())
                    });
                of_axis.collect::<Vec<_>>()
            };
            for model in MODELS {
                let case = format!("{unit}, axis {down}, {model:?}");
                let of = fitted(&log("level.csv", &level, axes(&level, unit, 1.0)), model);
                let gyro = log("level.csv", &level, axes(&level, AxisUnit::Dps, 1.0));
                let gyro = fitted(&gyro, model);
                // Tilted by 60 degrees: half of gravity is on the axis.
                let tilted = log("tilted.csv", &flight, axes(&flight, unit, 0.5));
                let applied = apply(&of.set, &tilted).unwrap();
                let channel = &of.set.channels[0];
                for (number, (axis, other)) in channel
                    .axes
                    .iter()
                    .zip(&gyro.set.channels[0].axes)
                    .enumerate()
                {
                    assert_eq!((axis.reference_c, other.reference_c), (Some(25.0), None));
                    let compensated = &applied.axes[number].compensated;
                    let sum: f64 = compensated.iter().copied().map(f64::from).sum();
                    let constant = if number == down { 0.5 * gravity } else { 0.05 };
                    let expected = constant + thermal(25.0);
                    let found = sum / compensated.len() as f64;
                    assert!(
                        (found - expected).abs() < 1e-3 * gravity.abs(),
                        "{case}: {found} {expected}"
                    );
                    let cells = channel.table.terms::<1>(number);
                    let table = channel.table.table_over(number, &cells).unwrap();
                    let point = tempco::ThermalPoint {
                        effective_c: 25.0,
                        ..Default::default()
                    };
                    assert!(table.bias(&point).0[0].abs() < 1e-6, "{case}");
                    let [of, other] = [axis, other].map(|of| of.statistics.unwrap());
                    for (a, b) in [
                        (of.sigma_raw, other.sigma_raw),
                        (of.sigma_compensated, other.sigma_compensated),
                        (of.rmse_compensated, other.rmse_compensated),
                    ] {
                        assert!((a - b).abs() < 1e-4 * b, "{case}: {a} {b}");
                    }
                }
            }
        }
    }
}

/// Without 25 degC in the calibrated range, the change is about the middle of it.
#[test]
fn the_reference_is_the_middle_of_a_range_without_25_degrees() {
    let temp_c = cycles(35.0, 55.0);
    let raw = temp_c.iter().map(|temp_c| -9.81 + 1e-3 * temp_c).collect();
    let log = log("hot.csv", &temp_c, vec![axis("z", AxisUnit::Mps2, raw)]);
    for model in MODELS {
        let set = fitted(&log, model).set;
        let reference_c = set.channels[0].axes[0].reference_c.unwrap();
        assert!((reference_c - 45.0).abs() < 0.5, "{reference_c}");
        let text = set.to_json();
        let read = tempco_set::CoefficientSet::from_json(&text).unwrap();
        assert_eq!(read, set);
    }
}

/// A driver that states temperature by another formula than at the calibration, and one that does
/// not.
#[test]
fn another_formula_of_temperature_is_rejected_by_its_trend() {
    let temp_c = cycles(-10.0, 50.0);
    let calibration = log("a.csv", &temp_c, gyros(&temp_c, None, &mut Random::new(1)));
    let flight = cycles(0.0, 40.0);
    for model in MODELS {
        let mut set = fitted(&calibration, model).set;
        for (seed, scale, offset) in [
            (2, 1.0, 0.0),
            (3, 1.0, 0.0),
            (4, 1.0, 0.0),
            (2, 1.018, -8.0),
            (3, 0.8, 4.0),
            (4, 1.2, -5.0),
            (5, 1.0, 10.0),
            (6, 0.5, 10.0),
        ] {
            let axes = gyros(&flight, None, &mut Random::new(seed));
            let stated: Vec<f64> = flight.iter().map(|t| scale * t + offset).collect();
            let evaluation = evaluate(&set, &log("b.csv", &stated, axes), None, 100.0).unwrap();
            let sign_off = sign_off(&evaluation);
            let is_clean = (scale, offset) == (1.0, 0.0);
            let case = format!("{model:?}, {scale} T + {offset}: {sign_off:?}");
            assert_eq!(sign_off.accepted, is_clean, "{case}");
            let code = RejectionCode::TrendWithTemperature;
            let has_trend = sign_off.rejections.iter().any(|of| of.code == code);
            assert_eq!(has_trend, !is_clean, "{case}");
            // What is kept in the set rejects it without the log, in the same words.
            set.sign_offs = vec![sign_off.clone()];
            let kept = judge(&set, None);
            assert_eq!(kept.rejections, sign_off.rejections, "{case}");
            assert_eq!(kept.verified, is_clean, "{case}");
            set.sign_offs.clear();
        }
    }
}

/// Rows beyond the calibrated temperatures, at either end: silence, a warning from 5 %, a
/// rejection from 20 %.
#[test]
fn rows_outside_the_calibrated_range_warn_and_then_reject() {
    let temp_c = cycles(0.0, 40.0);
    let calibration = log("a.csv", &temp_c, gyros(&temp_c, None, &mut Random::new(1)));
    let set = fitted(&calibration, Model::Static).set;
    for beyond_c in [-1.0, 41.0] {
        for (share, warns, rejects) in [
            (0.0, false, false),
            (0.02, false, false),
            (0.045, false, false),
            (0.055, true, false),
            (0.12, true, false),
            (0.195, true, false),
            (0.205, false, true),
            (0.6, false, true),
        ] {
            let mut random = Random::new(2);
            let inside = cycles(2.0, 38.0);
            let last = inside[inside.len() - 1];
            // On the way there no temperature changes faster than the core takes it.
            let steps = ((beyond_c - last).abs() / 0.05) as usize;
            let rows = (share * (inside.len() + steps) as f64 / (1.0 - share)) as usize;
            let way = (0..steps).map(|k| last + (beyond_c - last) * k as f64 / steps as f64);
            let mut truth = inside.clone();
            truth.extend(way);
            truth.extend(std::iter::repeat_n(beyond_c, rows));
            let axes = gyros(&truth, None, &mut random);
            let evaluation = evaluate(&set, &log("b.csv", &truth, axes), None, 100.0).unwrap();
            let found = evaluation.outside.map_or(0, |of| of.rows) as f64 / truth.len() as f64;
            let judgement = judge(&set, Some(&evaluation));
            let case = format!("{beyond_c} degC, {share} ({found}): {judgement:?}");
            assert_eq!(
                has(&judgement, WarningCode::FlaggedRows, None),
                warns,
                "{case}"
            );
            let code = RejectionCode::OutsideCalibratedRange;
            let mut rejections = judgement.rejections.iter();
            assert_eq!(rejections.any(|of| of.code == code), rejects, "{case}");
        }
    }
}

/// Rows that were left out on reading, of a fitted log and of an evaluated one.
#[test]
fn more_than_five_percent_of_bad_rows_reject() {
    let temp_c = cycles(0.0, 40.0);
    let clean = log("a.csv", &temp_c, gyros(&temp_c, None, &mut Random::new(1)));
    let set = fitted(&clean, Model::Static).set;
    for (bad, rejects) in [
        (0, false),
        (1, false),
        (252, false),
        (253, true),
        (4000, true),
    ] {
        let with = |name: &str| {
            let mut log = log(name, &temp_c, gyros(&temp_c, None, &mut Random::new(2)));
            log.skipped_rows.not_a_number = bad;
            log
        };
        let of_fit = fitted(&with("bad.csv"), Model::Static);
        let evaluation = evaluate(&set, &with("bad.csv"), None, 100.0).unwrap();
        for judgement in [of_fit.judge(), judge(&set, Some(&evaluation))] {
            let codes: Vec<_> = judgement.rejections.iter().map(|of| of.code).collect();
            let expected = rejects.then_some(RejectionCode::TooManyBadRows);
            assert_eq!(codes, Vec::from_iter(expected), "{bad}: {judgement:?}");
            let named = format!("not a number {bad}");
            assert!(!rejects || judgement.rejections[0].message.contains(&named));
        }
        assert_eq!(of_fit.set.provenance.inputs[0].skipped.not_a_number, bad);
        assert_eq!(of_fit.set.to_json().contains("\"skipped\""), bad > 0);
    }
}
