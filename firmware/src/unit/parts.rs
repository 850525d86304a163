//! What a unit is put together from, besides the devices of its board.

use tempco::Schedule;
use tempco_image::{Image, Unit as AxisUnit};

use super::UnitTables;
use super::devices::Gyro;
use super::exchange::MainEnds;
use super::offsets::Offsets;
use super::storage::Storage;

/// All that is made at boot for the main loop.
pub struct Parts<'t, F, K, const C: usize, const A: usize> {
    /// Booted.
    pub storage: Storage<'t, F>,
    /// Tables in use and their CRC; none where the unit runs uncompensated.
    pub tables: Option<(&'t UnitTables<'t, C, A>, u32)>,
    /// Constant biases of re-zero.
    pub offsets: Offsets<C, A>,
    /// The main loop's side of the interrupt.
    pub ends: MainEnds<'t, C, A>,
    /// The interrupt's timer.
    pub clock: K,
    /// Rates of both.
    pub schedule: Schedule,
    /// Scale factor of the gyro \[arcsec/pulse\].
    pub scale_factor_arcsec: f32,
    /// Whether the stack keeps its distance from what lies below it.
    pub stack_is_sound: fn() -> bool,
    /// Whether the processor computes what it should: [`known_answer`](super::known_answer).
    pub knows_the_answer: fn() -> bool,
}

/// From counts per sample to the unit of each axis of an image, or to pulses per second without
/// one.
pub fn scale<G: Gyro<C, A>, const C: usize, const A: usize>(
    image: Option<&Image>,
    sample_rate_hz: f32,
) -> [[f32; A]; C] {
    let unit = |channel, axis| -> Option<AxisUnit> {
        let axes = image?.channel(channel).ok()?.axes;
        axes.get::<usize>(axis)?.map(|axis| axis.unit)
    };
    core::array::from_fn(|channel| {
        core::array::from_fn(|axis| {
            let per_pulse = match unit(channel, axis) {
                // One arc second per second is one degree per hour.
                Some(AxisUnit::Dph) => G::SCALE_FACTOR_ARCSEC,
                Some(AxisUnit::Dps) => G::SCALE_FACTOR_ARCSEC / 3600.0,
                Some(AxisUnit::Radps) => G::SCALE_FACTOR_ARCSEC * core::f32::consts::PI / 648_000.0,
                _ => 1.0,
            };
            G::PULSES_PER_COUNT * per_pulse * sample_rate_hz
        })
    })
}
