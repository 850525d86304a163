//! The fit: logs in, coefficient set out.

use tempco::{TableError, ThermalSettings};
use thiserror::Error;

use crate::apply::ApplyError;
use crate::assemble::{self, Fitted};
use crate::log::Log;
use crate::model::Polynomial;
use crate::regress::{ChannelData, is_usable, with_every_rate};
use crate::segment::{Overlap, Segment, SegmentError, Segmentation};
use crate::set::{
    AxisSet, ChannelSet, CoefficientSet, CoefficientSigmas, Input, Model, Provenance, SegmentSet,
    Settings,
};
use crate::solve::{SegmentRows, TERMS};
use crate::statistics;

/// The whole log must span this much for a fit to mean anything \[degC\].
const LEAST_SPAN_C: f32 = 10.0;

/// A rounding bound beyond this share of the compensated bias stability is remarked on.
const LARGE_ROUNDING: f64 = 0.01;

/// What to fit.
#[derive(Clone, Debug)]
pub struct FitOptions {
    /// Serial number of the unit.
    pub serial: String,
    /// Form of the model.
    pub model: Model,
    /// What is applied where segments overlap.
    pub overlap: Overlap,
    /// The segments; without them the measured range is divided in the paper's manner.
    pub segments: Option<Segmentation>,
    /// Settings of the thermal path. The rate limits and the reference temperature are set by the
    /// fit.
    pub thermal: ThermalSettings,
    /// Angle per pulse that the logs were read with \[arcsec\].
    pub scale_factor_arcsec: Option<f64>,
    /// Averaging time of the statistics \[s\].
    pub tau_s: f64,
}

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
/// Logs that do not belong together, too little temperature span, segments without data.
pub fn fit(logs: &[Log], options: &FitOptions) -> Result<Fit, FitError> {
    let first = logs.first().ok_or(FitError::NoLogs)?;
    for log in logs {
        check_same_axes(first, log)?;
        check_interval(log, &options.thermal)?;
    }
    // While fitting, every rate counts.
    let open = with_every_rate(options.thermal).map_err(FitError::Settings)?;

    let mut remarks = Vec::new();
    let mut unusable_rows = vec![0; logs.len()];
    let mut channels = Vec::new();
    let data: Vec<ChannelData> = (0..first.channels.len())
        .map(|channel| ChannelData::new(logs, channel, &open))
        .collect();
    for data in &data {
        for (count, points) in unusable_rows.iter_mut().zip(&data.points) {
            *count += points.iter().filter(|point| !is_usable(point)).count();
        }
        channels.push(fit_channel(data, options, &mut remarks)?);
    }
    let mut set = assemble::set(
        options.serial.clone(),
        Provenance {
            tool: assemble::tool(),
            created: assemble::now(),
            inputs: logs
                .iter()
                .zip(unusable_rows)
                .map(|(log, unusable_rows)| input(log, unusable_rows))
                .collect(),
        },
        Settings {
            model: options.model,
            overlap: options.overlap,
            scale_factor_arcsec: options.scale_factor_arcsec,
        },
        channels,
    );
    statistics::note(&mut set, logs, &data, options.tau_s)?;
    remark_on_set(&set, &mut remarks);
    Ok(Fit { set, remarks })
}

