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
pub mod apply;
mod assemble;
pub mod batch;
mod core_run;
pub mod digest;
pub mod escape;
pub mod files;
pub mod fit;
mod import;
mod joint;
mod load;
pub mod metrics;
pub mod model;
mod regress;
pub mod rerun;
pub mod rfactor;
mod rounding;
mod screen;
pub mod segment;
pub mod set;
mod solve;
mod statistics;
mod tabulate;
#[cfg(test)]
mod testing;

pub use core_run::thermal_points;
pub use load::{SetError, check_folder, load_set, read_set};
pub use rounding::RoundingBound;
