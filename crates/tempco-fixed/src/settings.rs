//! The settings of the thermal path in integers.

use tempco::Thermal;

use crate::FixedError;
use crate::format::{FRACTION_BITS, ONE, from_f32, round, round_u64};

/// Resolution of the timers, the f32 core's: 10 us.
pub(crate) const TICKS_PER_S: f32 = 1e5;

/// The least slew per update, the f32 core's \[degC\].
pub(crate) const LEAST_SLEW: i32 = from_f32(2e-5);

/// Beyond this much nothing changes: no two temperatures of a sensor are further apart \[degC\].
const FURTHEST_C: f64 = 1300.0;

/// [`tempco::ThermalSettings`] with what follows from them, in integers.
///
/// Temperatures and rates have [`FRACTION_BITS`](crate::FRACTION_BITS), times are in ticks of 10 us.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FixedThermal {
    pub(crate) sensor_min: i32,
    pub(crate) sensor_max: i32,
    pub(crate) gate: i32,
    pub(crate) rate_min: i32,
    pub(crate) rate_max: i32,
    pub(crate) reference: i32,
    pub(crate) hold_ticks: i32,
    pub(crate) heal_ticks: i32,
    pub(crate) settle_ticks: i32,
    pub(crate) restart_ticks: i32,
    /// Slew per tick \[2^-40 degC\].
    pub(crate) slew_per_tick: i32,
    /// After this many ticks the part can have got anywhere.
    pub(crate) anywhere_ticks: i32,
    /// Slew per microsecond \[2^-44 degC\].
    pub(crate) slew_per_us: u32,
    /// Time constants per microsecond \[2^-64\].
    pub(crate) taus_per_us: u64,
    /// Rate per degree of lag, `60 / tau` \[2^-22 / min\].
    pub(crate) gain: u32,
    /// Shift of the effective temperature per rate, `kappa tau` \[2^-23 min\].
    pub(crate) shift: i32,
    /// The least share of the estimator's memory that it divides by \[2^-31\].
    pub(crate) least_memory: i32,
    /// What it multiplies by at most \[2^-24\].
    pub(crate) most_correction: i32,
    /// The longest interval that does not restart the estimator \[us\].
    pub(crate) longest_us: u32,
    /// The same \[s\].
    pub(crate) longest_s: f32,
    /// The time constant \[s\].
    pub(crate) tau_s: f32,
    pub(crate) max_slew_c_per_min: f32,
}

/// As in the f32 core, to the tick.
const fn ticks(time_s: f32) -> i32 {
    (time_s * TICKS_PER_S + 0.5) as i32
}

const fn power(exponent: u32) -> f64 {
    (1_u64 << exponent) as f64
}

impl FixedThermal {
    /// Converts checked settings.
    ///
    /// # Errors
    /// [`FixedError::Rate`].
    pub const fn new(thermal: &Thermal) -> Result<Self, FixedError> {
        let s = thermal.settings();
        if s.rate_min_c_per_min < -2000.0 || s.rate_max_c_per_min > 2000.0 {
            return Err(FixedError::Rate);
        }
        // Rounded up: what the f32 core can just believe is believed.
        let slew_per_tick = (s.max_slew_c_per_min as f64 / 6e6 * power(40)) as i32 + 1;
        let anywhere = FURTHEST_C * power(40) / slew_per_tick as f64;
        // As in the f32 core; 1 saturates to a last place less.
        let least_memory = if s.tau_s > 60.0 {
            60.0 / s.tau_s as f64
        } else {
            1.0
        };
        Ok(Self {
            sensor_min: from_f32(s.sensor_min_c),
            sensor_max: from_f32(s.sensor_max_c),
            gate: from_f32(s.spike_gate_c),
            rate_min: from_f32(s.rate_min_c_per_min),
            rate_max: from_f32(s.rate_max_c_per_min),
            reference: from_f32(s.reference_c),
            hold_ticks: ticks(s.hold_s),
            heal_ticks: ticks(s.heal_s),
            settle_ticks: ticks(3.0 * s.tau_s),
            restart_ticks: ticks(0.5 * s.tau_s),
            slew_per_tick,
            anywhere_ticks: round(anywhere),
            slew_per_us: round_u64(s.max_slew_c_per_min as f64 / 6e7 * power(44)) as u32,
            taus_per_us: round_u64(1e-6 / s.tau_s as f64 * power(32) * power(32)),
            gain: round_u64(60.0 / s.tau_s as f64 * power(22)) as u32,
            shift: round(s.kappa as f64 * s.tau_s as f64 / 60.0 * power(23)),
            least_memory: round(least_memory * power(31)),
            most_correction: round(power(24) / least_memory),
            longest_us: round_u64(0.5e6 * s.tau_s as f64) as u32,
            longest_s: thermal.longest_interval_s(),
            tau_s: s.tau_s,
            max_slew_c_per_min: s.max_slew_c_per_min,
        })
    }

    /// The slew in a time \[degC\], at least the least and at most what an i32 holds.
    pub(crate) const fn slew(&self, dt_s: f64) -> i32 {
        let slew = round(self.max_slew_c_per_min as f64 / 60.0 * dt_s * ONE);
        if slew < LEAST_SLEW { LEAST_SLEW } else { slew }
    }
}

const _: () = assert!(FRACTION_BITS == 20, "the exponents above are for 20 bits");
