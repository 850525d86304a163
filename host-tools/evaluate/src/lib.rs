//! Figures of merit of a set on a log. None of them is a figure without its method and averaging
//! time; `docs/metrics.md` says for each what it means and what a bad value tells.
//!
//! | modules | what they do |
//! | --- | --- |
//! | `evaluation` | [`evaluate`], [`evaluate_file`]: all figures of all axes; [`boundaries`] between segments |
//! | `sums` | what the figures need of a log, gathered part by part |
//! | `means`, `stability` | means over an averaging time, and their spread |
//! | `reference` | what the compensation is compared with |
//! | `correlation`, `hysteresis` | what is left of temperature, and of its direction |
//! | `curve`, [`allan`] | Allan deviations of an axis, and how they are computed |
//! | `judge` | [`judge()`]: what follows for the set |
//! | `measured` | a figure, or why there is none |
//! | `text` | how figures are written |
#![forbid(unsafe_code)]

pub mod allan;
mod correlation;
mod curve;
mod evaluation;
mod hysteresis;
mod judge;
mod means;
mod measured;
mod reference;
mod stability;
mod sums;
mod text;

pub use correlation::Correlation;
pub use curve::{AllanCurves, AllanOfAxis};
pub use evaluation::{
    AxisEvaluation, Boundary, EvaluateError, Evaluation, JudgedLog, Outside, Role, TAU_RANGE_S,
    boundaries, evaluate, evaluate_file,
};
pub use hysteresis::Hysteresis;
pub use judge::{judge, sign_off};
pub use measured::Measured;
pub use stability::{Sigmas, Stability};
pub use text::{figure, percent, without_dust};
