//! How a set does on a log: all figures of all axes.

use std::ops::RangeInclusive;
use std::path::Path;

use serde::Serialize;
use tempco_log::signals::{self, Finding};
use tempco_log::{AxisUnit, Doubt, Log, ReadOptions, SkippedRows, Survey};
use tempco_set::run::{ApplyError, KnownLog, Part, RunError, apply_to_file, apply_to_log};
use tempco_set::{ChannelSet, CoefficientSet, CoefficientSigmas, SegmentSet};
use thiserror::Error;

use crate::correlation::{Correlation, chance, pearson};
use crate::curve::AllanOfAxis;
use crate::hysteresis::Hysteresis;
use crate::means::Means;
use crate::measured::Measured;
use crate::reference::Reference;
use crate::stability::Stability;
use crate::sums::{Gathered, LogSums};

/// Averaging times that can be asked for \[s\]: from the shortest time between rows to decades.
pub const TAU_RANGE_S: RangeInclusive<f64> = 1e-4..=1e9;

/// Averaging times at which the bias stability is always stated \[s\], with the one asked for.
const TAUS_S: [f64; 2] = [10.0, 100.0];

/// How a set does on a log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// The log, and whether the set was fitted to it.
    pub log: JudgedLog,
    /// Averaging time of the figures that do not state their own \[s\].
    pub tau_s: f64,
    /// What the compensation is compared with, beside none: see [`evaluate`].
    pub reference: String,
    /// The axes in the order of the set.
    pub axes: Vec<AxisEvaluation>,
    /// Largest jump of each axis's bias between neighbouring cells of its table, at zero, lowest
    /// and highest rate \[unit of the axis\].
    pub max_boundary_jump: Vec<f64>,
    /// For each flag that occurred, the number of rows with it.
    pub status_rows: Vec<(&'static str, usize)>,
    /// The rows outside the calibrated range of temperature or rate; none without such a row.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outside: Option<Outside>,
    /// For each temperature channel, the segments and what of them the fit had seen.
    pub segments: Vec<Vec<SegmentSet>>,
}

/// The log that a set is judged on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JudgedLog {
    /// Name of the file.
    pub file: String,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Rows.
    pub rows: usize,
    /// Whether the set was fitted to it.
    pub role: Role,
    /// What is wrong with its signals.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<Finding>,
    /// What a person must judge of how it was read.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<Doubt>,
    /// Rows left out on reading because skipping bad rows was asked for, by reason.
    #[serde(skip_serializing_if = "is_empty")]
    pub skipped: SkippedRows,
}

fn is_empty(skipped: &SkippedRows) -> bool {
    *skipped == SkippedRows::default()
}

/// Rows of which the temperature was clamped to the calibrated range, or the rate in a set with rate
/// terms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Outside {
    /// Their number.
    pub rows: usize,
    /// Time of the first one \[s\].
    pub from_s: f64,
    /// Time of the last one \[s\].
    pub to_s: f64,
}

/// What a log is to a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Its hash is among the inputs of the set: the figures are those of a fit, not of a forecast.
    Training,
    /// Its hash is not among them: the figures are out of sample.
    Verification,
    /// The set does not say what it was fitted to, as that of a flash image.
    Unknown,
}

