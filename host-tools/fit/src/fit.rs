//! The fit: logs in, coefficient set out.

use tempco::ThermalSettings;
use tempco_log::{Log, parallel};
use tempco_set::{
    Candidate, ChannelSet, CoefficientSet, Input, Model, Overlap, Provenance, Screening,
    Segmentation, Selection, Settings, assemble,
};

use crate::channel_fit::Findings;
use crate::error::FitError;
use crate::least_squares::{Blocks, RateForm};
use crate::options::{FitOptions, States};
use crate::outliers::screen;
use crate::spline::{self, Choice, Chosen, FixedLag, LEAST_RATES, Question, Spline};
use crate::summary::{ChannelData, LogDigest, digest_log};
use crate::{segments, statistics};

/// The whole log must span this much for a fit to mean anything \[degC\].
const LEAST_SPAN_C: f32 = 10.0;

/// A rounding bound beyond this share of the compensated bias stability is remarked on.
const LARGE_ROUNDING: f64 = 0.01;

/// A fitted set and what its user should know of it.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The set.
    pub set: CoefficientSet,
    /// Remarks, such as terms that were dropped.
    pub remarks: Vec<String>,
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
    let plan = options.plan()?;
    fit_digests(&parallel::map(logs, |log| digest_log(log, &plan)), options)
}

/// Fits a coefficient set to digests of one or more logs of a unit. Logs that were digested apart
/// give the same as logs that were digested together.
///
/// # Errors
/// Those of [`fit`].
///
/// # Panics
/// If the logs were not digested by the [plan](FitOptions::plan) of these options.
pub fn fit_digests(logs: &[LogDigest], options: &FitOptions) -> Result<Fit, FitError> {
    let first = logs.first().ok_or(FitError::NoLogs)?;
    let plan = options.plan()?;
    assert!(logs.iter().all(|log| log.plan == plan));
    let options = &FitOptions {
        thermal: options.thermal_settings(),
        ..options.clone()
    };
    for log in logs {
        check_same_axes(first, log)?;
        check_interval(log, &options.thermal)?;
    }

    let mut remarks = Vec::new();
    let mut channels = Vec::new();
    let mut data: Vec<ChannelData> = (0..first.channels.len())
        .map(|channel| ChannelData::new(logs, channel))
        .collect();
    for data in &mut data {
        channels.push(fit_channel(data, options, &mut remarks)?);
    }
    let mut set = assemble::set(
        options.serial.clone(),
        Provenance {
            tool: assemble::tool(),
            created: assemble::now(),
            inputs: logs.iter().map(input).collect(),
        },
        Settings {
            model: options.model,
            overlap: match options.model {
                Model::Spline => Overlap::Spline,
                _ => options.overlap,
            },
            scale_factor_arcsec: options.scale_factor_arcsec,
        },
        channels,
    );
    statistics::note(&mut set, &mut data, options.tau_s).map_err(FitError::Settings)?;
    remark_on_set(&set, &mut remarks);
    Ok(Fit { set, remarks })
}

fn fit_channel(
    data: &mut ChannelData,
    options: &FitOptions,
    remarks: &mut Vec<String>,
) -> Result<ChannelSet, FitError> {
    check_rows(data)?;
    let screening = screen(data, &options.thermal, options.robust).map_err(FitError::Settings)?;
    check_rows(data)?;
    remark_on_screening(data, &screening, remarks);
    let (t_min_c, t_max_c) = data.range(|block| block.effective_range_c);
    let span_c = t_max_c - t_min_c;
    if span_c < LEAST_SPAN_C {
        return Err(FitError::Span {
            files: data.files(),
            temperature: data.temperature().to_owned(),
            span_c,
        });
    }
    let segmentation = match &options.segments {
        Some(segmentation) => segmentation.clone(),
        None => Segmentation::over(f64::from(t_min_c), f64::from(t_max_c))?,
    };
    let blocks = Blocks::new(data);
    let question = Question {
        data,
        blocks: &blocks,
        settings: options.thermal,
        fixed: FixedLag {
            tau_s: options.rate_tau_s.map(f64::from),
            kappa: options.kappa.map(f64::from),
        },
        segments: options.segments.as_ref(),
        overlap: options.overlap,
        all_models: options.model == Model::Auto,
        states: options.states == States::Auto,
    };
    let (choice, selection, chosen) = match options.model {
        Model::Static | Model::Composite => {
            let choice = Choice::Segments {
                model: options.model,
                segmentation: segmentation.clone(),
            };
            (choice, None, Chosen::Model(options.model))
        }
        Model::Spline | Model::Auto => {
            let answer = question.answer().map_err(FitError::Settings)?;
            let (choice, selection, held_out) = answer.ok_or_else(|| FitError::Short {
                files: data.files(),
                block_s: data.of(0).block_s,
            })?;
            (choice, Some(selection), Chosen::HeldOut(held_out))
        }
    };
    let held_out = question
        .comparison(&segmentation, chosen)
        .map_err(FitError::Settings)?;
    let fitted = match choice {
        Choice::Segments {
            model,
            segmentation,
        } => {
            if model == Model::Static && options.model == Model::Auto {
                remark_without_rates(data, remarks);
            }
            let division = (&segmentation, options.overlap);
            segments::fit(data, options.thermal, model.terms(), division, remarks)?
        }
        Choice::Spline(spline) => {
            if let (Some(selection), States::Auto) = (&selection, options.states) {
                remark_on_states(data, &spline, selection, remarks);
            }
            remark_on_rates(data, &spline, remarks);
            spline::fit(data, options.thermal, &spline)?
        }
    };
    let findings = Findings {
        screening,
        selection,
        held_out,
    };
    Ok(fitted.into_set(data, findings))
}

