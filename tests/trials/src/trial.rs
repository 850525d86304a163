//! One unit: calibrated, run over its missions, judged.

use anyhow::{Context, Result};
use serde::Serialize;
use tempco_log::Log;
use tempco_set::Model;
use tempco_twin::AXIS_NAMES;

use crate::fitted::Fitted;
use crate::floor::TrueStates;
use crate::kind::{Purpose, Specimen};
use crate::run::Run;
use crate::spoilt::{Disturbance, spoil};

/// What is tried on each unit.
pub(crate) struct Plan {
    /// Profiles of the calibration, joined by `+`.
    pub(crate) train: String,
    /// The model under trial.
    pub(crate) model: Model,
    /// Whether the minutes after power-on are looked at.
    pub(crate) start: bool,
    /// Whether the model is fitted to spoilt logs as well.
    pub(crate) spoilt: bool,
    /// Whether the true states are fitted as well.
    pub(crate) floor: bool,
}

/// An error of the model under trial and of the composite model, from the same log \[unit of the axis\].
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Pair {
    /// Of the model.
    pub(crate) model: f64,
    /// Of the composite model.
    pub(crate) composite: f64,
}

impl Pair {
    /// Below 1 where the model is better.
    pub(crate) fn ratio(&self) -> f64 {
        self.model / self.composite
    }
}

/// Errors of the model fitted to logs with a disturbance \[unit of the axis\].
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Spoilt {
    /// With outliers.
    pub(crate) outliers: f64,
    /// With a glitch.
    pub(crate) glitch: f64,
}

/// Errors of least squares on the true states \[unit of the axis\].
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Floor {
    /// On the mission like a verification.
    pub(crate) verification: f64,
    /// On the mission of random ramps.
    pub(crate) wandering: f64,
}

/// How an axis did.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Outcome {
    /// Kind of its unit.
    pub(crate) kind: String,
    /// Seed of its unit.
    pub(crate) seed: u64,
    /// Name.
    pub(crate) axis: &'static str,
    /// What was chosen for its unit.
    chosen: String,
    /// On the mission like a verification.
    pub(crate) verification: Pair,
    /// On the mission of random ramps.
    pub(crate) wandering: Pair,
    /// In minutes 1 to 10 after power-on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) start: Option<Pair>,
    /// On the mission like a verification, of the model fitted to spoilt logs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) spoilt: Option<Spoilt>,
    /// With the true states, on both missions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) floor: Option<Floor>,
    /// Codes by which the fit says that the model is no better than the composite model, or none.
    pub(crate) said: Vec<&'static str>,
}

/// Tries a unit. The outcome of each axis.
///
/// # Errors
/// An unknown kind or profile, a fit that fails.
pub(crate) fn of_unit(kind: &str, seed: u64, plan: &Plan) -> Result<Vec<Outcome>> {
    try_unit(kind, seed, plan).with_context(|| format!("{kind}/{seed}"))
}

fn try_unit(kind: &str, seed: u64, plan: &Plan) -> Result<Vec<Outcome>> {
    let specimen = Specimen::new(kind, seed)?;
    let training = specimen.training(&plan.train)?;
    let logs = logs(&training);
    let model = Fitted::new(plan.model, &logs)?;
    let composite = Fitted::new(Model::Composite, &logs)?;

    let errors = |errors: fn(&Fitted, &Run) -> Result<Vec<f64>>, mission: &Run| {
        let [model, composite] = [errors(&model, mission)?, errors(&composite, mission)?];
        let pairs = model.iter().zip(&composite);
        let pairs = pairs.map(|(&model, &composite)| Pair { model, composite });
        Ok::<_, anyhow::Error>(pairs.collect::<Vec<_>>())
    };
    let mission = specimen.mission(Purpose::Verification)?;
    let verification = errors(Fitted::errors, &mission)?;
    let wander = specimen.mission(Purpose::Wandering)?;
    let wandering = errors(Fitted::errors, &wander)?;
    let start = match plan.start {
        true => Some(errors(
            Fitted::start_errors,
            &specimen.mission(Purpose::Start)?,
        )?),
        false => None,
    };
    let spoilt = match plan.spoilt {
        true => {
            let of = |disturbance| {
                let logs = self::logs(&spoilt(&training, disturbance, seed));
                Fitted::new(plan.model, &logs)?.errors(&mission)
            };
            let [outliers, glitch] = [of(Disturbance::Outliers)?, of(Disturbance::Glitch)?];
            let pairs = outliers.into_iter().zip(glitch);
            let errors = pairs.map(|(outliers, glitch)| Spoilt { outliers, glitch });
            Some(errors.collect::<Vec<_>>())
        }
        false => None,
    };

    let floor = |axis: usize| {
        plan.floor.then(|| {
            let states = TrueStates::fit(&specimen.unit, axis, &training);
            Floor {
                verification: states.error(&mission),
                wandering: states.error(&wander),
            }
        })
    };

    let chosen = model.description();
    let said = model.said();
    let outcome = |axis: usize| Outcome {
        kind: kind.to_owned(),
        seed,
        axis: AXIS_NAMES[axis],
        chosen: chosen.clone(),
        verification: verification[axis],
        wandering: wandering[axis],
        start: start.as_ref().map(|of| of[axis]),
        spoilt: spoilt.as_ref().map(|of| of[axis]),
        floor: floor(axis),
        said: said[axis].clone(),
    };
    Ok((0..AXIS_NAMES.len()).map(outcome).collect())
}

/// The runs of a calibration, each with a disturbance of its own.
fn spoilt(runs: &[Run], disturbance: Disturbance, seed: u64) -> Vec<Run> {
    let runs = runs.iter().zip(0..).map(|(run, number)| {
        let mut run = run.clone();
        spoil(&mut run, disturbance, 1000 * seed + number);
        run
    });
    runs.collect()
}

fn logs(runs: &[Run]) -> Vec<Log> {
    runs.iter().map(|run| run.log.clone()).collect()
}