/// Figures of one axis \[unit of the axis\].
///
/// `sigma` is the sample standard deviation of the non-overlapping `tau`-means, the bias
/// stability at `tau`; `rmse` is their root mean square about the axis's mean over the log, since
/// a constant turn-on bias is not thermal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AxisEvaluation {
    /// Name.
    pub axis: String,
    /// Unit.
    pub unit: AxisUnit,
    /// Whether the set takes out a constant alone.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub constant_alone: bool,
    /// Number of `tau`-means.
    pub n: usize,
    /// Bias stability without compensation.
    pub sigma_raw: f64,
    /// Bias stability with compensation.
    pub sigma_compensated: f64,
    /// `1 - sigma_compensated / sigma_raw`; negative where compensation does harm.
    pub improvement: f64,
    /// RMS without compensation.
    pub rmse_raw: f64,
    /// RMS with compensation.
    pub rmse_compensated: f64,
    /// Largest deviation of a `tau`-mean with compensation.
    pub max_abs_compensated: f64,
    /// Largest deviation of a `tau`-mean without compensation.
    pub max_abs_raw: f64,
    /// Bias stability at 10 s, 100 s and the `tau` asked for.
    pub bias_stability: Vec<Stability>,
    /// Correlation of the `tau`-means with the temperature and its rate, without compensation.
    pub correlation_raw: Measured<Correlation>,
    /// The same of what remains; about 0 where the set has taken out what follows temperature.
    pub correlation_compensated: Measured<Correlation>,
    /// Heating against cooling.
    pub hysteresis: Measured<Hysteresis>,
    /// Allan deviations.
    pub allan: AllanOfAxis,
    /// Disagreement and jump at each boundary between segments, coldest first.
    pub boundaries: Vec<Boundary>,
    /// For each segment, the standard deviations of its coefficients; empty in an imported set.
    pub coefficient_sigmas: Vec<CoefficientSigmas>,
}

/// What happens between two segments \[unit of the axis\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Boundary {
    /// Cold end of the overlap \[degC\].
    pub t_min_c: f64,
    /// Hot end of the overlap \[degC\].
    pub t_max_c: f64,
    /// Largest difference of the static polynomials over the overlap.
    pub overlap_mismatch: f64,
    /// Largest jump of the table within the overlap, its ends included, at zero, lowest and
    /// highest rate, in the core's own arithmetic.
    pub jump: f64,
}

/// Evaluates `set` on `log`, both run through the core.
///
/// The improvement is stated against no compensation and against a reference: `against`, if given,
/// else the static part of `set` (its rate terms and `kappa` at 0), which is what a compensation
/// by temperature alone would do.
///
/// # Errors
/// `tau_s` outside [`TAU_RANGE_S`], a log without an axis or temperature of a set, rows further
/// apart than `tau_s`, fewer than two full stretches of `tau_s`.
pub fn evaluate(
    set: &CoefficientSet,
    log: &Log,
    against: Option<&CoefficientSet>,
    tau_s: f64,
) -> Result<Evaluation, EvaluateError> {
    let judged = judged_log(set, log, log.rows(), signals::find(log));
    evaluated(
        set,
        judged,
        log.interval_s,
        against,
        tau_s,
        |other, sums| Ok(apply_to_log(set, other, log, |part| sums.push(&part))?),
    )
}

/// Evaluates `set` as [`evaluate`] does, on a file that was read before, in memory that does not grow
/// with its rows. `observer` gets how many more bytes of the file were read.
///
/// # Errors
/// Those of [`evaluate`]; a file that cannot be read or has changed.
pub fn evaluate_file(
    set: &CoefficientSet,
    (path, survey): (&Path, &Survey),
    options: &ReadOptions,
    against: Option<&CoefficientSet>,
    tau_s: f64,
    observer: impl FnMut(u64),
) -> Result<Evaluation, EvaluateError> {
    let log = KnownLog::new(path, &survey.head);
    let judged = judged_log(set, &survey.head, survey.rows, survey.findings.clone());
    evaluated(
        set,
        judged,
        log.interval_s,
        against,
        tau_s,
        |other, sums| {
            let sink = |part: Part| sums.push(&part);
            Ok(apply_to_file(set, other, &log, options, observer, sink)?)
        },
    )
}

