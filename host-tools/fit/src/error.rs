//! Why a fit was refused.

use tempco::TableError;
use tempco_evaluate::TAU_RANGE_S;
use tempco_set::run::ApplyError;
use tempco_set::{Segment, SegmentError};
use thiserror::Error;

/// A fit was refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FitError {
    /// No log was given.
    #[error("no log was given")]
    NoLogs,
    /// A log was summarised by another plan.
    #[error(
        "{file}: was summarised with another {option}: expected the same for all logs of a fit: \
         summarise it again"
    )]
    Plan {
        /// The log.
        file: String,
        /// The option that differs.
        option: &'static str,
    },
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
         of {tau_s} s: expected time in seconds; if it is, choose a longer one by --rate-tau"
    )]
    Interval {
        /// The log.
        file: String,
        /// Median time between rows \[s\].
        interval_s: f64,
        /// Time constant \[s\].
        tau_s: f32,
    },
    /// The averaging time of the statistics cannot be used.
    #[error(
        "averaging time {tau_s} s: expected {} to {} s", TAU_RANGE_S.start(), TAU_RANGE_S.end()
    )]
    AveragingTime {
        /// Averaging time \[s\].
        tau_s: f64,
    },
    /// A log of which every row is left out.
    #[error(
        "{file}: no row is left to fit: of {rows}, {excluded_rows} lie in excluded stretches, \
         {unusable_rows} have a temperature or interval that was not accepted, {outlying_rows} are \
         spikes or disturbed: expected rows to fit in every log"
    )]
    NoRows {
        /// The log.
        file: String,
        /// Its rows.
        rows: usize,
        /// Rows in excluded stretches.
        excluded_rows: usize,
        /// Rows whose temperature or interval was not accepted.
        unusable_rows: usize,
        /// All others.
        outlying_rows: usize,
    },
    /// No part of the logs can be left out, to be judged by a fit to the rest.
    #[error(
        "{files}: all rows lie within {block_s:.0} s, which cannot be divided to choose a model: \
         expected time in seconds, and a longer log"
    )]
    Short {
        /// The logs.
        files: String,
        /// Time within which rows are not divided \[s\].
        block_s: f64,
    },
    /// The temperature hardly moved.
    #[error(
        "{files}: the temperature `{temperature}` spans {span_c:.1} degC only: expected 10 degC or \
         more, or the bias of other temperatures would be invented"
    )]
    Span {
        /// The logs.
        files: String,
        /// Name of the temperature.
        temperature: String,
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
    /// The equations of all segments together cannot be solved.
    #[error(
        "the logs cannot separate the coefficients of a spline of {segments} segments: choose \
         fewer by --segments"
    )]
    Spline {
        /// Number of segments.
        segments: usize,
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
