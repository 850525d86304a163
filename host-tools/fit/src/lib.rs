//! Fits coefficient sets of gyro and accelerometer biases to thermal-chamber logs.
//!
//! ```text
//! log -> summary (the core) -> outliers -+-> segments ------------+-> set, with its statistics
//!                                        +-> spline --------------+
//! ```
//!
//! The regressors that the fit sees are computed by the `tempco` core itself, run over the log.
//!
//! | modules | what they do |
//! | --- | --- |
//! | `method`, `options`, `error` | what to fit, and how |
//! | `fit` | [`fit()`]: logs in, coefficient set out |
//! | [`summary`] | what a fit needs of a log, in one pass; one channel in all logs |
//! | `outliers` | what does not belong into a fit |
//! | [`least_squares`] | normal equations, QR factor, basis of a spline |
//! | `segments` | the fit of one segment after the other |
//! | `spline` | the spline model, and the choice among models |
//! | `channel_fit` | a fitted channel, whatever its model, on its way into the set |
//! | `statistics` | how the set does on the logs it was fitted to |
//! | [`batch`] | many units at once |
#![forbid(unsafe_code)]

pub mod batch;
mod channel_fit;
mod error;
mod extent;
mod fit;
pub mod least_squares;
mod method;
mod options;
mod outliers;
mod segments;
mod spline;
mod statistics;
pub mod summary;
#[cfg(test)]
mod testing;

pub use error::FitError;
pub use fit::{Fit, fit, fit_summaries};
pub use method::{LagSearch, Method, SegmentModel, SegmentOverlap};
pub use options::{FitOptions, Plan, PlanOptions};