/// Evaluates `set` on a log that `run` runs it over, along with the reference.
fn evaluated(
    set: &CoefficientSet,
    log: JudgedLog,
    interval_s: f64,
    against: Option<&CoefficientSet>,
    tau_s: f64,
    run: impl FnOnce(Option<&CoefficientSet>, &mut LogSums) -> Result<(), EvaluateError>,
) -> Result<Evaluation, EvaluateError> {
    let taus_s = taus_s(interval_s, tau_s)?;
    let reference = Reference::new(set, against);
    let compared = reference.set.as_deref();
    let mut sums = LogSums::new(set, compared, interval_s, (&taus_s, tau_s));
    run(compared, &mut sums)?;
    let gathered = sums.finish();
    let mut axes = Vec::new();
    for (number, channel) in set.channels.iter().enumerate() {
        for of_channel in 0..channel.axes.len() {
            let judged = Judged {
                gathered: &gathered,
                compared,
                interval_s,
                number: axes.len(),
                channel: (number, channel),
                of_channel,
            };
            axes.push(judged.evaluate(&taus_s, tau_s)?);
        }
    }
    Ok(Evaluation {
        log,
        tau_s,
        reference: reference.name,
        max_boundary_jump: max_boundary_jump(set),
        status_rows: gathered.status_rows,
        outside: gathered.outside,
        segments: set.channels.iter().map(|c| c.segments.clone()).collect(),
        axes,
    })
}

/// All averaging times, shortest first.
fn taus_s(interval_s: f64, tau_s: f64) -> Result<Vec<f64>, EvaluateError> {
    if !TAU_RANGE_S.contains(&tau_s) {
        return Err(EvaluateError::AveragingTime { tau_s });
    }
    if interval_s > tau_s * (1.0 + 1e-9) {
        return Err(EvaluateError::Interval { interval_s, tau_s });
    }
    let mut taus_s: Vec<f64> = TAUS_S.into_iter().chain([tau_s]).collect();
    taus_s.sort_by(f64::total_cmp);
    taus_s.dedup();
    Ok(taus_s)
}

/// What is said of a log of so many rows, which `log` need not hold.
fn judged_log(
    set: &CoefficientSet,
    log: &Log,
    rows: usize,
    mut findings: Vec<Finding>,
) -> JudgedLog {
    // Other axes of the log are no matter of the set.
    let is_other = |column: &str| {
        let mut axes = log.channels.iter().flat_map(|channel| &channel.axes);
        axes.any(|axis| axis.name == column) && !set.axes().any(|(_, axis)| axis.name == column)
    };
    findings.retain(|finding| !is_other(&finding.column));
    let mut inputs = set.provenance.inputs.iter();
    JudgedLog {
        file: log.file.clone(),
        sha256: log.sha256.clone(),
        rows,
        skipped: log.skipped_rows,
        role: if inputs.len() == 0 {
            Role::Unknown
        } else if inputs.any(|input| input.sha256 == log.sha256) {
            Role::Training
        } else {
            Role::Verification
        },
        findings,
        doubts: log.reading.doubts.clone(),
    }
}

fn max_boundary_jump(set: &CoefficientSet) -> Vec<f64> {
    let channels = set.channels.iter();
    channels
        .flat_map(|channel| {
            let axes = 0..channel.axes.len();
            axes.map(|axis| f64::from(channel.table.max_jump(axis)))
        })
        .collect()
}

/// One axis of a compensated log.
struct Judged<'a> {
    gathered: &'a Gathered,
    compared: Option<&'a CoefficientSet>,
    interval_s: f64,
    /// Its place among all axes.
    number: usize,
    /// Its channel, and the place of that.
    channel: (usize, &'a ChannelSet),
    /// Its place in the channel.
    of_channel: usize,
}

