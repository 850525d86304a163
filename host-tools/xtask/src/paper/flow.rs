//! The paper's calibration, on a simulated unit.

use anyhow::{Context, Result};
use tempco_evaluate::evaluate;
use tempco_fit::{FitOptions, Method, SegmentModel, SegmentOverlap, fit};
use tempco_log::{Axis, AxisUnit, Channel, Log, SkippedRows};
use tempco_set::{CoefficientSet, Segmentation};
use tempco_twin::{AXIS_NAMES, DEFAULT_RATE_HZ, Profile, Simulation, Step, Unit};

use super::printed::SEGMENTS;

/// Averaging time of the paper's smoothed output; not printed, 100 s are usual \[s\].
pub(super) const TAU_S: f64 = 100.0;

/// What one seed gave; by axis X, Y, Z in pulses/s.
pub(super) struct Outcome {
    /// Sigma of the static run that was fitted: uncompensated, without overlap, with overlap.
    pub(super) table_1: [[f64; 3]; 3],
    /// Sigma of a second static run: without overlap, with overlap.
    pub(super) unseen: [[f64; 2]; 3],
    /// Largest boundary jump at a hard switch: without overlap, with overlap.
    pub(super) jumps: [[f64; 2]; 3],
    /// a0, a1 and a2 of each segment of the static model with overlap.
    pub(super) table_2: [Vec<[f64; 3]>; 3],
    /// Sigma of an unseen variable-temperature run: uncompensated, static, composite, and the
    /// default model from the same logs.
    pub(super) table_3: [[f64; 4]; 3],
}

pub(super) fn run(seed: u64) -> Result<Outcome> {
    let unit = Unit::named("paper")?;
    let soaks = Profile::named("static")?;
    // No two runs of all seeds share their noise.
    let log = |profile: &Profile, number: u64| simulate(&unit, profile, 4 * seed + number);
    let (static_log, unseen_log) = (log(&soaks, 0)?, log(&soaks, 1)?);
    let variable_log = log(&variable("variable", [0.5, 1.0, 2.0])?, 2)?;
    let verification_log = log(&variable("verification", [0.7, 1.5, 1.0])?, 3)?;

    let static_logs = std::slice::from_ref(&static_log);
    let segments: Segmentation = SEGMENTS.parse().context("the paper's segments")?;
    let of_paper = |model, overlap| Method::Segments {
        model,
        overlap,
        segmentation: Some(segments.clone()),
    };
    let of_static = |overlap| of_paper(SegmentModel::Static, overlap);
    let without = calibrate(static_logs, of_static(SegmentOverlap::None))?;
    let with = calibrate(static_logs, of_static(SegmentOverlap::Linear))?;
    // The same polynomials as with the blend, switched as without overlap: what of the smoothness
    // is owed to the fit.
    let switched = calibrate(static_logs, of_static(SegmentOverlap::Hard))?;
    let both_logs = [static_log, variable_log];
    let composite = of_paper(SegmentModel::Composite, SegmentOverlap::Linear);
    let composite = calibrate(&both_logs, composite)?;
    let auto = calibrate(&both_logs, Method::AUTO)?;

    let [static_log, _] = &both_logs;
    let of_without = sigmas(&without, static_log)?;
    let of_with = sigmas(&with, static_log)?;
    let unseen_without = sigmas(&without, &unseen_log)?;
    let unseen_with = sigmas(&with, &unseen_log)?;
    let static_alone = sigmas(&with, &verification_log)?;
    let of_composite = sigmas(&composite, &verification_log)?;
    let of_auto = sigmas(&auto, &verification_log)?;
    let jump = |set: &CoefficientSet, axis| f64::from(set.channels[0].table.max_jump(axis));
    let axes = [0, 1, 2];
    Ok(Outcome {
        table_1: axes.map(|a| [of_with[a].0, of_without[a].1, of_with[a].1]),
        unseen: axes.map(|a| [unseen_without[a].1, unseen_with[a].1]),
        jumps: axes.map(|a| [jump(&without, a), jump(&switched, a)]),
        table_2: axes.map(|a| static_coefficients(&with, a)),
        table_3: axes.map(|a| {
            let raw = of_composite[a].0;
            [raw, static_alone[a].1, of_composite[a].1, of_auto[a].1]
        }),
    })
}

/// Cycles between 5 and 35 degC, one at each rate \[degC/min\].
fn variable(name: &str, rates: [f64; 3]) -> Result<Profile> {
    let ramp = |to_c, rate_c_per_min| Step::Ramp {
        to_c,
        rate_c_per_min,
    };
    let mut steps = vec![Step::Soak {
        air_c: 20.0,
        duration_min: 20.0,
    }];
    for rate in rates {
        steps.extend([ramp(35.0, rate), ramp(5.0, rate), ramp(20.0, rate)]);
    }
    Ok(Profile::new(name, 20.0, &steps)?)
}

fn simulate(unit: &Unit, profile: &Profile, seed: u64) -> Result<Log> {
    let (mut time_s, mut temp_c) = (Vec::new(), Vec::new());
    let mut raw = [(); 3].map(|()| Vec::new());
    for sample in Simulation::new(unit, profile, seed, DEFAULT_RATE_HZ)? {
        time_s.push(sample.time_s);
        temp_c.push(sample.temp_c as f32);
        for (raw, pulses) in raw.iter_mut().zip(sample.counts) {
            raw.push(pulses as f64 * DEFAULT_RATE_HZ);
        }
    }
    let axes = AXIS_NAMES.into_iter().zip(raw).map(|(name, raw)| Axis {
        name: name.to_owned(),
        unit: AxisUnit::PulsesPerS,
        raw,
    });
    Ok(Log {
        file: format!("{} {seed}", profile.name()),
        sha256: String::new(),
        time_s,
        channels: vec![Channel {
            column: "temp_c".to_owned(),
            temp_c,
            axes: axes.collect(),
        }],
        reading: tempco_log::Reading::default(),
        ignored_columns: Vec::new(),
        skipped_rows: SkippedRows::default(),
        interval_s: 1.0 / DEFAULT_RATE_HZ,
    })
}

fn calibrate(logs: &[Log], method: Method) -> Result<CoefficientSet> {
    let mut options = FitOptions::new("PAPER", method);
    options.plan.tau_s = TAU_S;
    Ok(fit(logs, &options)?.set)
}

/// Sigma of each axis without and with compensation.
fn sigmas(set: &CoefficientSet, log: &Log) -> Result<Vec<(f64, f64)>> {
    let axes = evaluate(set, log, None, TAU_S)?.axes;
    let sigmas = axes.iter().map(|a| (a.sigma_raw, a.sigma_compensated));
    Ok(sigmas.collect())
}

fn static_coefficients(set: &CoefficientSet, axis: usize) -> Vec<[f64; 3]> {
    let polynomials = set.channels[0].axes[axis].polynomials.iter();
    polynomials
        .map(|polynomial| {
            let [a0, a1, a2, ..] = polynomial.raw();
            [a0, a1, a2]
        })
        .collect()
}
