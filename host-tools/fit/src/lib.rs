//! Fits coefficient sets of gyro and accelerometer biases to thermal-chamber logs.
//!
//! ```text
//! log -> digest (the core) -> screen -+-> solve (per segment) --+-> set, with its statistics
//!                                     +-> joint (one spline) ---+
//! ```
//!
//! The regressors that the fit sees are computed by the `tempco` core itself, run over the log.
//!
//! | modules | what they do |
//! | --- | --- |
//! | [`fit`](mod@fit) | logs in, coefficient set out |
//! | [`digest`] | what a fit needs of a log, in one pass |
//! | `regress`, `screen` | one channel in all logs; what does not belong into a fit |
//! | `solve`, [`rfactor`] | least squares, segment by segment |
//! | `joint` | the spline model, and the choice among models |
//! | `statistics` | how the set does on the logs it was fitted to |
//! | [`batch`] | many units at once |
#![forbid(unsafe_code)]

pub mod batch;
pub mod digest;
pub mod fit;
mod joint;
mod regress;
pub mod rfactor;
mod screen;
mod solve;
mod statistics;
#[cfg(test)]
mod testing;