fn fit_channel(
    data: &ChannelData,
    options: &FitOptions,
    remarks: &mut Vec<String>,
) -> Result<ChannelSet, FitError> {
    let (t_min_c, t_max_c) = data.range(|point| point.effective_c);
    let span_c = t_max_c - t_min_c;
    if span_c.is_nan() || span_c < LEAST_SPAN_C {
        return Err(FitError::Span { span_c });
    }
    let segmentation = match &options.segments {
        Some(segmentation) => segmentation.clone(),
        None => Segmentation::over(f64::from(t_min_c), f64::from(t_max_c))?,
    };
    let temperature = &data.logs[0].channels[data.channel].column;

    let ranges = segmentation.fit_ranges(options.overlap);
    let mut rows = vec![SegmentRows::new(data.axes()); ranges.len()];
    let mut outside = 0_usize;
    for (interval_s, point, raw) in data.timed_rows() {
        let temp_c = f64::from(point.effective_c);
        let raw: Vec<f64> = raw.collect();
        let mut taken = false;
        for ((segment, range), rows) in segmentation.segments().iter().zip(&ranges).zip(&mut rows) {
            if temp_c >= range.t_min_c && temp_c <= range.t_max_c {
                let z = (temp_c - segment.centre_c()) / segment.half_width_c();
                let rate = f64::from(point.rate_c_per_min);
                rows.push(interval_s, z, rate, raw.iter().copied());
                taken = true;
            }
        }
        outside += usize::from(!taken);
    }
    if outside > 0 {
        let (low, high) = segmentation.range_c();
        remarks.push(format!(
            "{outside} rows lie outside the segments ({low} to {high} degC); at run time the \
             temperature is clamped there"
        ));
    }

    let mut segments = Vec::new();
    let mut polynomials = vec![Vec::new(); data.axes()];
    let mut sigmas = vec![Vec::new(); data.axes()];
    for (segment, rows) in segmentation.segments().iter().zip(rows) {
        let fit = rows
            .fit(options.model.terms(), f64::from(options.thermal.tau_s))
            .map_err(|unfit| FitError::Segment {
                segment: *segment,
                reason: unfit.to_string(),
                t_min_c,
                t_max_c,
            })?;
        if fit.terms < options.model.terms() {
            remarks.push(format!(
                "segment {segment} degC ({temperature}): the data cannot tell {} apart from the \
                 other terms; dropped",
                TERMS[fit.terms..options.model.terms()].join(", ")
            ));
        }
        for (axis, coefficients) in polynomials.iter_mut().zip(&fit.solution.coefficients) {
            axis.push(Polynomial::new(segment, coefficients));
        }
        for (axis, found) in sigmas.iter_mut().zip(&fit.solution.sigmas) {
            axis.push(CoefficientSigmas::new(found));
        }
        segments.push(SegmentSet {
            t_min_c: segment.t_min_c,
            t_max_c: segment.t_max_c,
            terms: TERMS[..fit.terms]
                .iter()
                .map(|&term| term.to_owned())
                .collect(),
            rows: fit.rows,
            condition: fit.solution.condition,
            coverage: Some(fit.coverage),
        });
    }

    let (rate_min, rate_max) = data.range(|point| point.rate_c_per_min);
    let (low, high) = segmentation.range_c();
    let calibrated = (t_min_c.max(low as f32), t_max_c.min(high as f32));
    let reference_c = match calibrated {
        (low, high) if (low..=high).contains(&25.0) => 25.0,
        (low, high) => 0.5 * (low + high),
    };
    let thermal = ThermalSettings {
        rate_min_c_per_min: rate_min.min(0.0),
        rate_max_c_per_min: rate_max.max(0.0),
        reference_c,
        ..options.thermal
    };
    let axes = data.logs[0].channels[data.channel].axes.iter();
    let fitted = Fitted {
        temperature: temperature.clone(),
        segments,
        axes: axes
            .zip(polynomials)
            .zip(sigmas)
            .map(|((axis, polynomials), sigmas)| AxisSet {
                name: axis.name.clone(),
                unit: axis.unit,
                polynomials,
                sigmas,
                statistics: None,
            })
            .collect(),
    };
    Ok(assemble::channel(
        fitted,
        &segmentation,
        options.overlap,
        thermal,
        calibrated,
    ))
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

fn input(log: &Log, unusable_rows: usize) -> Input {
    Input {
        file: log.file.clone(),
        sha256: log.sha256.clone(),
        rows: log.rows(),
        skipped_rows: log.skipped_rows,
        unusable_rows,
        interval_s: log.interval_s,
        duration_s: log.time_s[log.rows() - 1] - log.time_s[0],
    }
}

fn check_same_axes(first: &Log, log: &Log) -> Result<(), FitError> {
    let describe = |log: &Log| {
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

fn check_interval(log: &Log, thermal: &ThermalSettings) -> Result<(), FitError> {
    if log.interval_s > 0.5 * f64::from(thermal.tau_s) {
        return Err(FitError::Interval {
            file: log.file.clone(),
            interval_s: log.interval_s,
            tau_s: thermal.tau_s,
        });
    }
    Ok(())
}

/// A fit was refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FitError {
    /// No log was given.
    #[error("no log was given")]
    NoLogs,
    /// The logs do not have the same axes in the same units.
    #[error("the logs do not belong together: {first}, but {other}")]
    Different {
        /// The first log and its columns.
        first: String,
        /// The log that differs and its columns.
        other: String,
    },
    /// The estimator cannot work at the log's interval.
    #[error(
        "{file}: rows are {interval_s} s apart, more than half the rate estimator's time constant \
         of {tau_s} s: choose a longer one by --rate-tau"
    )]
    Interval {
        /// The log.
        file: String,
        /// Median time between rows \[s\].
        interval_s: f64,
        /// Time constant \[s\].
        tau_s: f32,
    },
    /// The temperature hardly moved.
    #[error(
        "the temperature spans {span_c:.1} degC only: expected 10 degC or more, or the bias of \
         other temperatures would be invented"
    )]
    Span {
        /// Span of the usable rows \[degC\].
        span_c: f32,
    },
    /// A segment without enough data.
    #[error(
        "segment {segment} degC {reason}; the data spans {t_min_c:.1} to {t_max_c:.1} degC: \
         choose other segments by --segments"
    )]
    Segment {
        /// The segment.
        segment: Segment,
        /// What is wrong.
        reason: String,
        /// Lowest usable temperature \[degC\].
        t_min_c: f32,
        /// Highest usable temperature \[degC\].
        t_max_c: f32,
    },
    /// Segments that cannot be used.
    #[error(transparent)]
    Segments(#[from] SegmentError),
    /// Settings that the core refuses.
    #[error("{0}")]
    Settings(TableError),
    /// The finished set cannot be applied.
    #[error(transparent)]
    Apply(#[from] ApplyError),
}