impl Judged<'_> {
    fn evaluate(&self, taus_s: &[f64], tau_s: f64) -> Result<AxisEvaluation, EvaluateError> {
        let (channel, of_channel) = (self.channel.1, self.of_channel);
        let axis = &channel.axes[of_channel];
        let means = |place: usize| {
            let of_tau = &self.gathered.axes[place];
            [&of_tau[2 * self.number], &of_tau[2 * self.number + 1]]
        };
        let asked = taus_s.iter().position(|&other| other == tau_s);
        let [raw, compensated] = means(asked.unwrap_or_default());
        if raw.means.len() < 2 {
            return Err(EvaluateError::Stretches {
                n: raw.means.len(),
                tau_s,
            });
        }
        let stability = |(place, &tau_s): (usize, &f64)| {
            let reference = self.reference(&axis.name, place);
            Stability::new(means(place), reference, self.interval_s, tau_s)
        };
        Ok(AxisEvaluation {
            axis: axis.name.clone(),
            unit: axis.unit,
            constant_alone: channel.table.is_constant(of_channel),
            n: raw.means.len(),
            sigma_raw: raw.sigma(),
            sigma_compensated: compensated.sigma(),
            improvement: 1.0 - compensated.sigma() / raw.sigma(),
            rmse_raw: raw.rmse(),
            rmse_compensated: compensated.rmse(),
            max_abs_compensated: compensated.max_abs(),
            max_abs_raw: raw.max_abs(),
            bias_stability: taus_s.iter().enumerate().map(stability).collect(),
            correlation_raw: self.correlation(raw),
            correlation_compensated: self.correlation(compensated),
            hysteresis: Measured::or(
                self.gathered.bins[self.channel.0].compare(of_channel),
                || "no bin of temperature was passed both ways for 30 s or more".to_owned(),
            ),
            allan: AllanOfAxis::new(&self.gathered.allan, self.number, axis.unit),
            boundaries: boundaries(channel, of_channel),
            coefficient_sigmas: axis.sigmas.clone(),
        })
    }

    /// Bias stability with the reference, if that has the axis.
    fn reference(&self, axis: &str, tau: usize) -> Option<f64> {
        let mut names = self.compared?.axes().map(|(_, axis)| &axis.name);
        let place = names.position(|name| name == axis)?;
        Some(self.gathered.compared[tau][place].sigma())
    }

    fn correlation(&self, means: &Means) -> Measured<Correlation> {
        let of_channel = &self.gathered.thermal[2 * self.channel.0..];
        let (temperatures, rates) = (&of_channel[0].means, &of_channel[1].means);
        let temperature = pearson(&means.means, temperatures);
        let both = temperature.zip(pearson(&means.means, rates));
        Measured::or(
            both.map(|(temperature, rate)| Correlation {
                temperature,
                rate,
                temperature_chance: chance(&means.means, temperatures),
                rate_chance: chance(&means.means, rates),
            }),
            || "the temperature, its rate or the axis does not move".to_owned(),
        )
    }
}

/// What happens between the segments of an axis of a channel, coldest first.
pub fn boundaries(channel: &ChannelSet, axis: usize) -> Vec<Boundary> {
    let jumps = channel.table.jumps(axis);
    let boundary = |mismatch: tempco_set::Mismatch| {
        let (t_min_c, t_max_c) = (mismatch.t_min_c, mismatch.t_max_c);
        // A boundary may have been moved to the nearest edge of a cell.
        let slack_c = channel.boundary_moved_c + 1e-3;
        let range_c = t_min_c - slack_c..=t_max_c + slack_c;
        let within = jumps
            .iter()
            .filter(|(temp_c, _)| range_c.contains(&f64::from(*temp_c)));
        Boundary {
            t_min_c,
            t_max_c,
            overlap_mismatch: mismatch.overlap_mismatch,
            jump: within.map(|&(_, jump)| f64::from(jump)).fold(0.0, f64::max),
        }
    };
    channel.mismatches(axis).into_iter().map(boundary).collect()
}

/// A set cannot be evaluated on a log.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EvaluateError {
    /// The log does not have what the set compensates.
    #[error(transparent)]
    Apply(#[from] ApplyError),
    /// The file cannot be read once more.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The averaging time cannot be used.
    #[error(
        "averaging time {tau_s} s: expected {} to {} s", TAU_RANGE_S.start(), TAU_RANGE_S.end()
    )]
    AveragingTime {
        /// Averaging time \[s\].
        tau_s: f64,
    },
    /// The rows are too far apart.
    #[error("rows are {interval_s} s apart: expected a --tau of that or more, not {tau_s} s")]
    Interval {
        /// Median time between rows \[s\].
        interval_s: f64,
        /// Averaging time \[s\].
        tau_s: f64,
    },
    /// The log is too short.
    #[error("{n} full stretches of {tau_s} s in the log: expected 2 or more, or a smaller --tau")]
    Stretches {
        /// Full stretches in the log.
        n: usize,
        /// Averaging time \[s\].
        tau_s: f64,
    },
}
