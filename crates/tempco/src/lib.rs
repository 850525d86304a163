//! Removes the thermal part of a gyroscope's bias, sample by sample, in fixed time.
//!
//! A gyro at rest should read zero. What it reads instead, its *bias*, moves with temperature
//! and with how fast the temperature changes. This crate evaluates a fitted model of that bias
//! next to the sampling loop and subtracts it: no heap, no panics, no `unsafe`, and only f32
//! `+ - *`, comparison and selection per sample, so that an x86 host and a Cortex-M compute the
//! same bits.
//!
//! Data flows one way through one small module each:
//!
//! ```text
//! temperature -> conditioner -> estimator, history -> thermal -> table -> bias --+-> compensator
//!                (accepted?)    (T', d2, plays)       (u, ...)                    |   raw - bias
//!                                                                                 |
//!                                                                                 +-> thermal half
//!                                                                                     ramp of the bias
//!                                                                                       |
//!     gyro samples, in the interrupt --------------------------------------------> corrector
//!                                                                                  raw - bias
//! ```
//!
//! With `T` the conditioned temperature \[degC\], `L` its first-order filtered value (before this
//! sample is taken in) and `L2` a slower one, the bias of one axis is
//!
//! ```text
//! T' = (T - L) / tau                          rate of temperature       [degC/min]
//!      / max(1 - exp(-t / tau), 60 s / tau)   t after power-on; 1 for tau up to 60 s
//! d2 = T - L2                                 second lag                [degC]
//! u  = T - kappa tau T' - kappa2 d2           lag-compensated temp.     [degC]
//! v  = T - play_kappa tau T' - play_kappa2 d2 what drags the plays      [degC]
//! z  = (u - t_min) / cell_width - k           place within cell k       [0, 1)
//! B  = a0 + a1 z + a2 z^2 + T' (r0 + r1 z)    bias                      [unit of the axis]
//!    + d2 (s0 + s1 z) + g1 (v - c1) + g2 (v - c2)
//! ```
//!
//! with contacts `c1`, `c2` that `v` drags along ([`Play`], [`Table::with_plays`]). Every table has
//! this one shape; what a model does not use has coefficients and gains of zero. The composite model
//! of Weng et al., *Sensors* 2020, 20(2), 377 has `kappa = 0`, no second lag and no plays.
//! Configuration ([`Table`]) is immutable and can live in flash; all state is in the
//! [`Compensator`], which takes a temperature and a gyro sample at once.
//!
//! # Two halves
//! Where the gyro is sampled faster than its temperature, the work is in two halves. A
//! [`ThermalHalf`] belongs into the main loop and turns each temperature into a [`BiasRamp`]. A
//! [`Corrector`] belongs into the sampling interrupt and takes the bias out along the ramp, of single
//! samples or of a FIFO's worth; a [`PulseCorrector`] does it for whole pulses. A [`RampBuffer`]
//! between them needs no lock. Several temperature sensors have [`ThermalChannels`], and a host
//! computes the same by a [`Stream`].
//!
//! # Example
//!
//! ```
//! use tempco::{Compensator, Interval, Status, Table, Terms, Thermal, ThermalSettings};
//!
//! // One axis, two cells over -40..80 degC: the bias rises by 0.01 per degC, and by 0.5 for
//! // each degC/min. A bad table stops the build, because this is evaluated at compile time.
//! const CELLS: [[Terms; 1]; 2] = [
//!     [Terms::new([-0.4, 0.6, 0.0], [0.5, 0.0])],
//!     [Terms::new([0.2, 0.6, 0.0], [0.5, 0.0])],
//! ];
//! const THERMAL: Thermal = match Thermal::new(ThermalSettings::DEFAULT) {
//!     Ok(thermal) => thermal,
//!     Err(error) => panic!("{}", error.message()),
//! };
//! static TABLE: Table<1> = match Table::new(THERMAL, -40.0, 80.0, &CELLS) {
//!     Ok(table) => table,
//!     Err(error) => panic!("{}", error.message()),
//! };
//! const SECOND: Interval = Interval::new(&THERMAL, 1.0);
//!
//! let mut unit = Compensator::new(&TABLE);
//! unit.start(25.0);
//! let out = unit.step(&SECOND, 25.0, [0.30]);
//! assert!((out.bias[0] - 0.25).abs() < 1e-6);
//! assert!((out.compensated[0] - 0.05).abs() < 1e-6);
//!
//! // A broken sensor: the last good temperature is held and the status says so.
//! let out = unit.step(&SECOND, f32::NAN, [0.30]);
//! assert!((out.bias[0] - 0.25).abs() < 1e-6);
//! assert!(out.status.contains(Status::TEMPERATURE_INVALID));
//! ```
#![no_std]
#![forbid(unsafe_code)]

mod channels;
mod compensator;
mod conditioner;
mod corrector;
mod error;
mod estimator;
mod history;
mod interval;
mod pulses;
mod ramp;
mod settings;
mod sign;
mod status;
mod table;
mod terms;
mod thermal;
mod thermal_half;

#[cfg(test)]
extern crate std;

pub use channels::{Schedule, Stream, ThermalChannels};
pub use compensator::{Compensator, Output};
pub use corrector::Corrector;
pub use error::TableError;
pub use history::{Play, SecondLag};
pub use interval::Interval;
pub use pulses::{PulseCorrector, PulseRamp};
pub use ramp::{BiasRamp, Number, Ramp, RampBuffer};
pub use settings::{PLAYS, Thermal, ThermalSettings};
pub use status::{Status, Validity};
pub use table::{MAX_AXES, MAX_CELLS, Place, Table};
pub use terms::Terms;
pub use thermal::{ThermalPoint, ThermalState};
pub use thermal_half::ThermalHalf;
