//! Values of the unit as the link carries them.

use tempco_link::{Axes, ChannelTelemetry, Channels};
use tempco_replay::Outcome;

/// The state of each channel.
pub(super) fn channels<const C: usize, const A: usize>(
    outcome: &Outcome<C, A>,
) -> Channels<ChannelTelemetry> {
    let channels = outcome.channels.iter().map(|channel| ChannelTelemetry {
        effective_c: channel.effective_c,
        rate_c_per_min: channel.rate_c_per_min,
        status: channel.flags().bits(),
    });
    channels.collect()
}

/// Values of all axes, channel by channel.
pub(super) fn axes<const C: usize, const A: usize>(values: &[[f32; A]; C]) -> Axes {
    values.as_flattened().iter().copied().collect()
}

/// Values of all channels, if they are as many as the unit has.
pub(super) fn array<const C: usize>(values: &[f32]) -> Option<[f32; C]> {
    values.try_into().ok()
}

/// Values of all axes, if they are as many as the unit has.
pub(super) fn per_axis<const C: usize, const A: usize>(values: &[f32]) -> Option<[[f32; A]; C]> {
    let (channels, rest) = values.as_chunks::<A>();
    rest.is_empty().then(|| channels.try_into().ok()).flatten()
}
