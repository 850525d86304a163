#![forbid(unsafe_code)]
//! A simulated gyro unit in a thermal chamber.
//!
//! A calibration run takes a night in a chamber. This crate makes such a run in a fraction of a
//! second, with the one thing a chamber cannot give: the true bias of every sample.
//!
//! ```text
//! profile   -> air -> case -> block -> cavity of each gyro -> thermal bias + drift
//!                       |       |                                   |
//!                       +-------+-> sensor           motion, tones, angle noise
//!                                     |                             |
//!                   noise, steps, faults                 whole pulses or rate steps
//!                                     v                             v
//!                                  temp_c                x, y, z; rows may be lost
//! ```
//!
//! The bias is a function of the *cavity* temperature, and the cavity lags the sensor. The truth is
//! therefore outside the family `B(T, T')` that a calibration fits to the sensor's temperature, as
//! it is on real units. Units and profiles are TOML files, those with a name included; `docs/twin.md`
//! has the equations and every parameter.
//!
//! # Example
//!
//! ```
//! use tempco_twin::{DEFAULT_RATE_HZ, Profile, Simulation, Unit, write_log};
//!
//! let unit = Unit::named("paper")?;
//! let profile = Profile::named("short")?;
//! let run = Simulation::new(&unit, &profile, 1, DEFAULT_RATE_HZ)?;
//!
//! let mut log = Vec::new();
//! let rows = write_log(&mut log, run)?;
//! assert_eq!(rows, 90 * 60 * 2 + 1);
//! assert!(log.starts_with(b"time_s,temp_c,x_pulses,y_pulses,z_pulses\n0,"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Reproducibility
//!
//! A unit, a profile, a seed and a rate determine every byte of the log, on every machine: the
//! simulation uses only correctly rounded arithmetic, `libm` functions and a counter-based
//! generator with one stream per noise source.
//!
//! # Not simulated
//!
//! Errors of the scale factor and of alignment, lock-in, cross-coupling of heat between axes, and what
//! flows back from an inner part to an outer one.

mod air;
mod bias;
mod chamber;
mod check;
mod csv_out;
mod curve;
mod decimal;
mod draw;
mod draw_curve;
mod drift;
mod error;
mod events;
mod expm;
mod file;
mod gyro;
mod heat;
mod hysteresis;
mod legs;
mod normal;
mod output;
mod profiles;
mod propagator;
mod sensor;
mod simulation;
mod step;
mod thermal;
mod tone;
mod unit;
mod units;
mod wander;

pub use air::MAX_DURATION_S;
pub use chamber::{AIR_RANGE_C, Profile, ProfileParts};
pub use check::Invalid;
pub use csv_out::{log_header, truth_header, write_log, write_log_and_truth};
pub use curve::{BlendedQuadratics, LegendreSeries, StaticCurve};
pub use drift::Drift;
pub use error::{FileError, SimulationError, UnknownName};
pub use events::{AxisName, Fault, FaultKind, Flags, Motion, MotionKind};
pub use gyro::GyroNoise;
pub use hysteresis::{ModeSteps, Play};
pub use output::{Output, RateUnit};
pub use profiles::PROFILES;
pub use sensor::TemperatureReading;
pub use simulation::{DEFAULT_RATE_HZ, RATE_RANGE_HZ, Sample, Simulation, Truth};
pub use step::Step;
pub use thermal::{Part, ThermalNetwork};
pub use tone::Tone;
pub use unit::{AXIS_NAMES, Axis, Unit};
pub use units::UNITS;
pub use wander::Wander;
