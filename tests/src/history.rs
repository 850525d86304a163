//! A set with terms of the thermal history, without the long logs that a fit needs to select them.

use tempco_set::{CoefficientSet, GainSet};

/// Gives a set of three axes two plays and a second lag. The second axis has no gain of the
/// second play.
///
/// # Panics
/// If the set is of other axes.
pub fn add_history(set: &mut CoefficientSet) {
    for channel in &mut set.channels {
        assert_eq!(channel.axes.len(), 3);
        let table = &mut channel.table;
        table.thermal.half_width1_c = 2.5;
        table.thermal.half_width2_c = 8.0;
        table.thermal.tau2_s = 900.0;
        table.thermal.lag2_min_c = -3.5;
        table.thermal.lag2_max_c = 4.25;
        table.play_gains = vec![[0.25, 0.01], [-0.5, 0.0], [0.125, 1e-9]];
        for (number, of_lag) in [-0.75_f32, 0.0625, 3.0].into_iter().enumerate() {
            for cell in &mut table.cells {
                cell[number].s[0] = of_lag;
            }
            let axis = &mut channel.axes[number];
            for polynomial in &mut axis.polynomials {
                polynomial.s[0] = of_lag.into();
            }
            for sigmas in &mut axis.sigmas {
                sigmas.s[0] = f64::from(of_lag.abs()) / 16.0;
            }
            let gains = table.play_gains[number].map(f64::from);
            let with_sigma = |gain: f64| GainSet {
                gain,
                sigma: gain.abs() / 16.0,
            };
            axis.gains = gains.map(with_sigma).to_vec();
        }
    }
    set.seal();
}
