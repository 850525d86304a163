//! Fits coefficient sets of gyro and accelerometer biases to thermal-chamber logs, applies them
//! and judges them.
//!
//! ```text
//! log -> digest (the core) -> screen -+-> solve (per segment) --+-> assemble -> set -> table.rs, JSON
//!                                     +-> joint (one spline) ---+               |
//! log ---------------------------------------------------> apply (the core) <---+--> metrics
//! ```
//!
//! Whatever flies is computed by the `tempco` core itself, run over the log: the regressors that
//! the fit sees and the biases that `apply` takes out.
#![forbid(unsafe_code)]

pub mod allan;
pub mod batch;
pub mod digest;
pub mod fit;
mod joint;
pub mod metrics;
mod regress;
pub mod rfactor;
mod screen;
mod solve;
mod statistics;
#[cfg(test)]
mod testing;
