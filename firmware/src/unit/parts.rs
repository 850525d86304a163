//! What a unit is put together from, besides the devices of its board.

use tempco::Schedule;

use super::exchange::MainEnds;
use super::in_use::{InUse, Room};
use super::offsets::Offsets;
use super::storage::Storage;

/// All that is made at boot for the main loop.
pub struct Parts<'t, F, K, const C: usize, const A: usize> {
    /// Booted.
    pub storage: Storage<'t, F>,
    /// The tables in use; none where the unit runs uncompensated.
    pub in_use: Option<InUse<'t, C, A>>,
    /// Where they are loaded again, should they be damaged.
    pub room: Room<'t, C, A>,
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
