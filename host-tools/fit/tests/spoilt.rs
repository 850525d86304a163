//! Logs that somebody spoilt: turned, carried, switched off and on, too short. Each is rejected, or
//! what is spoilt is left out and said, with axis and times. Clean twins pass without a word.

mod worlds;

use tempco_evaluate::judge;
use tempco_fit::{FitOptions, fit};
use tempco_log::{Axis, AxisUnit, Channel, Log};
use tempco_set::run::apply;
use tempco_set::{CoefficientSet, Judgement, Model, Outliers, RejectionCode, WarningCode};
use worlds::Random;

/// Time between rows \[s\].
const INTERVAL_S: f64 = 0.2;

/// Noise of a row \[deg/s\].
const NOISE: f64 = 0.05;

/// Up and down in 75 min.
const RUN: [(f64, f64); 6] = [
    (0.0, -10.0),
    (300.0, -10.0),
    (2100.0, 50.0),
    (2400.0, 50.0),
    (4200.0, -10.0),
    (4500.0, -10.0),
];

/// Bias \[deg/s\] of an axis at a temperature.
fn bias(axis: usize, temp_c: f64) -> f64 {
    let (constant, line, square) = [
        (0.5, 0.012, 1.2e-4),
        (-0.3, -0.008, 0.8e-4),
        (0.1, 0.005, -0.5e-4),
    ][axis];
    let d = temp_c - 25.0;
    constant + line * d + square * d * d
}

/// Temperature at a time of a profile of (time, temperature).
fn at(profile: &[(f64, f64)], time_s: f64) -> f64 {
    let next = profile
        .partition_point(|of| of.0 <= time_s)
        .min(profile.len() - 1);
    let [(from_s, from_c), (to_s, to_c)] = [profile[next - 1], profile[next]];
    from_c + (to_c - from_c) * (time_s - from_s) / (to_s - from_s)
}

fn run(profile: &[(f64, f64)], seed: u64) -> Log {
    let mut random = Random::new(seed);
    let rows = (profile[profile.len() - 1].0 / INTERVAL_S) as usize;
    let time_s: Vec<f64> = (0..rows).map(|row| INTERVAL_S * row as f64).collect();
    let temp_c: Vec<f64> = time_s.iter().map(|&time_s| at(profile, time_s)).collect();
    let axes = (0..3).map(|axis| Axis {
        name: ["x", "y", "z"][axis].to_owned(),
        unit: AxisUnit::Dps,
        raw: temp_c
            .iter()
            .map(|&t| bias(axis, t) + NOISE * random.normal())
            .collect(),
    });
    let axes = axes.collect();
    Log {
        file: "log.csv".to_owned(),
        sha256: String::new(),
        time_s,
        channels: vec![Channel {
            column: "temp_c".to_owned(),
            temp_c: temp_c
                .iter()
                .map(|&t| (t + 0.02 * random.normal()) as f32)
                .collect(),
            axes,
        }],
        ignored_columns: Vec::new(),
        reading: tempco_log::Reading::default(),
        skipped_rows: tempco_log::SkippedRows::default(),
        interval_s: INTERVAL_S,
    }
}

fn fitted(log: &Log) -> (CoefficientSet, Judgement) {
    let set = fit(
        std::slice::from_ref(log),
        &FitOptions::new("S", Model::Composite),
    )
    .unwrap()
    .set;
    let judgement = judge(&set, None);
    (set, judgement)
}

fn outliers(set: &CoefficientSet) -> &Outliers {
    set.channels[0].outliers.as_ref().unwrap()
}

/// Adds to an axis between two times.
fn add(log: &mut Log, axis: usize, (from_s, to_s): (f64, f64), mut value: impl FnMut(f64) -> f64) {
    for (time_s, raw) in log.time_s.iter().zip(&mut log.channels[0].axes[axis].raw) {
        if (from_s..to_s).contains(time_s) {
            *raw += value(*time_s - from_s);
        }
    }
}

