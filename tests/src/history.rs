//! A set with terms of the thermal history, without the long logs that a fit needs to select them.

use tempco_set::{CoefficientSet, GainSet, PlayData, SlowPartData};

/// Gives a set of three axes two plays and a second lag. The second axis has no gain of the
/// second play.
///
/// # Panics
/// If the set is of other axes.
pub fn add_history(set: &mut CoefficientSet) {
    for channel in &mut set.channels {
        assert_eq!(channel.axes.len(), 3);
        let play = |half_width_c, gain: [f32; 3]| PlayData {
            half_width_c,
            gain: gain.to_vec(),
        };
        channel.table.plays = vec![play(2.5, [0.25, -0.5, 0.125]), play(8.0, [0.01, 0.0, 1e-9])];
        channel.table.slow_parts = vec![SlowPartData {
            tau_s: 900.0,
            limit_c: 4.25,
            gain: vec![-0.75, 0.0625, 3.0],
        }];
        let plays = channel.table.plays.iter().map(|play| &play.gain);
        let slow_parts = channel.table.slow_parts.iter().map(|part| &part.gain);
        let gains: Vec<&Vec<f32>> = plays.chain(slow_parts).collect();
        for (number, axis) in channel.axes.iter_mut().enumerate() {
            let of_axis = gains.iter().map(|gain| f64::from(gain[number]));
            axis.gains = of_axis
                .map(|gain| GainSet {
                    gain,
                    sigma: gain.abs() / 16.0,
                })
                .collect();
        }
    }
    set.table_crc32 = format!("{:08x}", set.crc32());
}
