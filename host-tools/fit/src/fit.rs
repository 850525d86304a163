//! The fit: logs in, coefficient set out.

use tempco::ThermalSettings;
use tempco_evaluate::judge;
use tempco_log::{Log, parallel};
use tempco_set::run::thermal_period_s;
use tempco_set::{
    Candidate, ChannelSet, CoefficientSet, Input, Judgement, Model, Provenance, Segmentation,
    Selection, Settings, Warning, build,
};

use crate::channel_fit::Findings;
use crate::error::FitError;
use crate::least_squares::Blocks;
use crate::method::Method;
use crate::options::{FitOptions, Plan, PlanOptions};
use crate::outliers;
use crate::spline::auto::{Answer, Chosen, Question};
use crate::summary::{ChannelData, LogSummary, summarise_log};
use crate::{extent, segments, statistics};

/// The whole log must span this much for a fit to mean anything \[degC\].
const LEAST_SPAN_C: f32 = 10.0;

/// A fitted set.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The set.
    pub set: CoefficientSet,
    /// What the set does not hold of its fit.
    pub warnings: Vec<Warning>,
}

impl Fit {
    /// The judgement on the set, before it has seen a verification log.
    pub fn judge(&self) -> Judgement {
        let mut judgement = judge(&self.set, None);
        judgement.warnings.extend_from_slice(&self.warnings);
        judgement
    }
}

/// Fits a coefficient set to one or more logs of a unit.
///
/// Every log is run through the core as a unit switched on at its first row; the regressors are
/// what the core computed.
///
/// # Errors
/// Logs that do not belong together, a log without a usable row, too little temperature span,
/// segments without data.
pub fn fit(logs: &[Log], options: &FitOptions) -> Result<Fit, FitError> {
    let plan = Plan::new(options.plan.clone())?;
    fit_summaries(
        &parallel::map(logs, |log| summarise_log(log, &plan)),
        options,
    )
}

/// Fits a coefficient set to summaries of one or more logs of a unit. Logs that were summarised apart
/// give the same as logs that were summarised together, in whatever order they are given.
///
/// # Errors
/// Those of [`fit`]; a log that was summarised by another plan than the one in the options.
pub fn fit_summaries(logs: &[LogSummary], options: &FitOptions) -> Result<Fit, FitError> {
    let mut logs: Vec<&LogSummary> = logs.iter().collect();
    if logs.len() > 1 {
        logs.sort_by_cached_key(|log| log.order());
    }
    let first = logs.first().ok_or(FitError::NoLogs)?;
    for log in &logs {
        check_plan(log, &options.plan)?;
        check_same_axes(first, log)?;
        check_interval(log, &options.plan.thermal)?;
    }

    let mut warnings = Vec::new();
    let mut channels = Vec::new();
    let mut data: Vec<ChannelData> = (0..first.channels.len())
        .map(|channel| ChannelData::new(&logs, channel))
        .collect();
    for data in &mut data {
        channels.push(fit_channel(data, options, &mut warnings)?);
    }
    let periods_s = logs.iter().map(|log| thermal_period_s(log.interval_s));
    let mut set = build::set(
        options.serial.clone(),
        Provenance {
            tool: build::tool(),
            created: build::now(),
            inputs: logs.iter().map(|log| input(log)).collect(),
        },
        Settings {
            model: options.method.model(),
            overlap: options.method.overlap(),
            scale_factor_arcsec: options.plan.scale_factor_arcsec,
            thermal_period_s: periods_s.fold(0.0, f64::max),
        },
        channels,
    );
    statistics::note(&mut set, &mut data, options.plan.tau_s).map_err(FitError::Settings)?;
    Ok(Fit { set, warnings })
}

