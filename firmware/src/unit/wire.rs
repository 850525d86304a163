//! Values of the unit as the link carries them.

use tempco::{Status, ThermalPoint};
use tempco_link::{Axes, ChannelTelemetry, Channels};

/// The state of each channel.
pub(super) fn channels<const C: usize>(
    points: &[ThermalPoint; C],
    status: &[Status; C],
) -> Channels<ChannelTelemetry> {
    let channels = points.iter().zip(status);
    channels
        .map(|(point, status)| ChannelTelemetry {
            effective_c: point.effective_c,
            rate_c_per_min: point.rate_c_per_min,
            status: status.bits(),
        })
        .collect()
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