/// The worst axis's error of the set on a clean run, means aside \[deg/s\].
fn error(set: &CoefficientSet, clean: &Log) -> f64 {
    let applied = apply(set, clean).unwrap();
    let errors = (0..3).map(|axis| {
        let temps = clean.time_s.iter().map(|&time_s| at(&RUN, time_s));
        let apart: Vec<f64> = temps
            .zip(&applied.axes[axis].bias)
            .map(|(temp_c, found)| f64::from(*found) - bias(axis, temp_c))
            .collect();
        let mean = apart.iter().sum::<f64>() / apart.len() as f64;
        let squares: f64 = apart.iter().map(|e| (e - mean) * (e - mean)).sum();
        (squares / apart.len() as f64).sqrt()
    });
    errors.fold(0.0, f64::max)
}

/// Whether the times of a spoilt stretch are said of its axis, to a minute.
fn is_said(set: &CoefficientSet, axis: &str, (from_s, to_s): (f64, f64)) -> bool {
    let found = outliers(set);
    let near = |a: f64, b: f64| (a - b).abs() <= 60.0;
    let places = found.spikes.iter().chain(&found.disturbances);
    let mut places = places.filter(|of| of.axis == axis);
    let at = |time_s: f64| {
        let mut steps = found.steps.iter().filter(|step| step.axis == axis);
        steps.any(|step| near(step.time_s, time_s))
    };
    places.any(|of| near(of.from_s, from_s) && near(of.to_s, to_s)) || at(from_s) && at(to_s)
}

/// An error beyond this is not of the noise; a clean run has less than half \[deg/s\].
const WRONG: f64 = 0.01;

/// A short movement dwarfs all that compensation does: whether it helps must not hang on the sign.
#[test]
fn a_movement_that_is_left_out_says_nothing_of_the_set() {
    let clean = run(&RUN, 1);
    let (set, _) = fitted(&clean);
    let before = set.channels[0].axes[2].statistics.unwrap();
    for from_s in [700.0, 1300.0, 2250.0, 3000.0] {
        for rate in [-5.0, 5.0] {
            let mut log = clean.clone();
            add(&mut log, 2, (from_s, from_s + 20.0), |_| rate);
            let (set, judgement) = fitted(&log);
            assert!(judgement.is_accepted(), "{from_s} {rate} {judgement:?}");
            let after = set.channels[0].axes[2].statistics.unwrap();
            let ratio = after.rmse_raw / before.rmse_raw;
            assert!((0.95..1.05).contains(&ratio), "{from_s} {rate} {ratio}");
        }
    }
}

#[test]
fn a_turn_is_rejected_or_left_out_and_said() {
    let clean = run(&RUN, 1);
    assert!(error(&fitted(&clean).0, &clean) < 0.5 * WRONG);
    let mut tried = 0;
    let mut missed = Vec::new();
    for (number, rate) in [0.5, 1.0, 3.0, 10.0, 60.0, 300.0].into_iter().enumerate() {
        for length_s in [20.0, 45.0, 100.0, 210.0, 300.0, 900.0, 2250.0] {
            for place in 0..4 {
                let free_s = 4500.0 - length_s;
                let from_s = 30.0 + (free_s - 60.0) * (f64::from(place) + 0.37) / 4.0;
                let axis = (number + place as usize) % 3;
                // A table takes some seconds to turn up, and comes from either side.
                let rate = if place % 2 == 0 { rate } else { -rate };
                let mut log = run(&RUN, 100 + tried);
                let times_s = (from_s, from_s + length_s);
                let spin_s = 0.1 * length_s.min(100.0);
                add(&mut log, axis, times_s, |t| {
                    rate * (t.min(length_s - t) / spin_s).min(1.0)
                });
                let (set, judgement) = fitted(&log);
                let name = ["x", "y", "z"][axis];
                let said = is_said(&set, name, times_s);
                let wrong = error(&set, &clean);
                let rejected = judgement.rejections.iter();
                let rejected = rejected.clone().any(|of| of.axis.as_deref() == Some(name));
                if !said || !rejected && wrong > WRONG {
                    missed.push(format!(
                        "{rate} deg/s {from_s:.0} s for {length_s} s: said {said}, error {wrong:.4}, \
                         {:?}",
                        outliers(&set)
                    ));
                }
                tried += 1;
            }
        }
    }
    assert!(
        missed.is_empty(),
        "{} of {tried}:\n{}",
        missed.len(),
        missed.join("\n")
    );
}

