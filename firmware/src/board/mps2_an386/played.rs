//! What a gyro that is played has in common with another: limits, and where its samples go.

use tempco::Status;

use super::registers;
use crate::unit::devices::AtRest;

/// Up to five counts per sample of constant bias.
pub(super) const AT_REST: AtRest = AtRest {
    sigma: 10.0,
    max_bias: 10_000.0,
};
/// Logs of any gyro are replayed here.
pub(super) const MAX_TABLE_BIAS: f32 = 1e6;

/// The lamps of the board stand for the output. They show flags only, so the compiler is told that
/// the sample is used: else it would be computed after the output, or not at all.
pub(super) fn put<const C: usize, const A: usize>(
    compensated: &[[f32; A]; C],
    status: &[Status; C],
) {
    core::hint::black_box(compensated);
    let all = status.iter().fold(Status::OK, |all, status| all | *status);
    registers::put_lamps(all.bits().into());
}