fn fit_channel(
    data: &mut ChannelData,
    options: &FitOptions,
    warnings: &mut Vec<Warning>,
) -> Result<ChannelSet, FitError> {
    // What does not belong goes first, so that no later step sees it.
    check_rows(data)?;
    let plan = &options.plan;
    let mut outliers =
        outliers::leave_out(data, &plan.thermal, plan.robust).map_err(FitError::Settings)?;
    check_rows(data)?;
    let extent = extent::of(data, plan.thermal.max_slew_c_per_min.into());
    outliers.extent = extent.is_thin().then_some(extent);
    // Without a range of temperature there is nothing to fit.
    let (t_min_c, t_max_c) = data.range(|block| block.effective_range_c);
    let span_c = t_max_c - t_min_c;
    if span_c < LEAST_SPAN_C {
        return Err(FitError::Span {
            files: data.files(),
            temperature: data.temperature().to_owned(),
            span_c,
        });
    }
    // Segments are needed by every method: the default is compared with the paper's models.
    let method = &options.method;
    let segmentation = match method.segmentation() {
        Some(given) => given.clone(),
        None => Segmentation::over(f64::from(t_min_c), f64::from(t_max_c))?,
    };
    let blocks = Blocks::new(data);
    let question = Question {
        data,
        blocks: &blocks,
        settings: plan.thermal,
        method,
    };
    let folds = question.folds();
    let (mut fitted, chosen, candidate) = match method {
        Method::Segments { model, .. } => {
            let division = (&segmentation, method.overlap());
            let terms = Model::from(*model).terms();
            let fit = segments::fit(data, plan.thermal, terms, division, warnings)?;
            (fit, Chosen::Segments(*model), None)
        }
        Method::Auto { .. } => {
            let answer = question.answer(plan.search, &folds)?;
            let answer = answer.ok_or_else(|| FitError::Short {
                files: data.files(),
                block_s: data.of(0).block_s,
            })?;
            let Answer {
                fit,
                held_out,
                chosen,
            } = answer;
            (fit, Chosen::HeldOut(held_out), Some(chosen))
        }
    };
    // Held-out errors of the model that flies and of the usual ones, on the same folds.
    let held_out = question
        .comparison(&segmentation, &folds, chosen)
        .map_err(FitError::Settings)?;
    let selection = candidate.map(|candidate| Selection {
        soaks_and_ramps: folds.soaks_and_ramps,
        folds: folds.count,
        ramp_rates_c_per_min: folds.ramp_rates,
        chosen: Candidate {
            rmse: held_out.iter().filter_map(|of| of.chosen).collect(),
            ..candidate
        },
        others: Vec::new(),
    });
    // Axes whose terms do no better than a constant do without them.
    for (axis, errors) in held_out.iter().enumerate() {
        if errors.left_out.is_some() {
            fitted.keep_constant(axis, blocks.mean(axis));
        }
    }
    let findings = Findings {
        outliers,
        selection,
        held_out,
    };
    Ok(fitted.into_set(data, findings))
}

fn input(log: &LogSummary) -> Input {
    let channels = log.channels.iter();
    Input {
        file: log.file.clone(),
        sha256: log.sha256.clone(),
        rows: log.rows,
        skipped_rows: log.skipped_rows.total(),
        skipped: log.skipped_rows,
        unusable_rows: channels.map(|channel| channel.unusable_rows).sum(),
        interval_s: log.interval_s,
        duration_s: log.duration_s,
        findings: log.findings.clone(),
        doubts: log.reading.doubts.clone(),
        mapping: log.reading.mapping.clone(),
    }
}

fn check_plan(log: &LogSummary, options: &PlanOptions) -> Result<(), FitError> {
    let other = log.plan.options();
    if other == options {
        return Ok(());
    }
    let differs = [
        (
            "--max-slew, --rate-tau or --kappa",
            other.thermal != options.thermal,
        ),
        ("--rate-tau or --kappa", other.search != options.search),
        ("--exclude", other.exclude != options.exclude),
        ("--keep-outliers", other.robust != options.robust),
        (
            "--scale-factor",
            other.scale_factor_arcsec != options.scale_factor_arcsec,
        ),
        ("--tau", other.tau_s != options.tau_s),
    ];
    let differs = differs.iter().find(|(_, differs)| *differs);
    Err(FitError::Plan {
        file: log.file.clone(),
        option: differs.map_or("another option", |(option, _)| option),
    })
}

fn check_same_axes(first: &LogSummary, log: &LogSummary) -> Result<(), FitError> {
    let describe = |log: &LogSummary| {
        let channels = log.channels.iter().map(|channel| {
            let axes = channel
                .axes
                .iter()
                .map(|a| format!("{}_{}", a.name, a.unit.name()));
            let axes: Vec<String> = axes.collect();
            format!("{} [{}]", channel.column, axes.join(", "))
        });
        channels.collect::<Vec<_>>().join("; ")
    };
    if describe(first) == describe(log) {
        Ok(())
    } else {
        Err(FitError::Different {
            first: format!("{}: {}", first.file, describe(first)),
            other: format!("{}: {}", log.file, describe(log)),
        })
    }
}

fn check_interval(log: &LogSummary, thermal: &ThermalSettings) -> Result<(), FitError> {
    if log.interval_s > 0.5 * f64::from(thermal.tau_s) {
        return Err(FitError::Interval {
            file: log.file.clone(),
            interval_s: log.interval_s,
            tau_s: thermal.tau_s,
        });
    }
    Ok(())
}

/// Every log needs rows to fit, or its constant bias could be anything.
fn check_rows(data: &ChannelData) -> Result<(), FitError> {
    let mut logs = data.logs.iter().zip(&data.keep);
    let Some((log, _)) = logs.find(|(_, keep)| !keep.contains(&true)) else {
        return Ok(());
    };
    let channel = &log.channels[data.channel];
    let (excluded_rows, unusable_rows) = (channel.excluded_rows, channel.unusable_rows);
    Err(FitError::NoRows {
        file: log.file.clone(),
        rows: log.rows,
        excluded_rows,
        unusable_rows,
        outlying_rows: log.rows - excluded_rows - unusable_rows,
    })
}
