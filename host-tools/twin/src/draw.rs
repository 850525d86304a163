//! Units drawn about another one: same kind, other numbers.

use crate::draw_curve;
use crate::error::UnknownName;
use crate::hysteresis::{ModeSteps, Play};
use crate::normal::{NormalSource, Stream};
use crate::thermal::ThermalNetwork;
use crate::unit::{Axis, Unit};

/// Factors of time constants, self-heating, half-widths and spacings of modes.
const SIZES: [f64; 2] = [0.6, 1.6];
/// Factors of sensitivities and gains.
const GAINS: [f64; 2] = [0.4, 2.0];

impl Unit {
    /// The unit of a name in [`UNITS`](crate::UNITS), [redrawn](Unit::redrawn).
    ///
    /// # Errors
    ///
    /// [`UnknownName`] lists the names.
    pub fn drawn(name: &str, unit_seed: u64) -> Result<Self, UnknownName> {
        Ok(Self::named(name)?.redrawn(unit_seed))
    }

    /// Another unit of the same kind, named after its seed. Every seed gives another one.
    ///
    /// - Time constants, self-heating, half-widths and spacings of modes are multiplied by 0.6 to 1.6.
    /// - Sensitivities, gains and steps are multiplied by 0.4 to 2, with a sign drawn for each axis.
    /// - Static curves are drawn with the same order, mean and rms size.
    ///
    /// The logarithms of factors are uniform. What is 0 stays 0, and so do noise, drift, tones and the
    /// reading of the temperature.
    #[must_use]
    pub fn redrawn(&self, unit_seed: u64) -> Self {
        let mut unit = self.clone();
        unit.name = format!("{}-{unit_seed}", self.name);
        let mut random = NormalSource::new(unit_seed, Stream::DrawnHeat);
        redraw_heat(&mut unit.thermal, &mut random);
        for (index, axis) in unit.axes.iter_mut().enumerate() {
            let mut random = NormalSource::new(unit_seed, Stream::DrawnAxis(index));
            redraw_axis(axis, &mut random);
        }
        unit
    }
}

fn size(random: &mut NormalSource) -> f64 {
    random.log_between(SIZES[0], SIZES[1])
}

fn gain(random: &mut NormalSource) -> f64 {
    random.log_between(GAINS[0], GAINS[1])
}

fn redraw_heat(heat: &mut ThermalNetwork, random: &mut NormalSource) {
    heat.case_time_constant_s *= size(random);
    heat.block_time_constant_s *= size(random);
    heat.sensor_time_constant_s *= size(random);
    heat.case_rise_c *= size(random);
    heat.block_rise_c *= size(random);
    for axis in 0..3 {
        heat.cavity_time_constant_s[axis] *= size(random);
        heat.cavity_rise_c[axis] *= size(random);
    }
}

fn redraw_axis(axis: &mut Axis, random: &mut NormalSource) {
    axis.static_curve = draw_curve::like(&axis.static_curve, random);
    axis.rate_sensitivity *= random.sign() * gain(random);
    axis.rate_sensitivity_slope_per_c *= random.sign() * gain(random);
    axis.gradient_sensitivity *= random.sign() * gain(random);
    // The plays of an axis have one sign in common.
    let sign = random.sign();
    for Play {
        half_width_c,
        gain: play_gain,
    } in &mut axis.play
    {
        *half_width_c *= size(random);
        *play_gain *= sign * gain(random);
    }
    if let Some(ModeSteps {
        spacing_c,
        overlap_c,
        step,
        slope_per_c,
    }) = &mut axis.modes
    {
        let factor = size(random);
        *spacing_c *= factor;
        *overlap_c *= factor;
        *step *= random.sign() * gain(random);
        *slope_per_c *= random.sign() * gain(random);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::UNITS;

    #[test]
    fn every_seed_gives_a_valid_unit_of_its_own() {
        for name in UNITS {
            let units: Vec<Unit> = (0..30)
                .map(|seed| Unit::drawn(name, seed).unwrap())
                .collect();
            for (seed, unit) in units.iter().enumerate() {
                unit.check().unwrap();
                assert_eq!(unit.name, format!("{name}-{seed}"));
                assert_eq!(*unit, Unit::drawn(name, seed as u64).unwrap());
                for other in &units[..seed] {
                    assert_ne!(unit.thermal, other.thermal);
                    for (axis, other) in unit.axes.iter().zip(&other.axes) {
                        assert_ne!(axis.static_curve, other.static_curve);
                        let some = axis.rate_sensitivity != 0.0;
                        assert!(!some || axis.rate_sensitivity != other.rate_sensitivity);
                    }
                }
            }
        }
        assert!(Unit::drawn("Paper", 1).is_err());
    }

    #[test]
    fn factors_fill_their_ranges_and_noise_stays() {
        let named = Unit::named("hysteretic").unwrap();
        let (mut sizes, mut gains, mut positive) = (Vec::new(), Vec::new(), 0);
        for seed in 0..300 {
            let unit = named.redrawn(seed);
            assert_eq!(unit.temperature, named.temperature);
            sizes.push(unit.thermal.block_time_constant_s / named.thermal.block_time_constant_s);
            sizes.push(unit.thermal.case_rise_c / named.thermal.case_rise_c);
            for (axis, named) in unit.axes.iter().zip(&named.axes) {
                assert_eq!((axis.drift, axis.noise), (named.drift, named.noise));
                sizes.push(axis.play[1].half_width_c / named.play[1].half_width_c);
                let signs = axis.play.iter().zip(&named.play).map(|(play, named)| {
                    gains.push((play.gain / named.gain).abs());
                    play.gain * named.gain > 0.0
                });
                let signs: Vec<bool> = signs.collect();
                assert!(signs.iter().all(|sign| *sign == signs[0]));
                positive += usize::from(axis.rate_sensitivity > 0.0);
            }
        }
        for (factors, [low, high]) in [(sizes, SIZES), (gains, GAINS)] {
            let least = factors.iter().copied().fold(f64::INFINITY, f64::min);
            let most = factors.iter().copied().fold(0.0, f64::max);
            assert!((low..1.03 * low).contains(&least), "{least}");
            assert!((0.97 * high..=high).contains(&most), "{most}");
        }
        assert!((400..500).contains(&positive), "{positive}");
    }

    #[test]
    fn a_drawn_unit_is_pinned() {
        // A change here changes every drawn unit.
        let unit = Unit::drawn("hysteretic", 7).unwrap();
        let axis = &unit.axes[1];
        let found = [
            unit.thermal.case_time_constant_s,
            axis.static_curve.value(30.0),
            axis.rate_sensitivity,
            axis.play[2].gain,
        ];
        let expected = [
            326.6258891863278,
            -0.04079565822001822,
            -0.0066059909502864615,
            7.121761991847703e-5,
        ];
        assert_eq!(found, expected);
    }
}
