#![forbid(unsafe_code)]
//! A simulated gyro unit in a thermal chamber.
//!
//! A calibration run takes a night in a chamber. This crate makes such a run in a fraction of a
//! second, with the one thing a chamber cannot give: the true bias beside every sample.
//!
//! ```text
//! chamber programme -> air -> case (temperature sensor) -> cavity of each gyro -> bias
//!                                  |                                               |
//!                        sensor noise, code steps                 angle random walk, whole pulses
//!                                  v                                               v
//!                               temp_c                                    x, y, z pulses
//! ```
//!
//! The bias is a function of the *cavity* temperature, and the cavity lags the sensor by minutes.
//! The truth is therefore outside the family `B(T, T')` that a calibration fits to the sensor's
//! temperature, as it is on real units.
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
//! Earth rate, scale factor errors, bias instability, self-heating, hysteresis and faults.

mod bias;
mod chamber;
mod csv_out;
mod decimal;
mod error;
mod noise;
mod profiles;
mod simulation;
mod thermal;
mod unit;

pub use bias::{AxisBias, BlendedQuadratics, LegendreSeries, StaticCurve};
pub use chamber::{AIR_RANGE_C, MAX_DURATION_S, Profile, Step};
pub use csv_out::{LOG_HEADER, TRUTH_HEADER, write_log, write_log_and_truth};
pub use error::{ProfileError, SimulationError, UnknownName};
pub use noise::NoiseLevels;
pub use profiles::PROFILES;
pub use simulation::{DEFAULT_RATE_HZ, RATE_RANGE_HZ, Sample, Simulation, Truth};
pub use thermal::ThermalNetwork;
pub use unit::{AXIS_NAMES, UNITS, Unit};
