//! The core of [`tempco`] in integers, for processors without floating point.
//!
//! The model, the rules about what to believe, the status and the table are those of the f32 core:
//! a [`FixedTable`] is made from a [`tempco::Table`], by the compiler if it is a constant. On a
//! Cortex-M3 a step takes a sixth to an eighth of the instructions of the f32 core in software, and
//! the same number whatever the data. It is a crate of its own because an image uses the one or the other,
//! and because nothing in it needs the inner parts of the f32 core.
//!
//! # Formats
//!
//! | what | type | last place | range |
//! |------|------|-----------|-------|
//! | temperature, effective temperature | i32 | 2^-20 degC | sensor -273..1000 degC, `u` +-1024 degC |
//! | rate of temperature | i32 | 2^-20 degC/min | calibrated +-2000 degC/min |
//! | lag of the estimator and of slow parts | i64 | 2^-51 degC | +-2048 degC |
//! | filter factor `alpha`, memory of the estimator | u64 | 2^-64 | 0 to 1 |
//! | correction of the rate after power-on | i32 | 2^-24 | 1 to 100 |
//! | contact of a hysteresis term | i32 | 2^-20 degC | +-1024 degC |
//! | place in a cell `z` | i32 | 2^-31 | 0 to 1 |
//! | rate over its full scale `R` (a power of two) | i32 | 2^-31 | -1 to 1 |
//! | bias, gyro sample, `a0`, `2 a1`, `4 a2`, `2 R r0`, `4 R r1` of an axis | i32 | 2^exponent of its unit | bias +-2^30 places |
//! | bias on its ramp between two updates | i64 | 2^-32 places | |
//! | times | i32 | 10 us | 5.9 h |
//!
//! [`INVALID`] stands for a temperature or a gyro sample that is not there. The exponent is chosen
//! per axis as fine as the coefficients allow (about 2^-30 of the largest bias), or given with
//! [`FixedTable::with_exponents`]. With these formats every product of the evaluation is the upper
//! word of a multiplication of two i32, with no shift:
//!
//! ```text
//! B = a0 + ((2 a1 + (4 a2 . z)) . z) + ((2 R r0 + (4 R r1 . z)) . T'/R)     x . y = x y / 2
//! ```
//!
//! # Error
//!
//! [`FixedTable::error_bounds`] states, for each axis, how far a bias is from the model in exact
//! arithmetic at any real temperature and calibrated rate, `q` being the last place:
//!
//! ```text
//! rounded coefficients   q (1/2 + 1/4 + 1/8 + 1/4 + 1/8)                       = 1.25 q
//! upper words            q (1/2 + 1 + 1/2 + 1)                                 = 3 q
//! place, 2^-30 of a cell 2^-30 (|a1| + 2 |a2| + R |r1|) <= 2^-30 2.5 2^30 q    = 2.5 q
//! temperature            half a last place, twice over (table's edge and u), times the slope S
//! rate                   half a last place, times the slope by rate
//! ------------------------------------------------------------------------------------------
//! |error| <= 8 q + 2^-20 (2 S + |r0| + |r1|)
//! ```
//!
//! Each term of the thermal history adds `1.25 q + 2^-20 2 |gain|` to that: its rounded factor and
//! upper word, and what half a last place of the effective temperature, of the half width or limit
//! and of the lag make of `u - c` or `u - S`. Its gain is a factor of each axis for a figure whose
//! full scale is a power of two, as for the rate.
//!
//! `S` is the largest of `(|a1| + 2 |a2| + R |r1|)` per degC. For a bias of 1 the first part
//! is some 1e-8 and the second 1e-6 of the bias per degC: four orders below the noise of a
//! navigation grade gyro. At an edge between cells, either neighbour may be meant within 2e-6
//! degC of it. The rate is within 8e-5 of itself (the series of [`tempco::Interval`]) plus a
//! last place; `t` after the start also within `(dt / t)^2`, as in the f32 core. All limits lie where the f32 core has them to one last place per second since the
//! last good temperature, so readings at a limit may be judged differently by 1e-6 degC.
//!
//! Differences by design: an effective temperature beyond 1024 degC (which only a large shift
//! `kappa tau` can ask for) stays there, and `INVALID` and what does not fit saturate with
//! [`Status::RAW_INVALID`](tempco::Status::RAW_INVALID) where f32 has NaN and infinity.
//!
//! # Timing
//!
//! Executed instructions for three axes, by QEMU, the same for every input:
//!
//! | call | Cortex-M3 | Cortex-M0 |
//! |------|----------:|----------:|
//! | [`FixedCompensator::step`] | 553 | 1992 |
//! | [`FixedTwoRate::update`] | 569 | 2146 |
//! | [`FixedTwoRate::compensate`] | 129 | 315 |
//! | [`PulseCarry::compensate`] | 23 | 88 |
//!
//! There is no division and no loop in them. A Cortex-M0 multiplies to 64 bits by a library
//! function without branches; its 32-bit multiplication itself takes 1 or 32 cycles, as the chip
//! was made. [`FixedInterval::from_micros`] is shorter for an interval that is not valid.
//!
//! # Example
//!
//! ```
//! use tempco::{Status, Table, Terms, Thermal, ThermalSettings};
//! use tempco_fixed::{FixedCompensator, FixedInterval, FixedTable, INVALID, from_milli_c};
//!
//! // The table of the f32 core's example, in 2^-16 of the axis's unit.
//! const CELLS: [[Terms; 1]; 2] = [
//!     [Terms { a: [-0.4, 0.6, 0.0], r: [0.5, 0.0] }],
//!     [Terms { a: [0.2, 0.6, 0.0], r: [0.5, 0.0] }],
//! ];
//! const THERMAL: Thermal = match Thermal::new(ThermalSettings::DEFAULT) {
//!     Ok(thermal) => thermal,
//!     Err(error) => panic!("{}", error.message()),
//! };
//! static TABLE: Table<1> = match Table::new(THERMAL, -40.0, 80.0, &CELLS) {
//!     Ok(table) => table,
//!     Err(error) => panic!("{}", error.message()),
//! };
//! static FIXED: FixedTable<1, 2> = match FixedTable::with_exponents(&TABLE, [-16]) {
//!     Ok(table) => table,
//!     Err(error) => panic!("{}", error.message()),
//! };
//! static SECOND: FixedInterval = FixedInterval::new(FIXED.thermal(), 1.0);
//!
//! let mut unit = FixedCompensator::new(&FIXED);
//! unit.start(from_milli_c(25_000));
//! let out = unit.step(&SECOND, from_milli_c(25_000), [20_000]);
//! assert!((out.bias[0] - 65_536 / 4).abs() <= 8);
//! assert_eq!(out.compensated[0], 20_000 - out.bias[0]);
//!
//! let out = unit.step(&SECOND, INVALID, [20_000]);
//! assert!(out.status.contains(Status::TEMPERATURE_INVALID));
//! ```
#![no_std]
#![forbid(unsafe_code)]

mod compensator;
mod conditioner;
mod error;
mod estimator;
mod format;
mod history;
mod interval;
mod mask;
mod pulse;
mod settings;
mod table;
mod thermal;
mod two_rate;

#[cfg(test)]
extern crate std;

pub use compensator::{FixedCompensator, FixedOutput};
pub use error::FixedError;
pub use format::{FRACTION_BITS, INVALID, from_binary_c, from_f32, from_milli_c, to_f32};
pub use interval::FixedInterval;
pub use pulse::{PulseCarry, PulseCarryF32};
pub use settings::FixedThermal;
pub use table::{FixedTable, FixedTerms};
pub use thermal::{FixedPoint, FixedThermalState};
pub use two_rate::FixedTwoRate;
