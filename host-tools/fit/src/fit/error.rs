//! Why a fit was refused.

use tempco::TableError;
use thiserror::Error;

use crate::apply::ApplyError;
use crate::segment::{Segment, SegmentError};

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
    /// The equations of all segments together cannot be solved.
    #[error(
        "the logs cannot tell the coefficients of {segments} joined segments apart: choose fewer \
         by --segments"
    )]
    Joint {
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
