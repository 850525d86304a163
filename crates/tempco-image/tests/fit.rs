//! Whether an image fits a board.

mod common;

use common::{AXIS, CELLS, INFO, THERMAL, channel};
use tempco::Terms;
use tempco_image::{AlignedBytes, Axis, Channel, Fit, Image, ImageError, Misfit, Unit, encode};

/// At zero place and rate: 0.25 + 0.5 + 0.125, rate 30 times 0.75, second lag 5 times 0.375; plays
/// of 2 and 8 degC with gains 0.5 and -0.25.
const MAX_BIAS: f32 = 0.875 + 22.5 + 1.875 + 1.0 + 2.0;

const FIT: Fit = Fit {
    unit: Unit::Dph,
    scale_factor_arcsec: 1.5,
    max_bias: MAX_BIAS,
};

fn found(axes: &[Axis], cells: &[Terms], fits: &[Fit]) -> Result<(), ImageError> {
    let info = tempco_image::Info {
        continuous: false,
        ..INFO
    };
    let mut bytes = AlignedBytes([0; 512]);
    encode(&info, &[channel(cells, axes)], &mut bytes.0).unwrap();
    let image = Image::read(&bytes.0).unwrap();
    image.validate().unwrap();
    image.expect_fit(fits)
}

fn one(axis: Axis, fit: Fit) -> Option<Misfit> {
    match found(&[axis], &CELLS, &[fit]) {
        Ok(()) => None,
        Err(ImageError::Unfit { axis: 0, why }) => Some(why),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn the_unit_must_be_that_of_the_board_and_a_rate() {
    use Unit::{Dph, Dps, G, Mps2, PulsesPerS, Radps};
    for of_image in [Dph, Dps, Radps, PulsesPerS, Mps2, G] {
        for of_board in [Dph, Dps, Radps, PulsesPerS, Mps2, G] {
            let axis = Axis {
                unit: of_image,
                ..AXIS
            };
            let fit = Fit {
                unit: of_board,
                ..FIT
            };
            let fits = of_image == of_board && !matches!(of_image, Mps2 | G);
            let expected = (!fits).then_some(Misfit::Unit);
            assert_eq!(one(axis, fit), expected, "{of_image:?} {of_board:?}");
        }
    }
}

#[test]
fn the_scale_factor_must_be_that_of_the_board_but_for_rounding() {
    let steps = |count: u32| f32::from_bits(1.5_f32.to_bits() + count);
    for (unit, scale_factor_arcsec, fits) in [
        (Unit::Dph, 1.5, true),
        (Unit::Dph, steps(6), true),
        (Unit::Dph, steps(7), false),
        (Unit::Dph, 1.5 - 1e-6, false),
        (Unit::Dps, 0.0, false),
        (Unit::Radps, 3.0, false),
        (Unit::PulsesPerS, 0.0, true),
        (Unit::PulsesPerS, 3.0, true),
    ] {
        let axis = Axis {
            unit,
            scale_factor_arcsec,
            ..AXIS
        };
        let expected = (!fits).then_some(Misfit::ScaleFactor);
        let fit = Fit { unit, ..FIT };
        assert_eq!(one(axis, fit), expected, "{unit:?} {scale_factor_arcsec}");
    }
    for scale_factor_arcsec in [0.0, f32::NAN, -1.5] {
        let fit = Fit {
            scale_factor_arcsec,
            ..FIT
        };
        assert_eq!(one(AXIS, fit), Some(Misfit::ScaleFactor));
    }
}

/// Every term counts, in any cell, and whatever its sign.
#[test]
fn the_bias_must_be_within_the_limit_of_the_board() {
    assert_eq!(channel(&CELLS, &[AXIS]).max_bias(0), MAX_BIAS);
    for (max_bias, fits) in [
        (MAX_BIAS, true),
        (MAX_BIAS.next_down(), false),
        (0.0, false),
        (f32::NAN, false),
        (f32::INFINITY, true),
    ] {
        let expected = (!fits).then_some(Misfit::Bias);
        assert_eq!(one(AXIS, Fit { max_bias, ..FIT }), expected, "{max_bias}");
    }
    for term in 0..Terms::COUNT {
        for more in [1.0, -1.0] {
            let mut cells = [Terms::new([], []); 4];
            let mut values = [0.0; Terms::COUNT];
            values[term] = more;
            cells[2] = Terms::from_array(values);
            let of = |axis| channel(&cells, &[AXIS, AXIS]).max_bias(axis) - 3.0;
            // The rate is 30 degC/min at most, the second lag 5 degC.
            let expected = [1.0, 1.0, 1.0, 30.0, 30.0, 5.0, 5.0][term];
            assert_eq!((of(0), of(1)), (expected, 0.0), "{term}");
        }
    }
    // The end that is further from zero is what counts.
    let cold = Channel {
        thermal: tempco::ThermalSettings {
            rate_min_c_per_min: -40.0,
            ..THERMAL
        },
        ..channel(&CELLS, &[AXIS])
    };
    assert_eq!(cold.max_bias(0), MAX_BIAS + 10.0 * 0.75);
}

#[test]
fn the_axis_that_does_not_fit_is_named() {
    let cells = [CELLS[0]; 4];
    let bad = Axis {
        unit: Unit::Dps,
        ..AXIS
    };
    let unfit = |axis| ImageError::Unfit {
        axis,
        why: Misfit::Unit,
    };
    assert_eq!(found(&[AXIS, bad], &cells, &[FIT; 2]), Err(unfit(1)));
    let words = unfit(1).to_string();
    assert_eq!(words, "axis 1: the unit does not fit the board");
    // Axes are counted over all channels.
    let channels = [channel(&CELLS, &[AXIS]), channel(&CELLS, &[bad])];
    let mut bytes = AlignedBytes([0; 1024]);
    encode(&INFO, &channels, &mut bytes.0).unwrap();
    let image = Image::read(&bytes.0).unwrap();
    assert_eq!(image.expect_fit(&[FIT; 2]), Err(unfit(1)));
    let dps = Fit {
        unit: Unit::Dps,
        ..FIT
    };
    assert_eq!(image.expect_fit(&[FIT, dps]), Ok(()));
    for count in [0, 1, 3] {
        let shape = found(&[AXIS; 2], &cells, &vec![FIT; count]);
        assert_eq!(shape, Err(ImageError::Shape), "{count}");
    }
}