#[test]
fn a_hand_is_rejected_or_left_out_and_said() {
    let clean = run(&RUN, 1);
    let mut missed = Vec::new();
    for (seed, length_s) in [20.0, 60.0, 200.0, 700.0, 2000.0].into_iter().enumerate() {
        for from_s in [40.0, 1200.0, 2300.0] {
            let mut random = Random::new(seed as u64);
            let mut log = run(&RUN, 300 + seed as u64);
            for axis in 0..3 {
                // Slow and fast, and never the same.
                let mut rates = [0.0; 2];
                add(&mut log, axis, (from_s, from_s + length_s), |_| {
                    rates[0] += 0.05 * (30.0 * random.normal() - rates[0]);
                    rates[1] = 10.0 * random.normal();
                    rates[0] + rates[1]
                });
            }
            let (set, judgement) = fitted(&log);
            let found = outliers(&set);
            let places = found.spikes.iter().chain(&found.disturbances);
            let mut ends = places.map(|of| (of.from_s, of.to_s));
            let said = ends.any(|(from, to)| from < from_s + length_s && to > from_s);
            let wrong = error(&set, &clean);
            if !said || judgement.is_accepted() && wrong > WRONG {
                missed.push(format!(
                    "{from_s} s for {length_s} s: said {said}, error {wrong:.4}"
                ));
            }
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

/// Clean runs of other noise, length, speed and resolution of the temperature.
#[test]
fn clean_runs_pass_without_a_word() {
    let mut said = Vec::new();
    let stretched = |by: f64| RUN.map(|(time_s, temp_c)| (by * time_s, temp_c));
    for seed in 11..=15 {
        for by in [0.35, 1.0, 3.0] {
            for step_c in [0.0, 0.0625, 0.5, 1.0] {
                for every in [1, 10, 40] {
                    let mut log = run(&stretched(by), seed);
                    if step_c > 0.0 {
                        let temps = log.channels[0].temp_c.iter_mut();
                        temps.for_each(|t| *t = (*t / step_c).round() * step_c);
                    }
                    let mut row = 0;
                    let mut keep = |_: f64| {
                        row += 1;
                        row % every == 1 % every
                    };
                    let kept: Vec<bool> = log.time_s.iter().map(|&t| keep(t)).collect();
                    let mut at = kept.iter();
                    log.time_s.retain(|_| *at.next().unwrap());
                    let mut at = kept.iter();
                    log.channels[0].temp_c.retain(|_| *at.next().unwrap());
                    for axis in &mut log.channels[0].axes {
                        let mut at = kept.iter();
                        axis.raw.retain(|_| *at.next().unwrap());
                    }
                    log.interval_s = INTERVAL_S * every as f64;
                    let (set, judgement) = fitted(&log);
                    let found = outliers(&set);
                    let quiet = found.disturbances.is_empty()
                        && found.steps.is_empty()
                        && found.extent.is_none()
                        && judgement.is_accepted();
                    if !quiet {
                        said.push(format!("{seed} {by} {step_c} {every}: {found:?}"));
                    }
                }
            }
        }
    }
    assert!(said.is_empty(), "{}:\n{}", said.len(), said.join("\n"));
}

/// Two switch-ons in one file: the constants are apart, and the shape is as with one.
#[test]
fn a_power_cycle_is_a_step_that_is_taken_out() {
    let clean = run(&RUN, 1);
    let again = [
        (0.0, 50.0),
        (300.0, 50.0),
        (1800.0, 0.0),
        (2100.0, 0.0),
        (3700.0, 45.0),
    ];
    let mut missed = Vec::new();
    for (seed, gap_s) in [0.2, 31.0, 300.0, 3600.0, 40_000.0].into_iter().enumerate() {
        for size in [0.15, -0.3, 2.0] {
            let mut log = run(&RUN, 500 + seed as u64);
            let second = run(&again, 600 + seed as u64);
            let begins_s = 4500.0 + gap_s;
            log.time_s
                .extend(second.time_s.iter().map(|t| t + begins_s));
            let channel = &mut log.channels[0];
            channel.temp_c.extend_from_slice(&second.channels[0].temp_c);
            for (axis, more) in channel.axes.iter_mut().zip(&second.channels[0].axes) {
                axis.raw.extend(more.raw.iter().map(|raw| raw + size));
            }
            let (set, judgement) = fitted(&log);
            let steps = &outliers(&set).steps;
            let said = steps.iter().filter(|step| {
                (step.size - size).abs() < 0.02 && (step.time_s - begins_s).abs() < 120.0 + gap_s
            });
            let (said, wrong) = (said.count(), error(&set, &clean));
            // Without a gap, the temperature of the second run comes at once.
            let mut rejections = judgement.rejections.iter();
            let is_judged = match gap_s < 1.0 {
                true => rejections.all(|of| of.code == RejectionCode::TemperatureJump),
                false => judgement.is_accepted(),
            };
            if said != 3 || steps.len() != 3 || wrong > WRONG || !is_judged {
                missed.push(format!("{gap_s} s {size}: {wrong:.4} {steps:?}"));
            }
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

/// A turn that goes on to the end, or begins before the log: nobody knows which side is at rest.
#[test]
fn a_turn_without_an_end_is_a_step() {
    let clean = run(&RUN, 1);
    for (number, rate) in [0.4, -0.5, 3.0, -10.0, 100.0].into_iter().enumerate() {
        for times_s in [(0.0, 700.0), (1300.0, 1e9), (2250.0, 1e9), (3700.0, 1e9)] {
            let axis = number % 3;
            let mut log = run(&RUN, 800 + number as u64);
            add(&mut log, axis, times_s, |_| rate);
            let (set, judgement) = fitted(&log);
            let found = outliers(&set);
            let large = judgement.rejections.iter().map(|of| of.code);
            let large = large
                .filter(|of| *of == RejectionCode::LargeBiasStep)
                .count();
            assert!(
                found.steps.iter().any(|step| step.levelled),
                "{rate} {times_s:?} {found:?}"
            );
            assert_eq!(
                large,
                usize::from(rate.abs() > 1.0),
                "{rate} {times_s:?} {found:?}"
            );
            assert!(error(&set, &clean) < WRONG, "{rate} {times_s:?}");
        }
    }
}

/// A gap alone, with hysteresis or not, is no power cycle.
#[test]
fn a_gap_is_no_step() {
    for (world, seed) in [
        (worlds::World::Full, 1),
        (worlds::World::Lagged, 2),
        (worlds::World::Smooth, 3),
    ] {
        for hole in [20_000..21_000, 40_000..47_000, 60_000..60_300] {
            let mut log = worlds::simulate(world, worlds::ChamberRun::ManyRates, seed, 1).log;
            log.time_s.drain(hole.clone());
            log.channels[0].temp_c.drain(hole.clone());
            for axis in &mut log.channels[0].axes {
                axis.raw.drain(hole.clone());
            }
            let set = fitted(&log).0;
            let found = outliers(&set);
            assert!(
                found.steps.is_empty() && found.disturbances.is_empty(),
                "{world:?} {found:?}"
            );
        }
    }
}

/// Earth's rate changes as a unit of navigation grade is put up again: a step, and a warning.
#[test]
fn a_unit_put_up_again_is_warned_of() {
    let mut log = worlds::simulate(worlds::World::Full, worlds::ChamberRun::ManyRates, 1, 1).log;
    let clean = fitted(&log).0;
    log.channels[0].axes[2].raw[50_000..]
        .iter_mut()
        .for_each(|raw| *raw += 15.0);
    let (set, judgement) = fitted(&log);
    let steps = &outliers(&set).steps;
    assert!(judgement.is_accepted() && steps.len() == 1, "{judgement:?}");
    assert!((steps[0].size - 15.0).abs() < 0.1 && steps[0].levelled && !steps[0].large);
    let lines = |set: &CoefficientSet| -> Vec<f64> {
        set.channels[0].axes[2]
            .polynomials
            .iter()
            .map(|of| of.a[1])
            .collect()
    };
    for (a, b) in lines(&set).iter().zip(lines(&clean)) {
        assert!((a - b).abs() < 5e-3, "{a} {b}");
    }
}

#[test]
fn thin_runs_are_rejected_or_warned_of() {
    use RejectionCode::ThinRun;
    use WarningCode::{FastTemperature, FewMeans, OneDirection};
    type Run = (f64, f64, bool);
    type Codes = (&'static [RejectionCode], &'static [WarningCode]);
    // Heating for some seconds by some degrees, then back if asked for.
    let cases: [(Run, Codes); 8] = [
        (
            (90.0, 60.0, false),
            (&[ThinRun], &[FastTemperature, FewMeans, OneDirection]),
        ),
        (
            (180.0, 16.0, false),
            (&[ThinRun], &[FewMeans, OneDirection]),
        ),
        ((190.0, 16.0, true), (&[], &[FewMeans])),
        ((900.0, 13.0, true), (&[ThinRun], &[])),
        ((900.0, 16.0, true), (&[], &[])),
        ((900.0, 16.0, false), (&[], &[OneDirection])),
        ((420.0, 40.0, false), (&[], &[FewMeans, OneDirection])),
        ((1200.0, 60.0, true), (&[], &[])),
    ];
    for ((length_s, span_c, back), (rejections, warnings)) in cases {
        let up = (length_s, 10.5 + span_c);
        let profile = [(0.0, 10.5), up, (2.0 * length_s, 10.5)];
        let (_, judgement) = fitted(&run(&profile[..2 + usize::from(back)], 9));
        let codes: Vec<_> = judgement.rejections.iter().map(|of| of.code).collect();
        assert_eq!(codes, rejections, "{length_s} s {span_c} degC");
        let mut codes: Vec<_> = judgement.warnings.iter().map(|of| of.code).collect();
        codes.retain(|of| [FewMeans, OneDirection, FastTemperature].contains(of));
        codes.sort_unstable();
        let mut expected = warnings.to_vec();
        expected.sort_unstable();
        assert_eq!(codes, expected, "{length_s} s {span_c} degC");
    }
}

/// A small step is found in a short run as well.
#[test]
fn steps_show_in_short_runs() {
    let mut missed = Vec::new();
    let cases = [
        (900.0, 2, 0.25),
        (1800.0, 2, 0.25),
        (2250.0, 0, 0.1),
        (2250.0, 1, -0.1),
        (2250.0, 2, 0.25),
        (3300.0, 0, 0.1),
        (3300.0, 1, -0.1),
        (3300.0, 2, 0.25),
    ];
    for (seed, (at_s, axis, size)) in cases.into_iter().enumerate() {
        let mut log = run(&RUN, 700 + seed as u64);
        add(&mut log, axis, (at_s, 1e9), |_| size);
        let set = fitted(&log).0;
        let steps = &outliers(&set).steps;
        let near = |step: &tempco_set::BiasStep| (step.time_s - at_s).abs() < 60.0;
        let name = ["x", "y", "z"][axis];
        if !steps.iter().any(|step| step.axis == name && near(step)) {
            missed.push(format!("{at_s} {name} {size}: {steps:?}"));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}