fn remark_on_screening(data: &ChannelData, found: &Screening, remarks: &mut Vec<String>) {
    let temperature = data.temperature();
    let counts = [
        (found.excluded_rows, "in excluded stretches"),
        (found.spike_rows, "spikes"),
        (found.disturbed_rows, "disturbed for 10 s or more"),
    ];
    for (rows, why) in counts.into_iter().filter(|(rows, _)| *rows > 0) {
        remarks.push(format!("{temperature}: {rows} rows left out: {why}"));
    }
    for step in &found.steps {
        remarks.push(format!(
            "{}: the bias of {} steps by {:+.3e} at {:.0} s; leave the stretch out by --exclude if \
             it is not of the unit",
            step.file, step.axis, step.size, step.time_s
        ));
    }
}

/// Says that no axis has rate terms.
fn remark_without_rates(data: &ChannelData, remarks: &mut Vec<String>) {
    remarks.push(format!(
        "{}: not improvable by the rate of temperature, as far as these logs tell: the model has no \
         rate terms and no lag shift (they are tried where the logs hold four soaks and ramps or \
         more, at rates that differ)",
        data.temperature()
    ));
}

/// Says which axes are left without rate terms, and why.
fn remark_on_rates(data: &ChannelData, spline: &Spline, remarks: &mut Vec<String>) {
    let channel = data.of(0);
    if spline.rate == RateForm::None {
        remark_without_rates(data, remarks);
        return;
    }
    let without = channel
        .axes
        .iter()
        .zip(&spline.axes)
        .filter(|(_, with)| !with.rate);
    for (axis, _) in without {
        remarks.push(format!(
            "axis {}: rate terms do not improve what was left out of the fit by more than one \
             standard error; dropped",
            axis.name
        ));
    }
}

/// Says why no states were tried, and which axes are left without those that were earned.
fn remark_on_states(
    data: &ChannelData,
    spline: &Spline,
    selection: &Selection,
    remarks: &mut Vec<String>,
) {
    let channel = &data.logs[0].channels[data.channel];
    let earned = !spline.shape.terms().is_empty();
    let axes = channel.axes.iter().zip(&spline.axes);
    for (axis, _) in axes.filter(|(_, with)| earned && !with.states) {
        remarks.push(format!(
            "axis {}: plays and slow part do not improve what was left out of the fit by more than \
             one standard error; dropped",
            axis.name
        ));
    }
    let has_rate = |of: &Candidate| of.model == Model::Spline && of.rate_columns > 0;
    let candidates = std::iter::once(&selection.chosen).chain(&selection.others);
    if candidates.into_iter().any(has_rate) && selection.ramp_rates_c_per_min.len() < LEAST_RATES {
        remarks.push(format!(
            "{}: plays and slow part are not tried: all ramps are of one rate, which tells no \
             hysteresis from a lag and no lag from another",
            channel.column
        ));
    }
}

fn remark_on_set(set: &CoefficientSet, remarks: &mut Vec<String>) {
    for channel in &set.channels {
        if channel.boundary_moved_c > 0.01 {
            remarks.push(format!(
                "boundaries between segments lie on no common grid of 256 cells or fewer and were \
                 moved by up to {:.3} degC",
                channel.boundary_moved_c
            ));
        }
        for (number, axis) in channel.axes.iter().enumerate() {
            if channel.mismatch_alarm(number) {
                remarks.push(format!(
                    "axis {}: neighbouring segments disagree by more than half of the bias range",
                    axis.name
                ));
            }
            let rounding = channel.table.rounding_bound(number).total;
            let sigma = axis
                .statistics
                .map_or(0.0, |figures| figures.sigma_compensated);
            if sigma > 0.0 && rounding > LARGE_ROUNDING * sigma {
                remarks.push(format!(
                    "axis {}: rounding in f32 can cost {rounding:.1e}, more than {:.0} % of the \
                     bias stability with compensation",
                    axis.name,
                    100.0 * LARGE_ROUNDING
                ));
            }
        }
    }
    for input in &set.provenance.inputs {
        if input.unusable_rows > 0 {
            remarks.push(format!(
                "{}: {} rows were not fitted, since their temperature or interval was not believed",
                input.file, input.unusable_rows
            ));
        }
    }
}

fn input(log: &LogDigest) -> Input {
    let channels = log.channels.iter();
    Input {
        file: log.file.clone(),
        sha256: log.sha256.clone(),
        rows: log.rows,
        skipped_rows: log.skipped_rows,
        unusable_rows: channels.map(|channel| channel.unusable_rows).sum(),
        interval_s: log.interval_s,
        duration_s: log.duration_s,
    }
}

fn check_same_axes(first: &LogDigest, log: &LogDigest) -> Result<(), FitError> {
    let describe = |log: &LogDigest| {
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

fn check_interval(log: &LogDigest, thermal: &ThermalSettings) -> Result<(), FitError> {
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
