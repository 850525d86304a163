//! Valid CRCs over bad contents: validation refuses them by name.

mod common;

use common::{
    AXIS, Bytes, CELLS, CELLS_AT, CHANNEL_LEN, HEADER_LEN, INFO, channel, example, spoilt,
};
use tempco::{TableError, Terms, ThermalSettings};
use tempco_image::{AlignedBytes, Axis, Channel, Image, ImageError, Info, encode};

fn refused((bytes, len): (Bytes, usize)) -> ImageError {
    let image = Image::read(&bytes.0[..len]).expect("integrity is not at fault");
    let error = image.table::<1>(0).unwrap_err();
    assert_eq!(image.validate().unwrap_err(), error);
    assert_eq!(image.tables::<1, 1>().unwrap_err(), error);
    error
}

fn setting(name: &'static str) -> ImageError {
    let error = TableError::Setting(name);
    ImageError::Table { channel: 0, error }
}

#[test]
fn thermal_settings_grid_and_limits_are_checked() {
    let grid = [
        "first_edge_c",
        "last_edge_c",
        "t_min_c",
        "t_max_c",
        "period_s",
    ];
    let names = ThermalSettings::NAMES.into_iter().chain(grid);
    for (number, name) in names.enumerate() {
        for bad in [f32::NAN, f32::INFINITY, -1e9] {
            let image = spoilt(HEADER_LEN + 4 * number, &bad.to_le_bytes());
            assert_eq!(refused(image), setting(name), "{bad}");
        }
    }
}

#[test]
fn reversed_limits_are_refused() {
    let reversed = |cold: usize, low: f32, high: f32| {
        let bytes = [low.to_le_bytes(), high.to_le_bytes()].concat();
        refused(spoilt(HEADER_LEN + 4 * cold, &bytes))
    };
    assert_eq!(reversed(0, 150.0, -60.0), setting("sensor_max_c"));
    assert_eq!(reversed(8, 30.0, -30.0), setting("rate_min_c_per_min"));
    assert_eq!(reversed(13, 5.0, -4.0), setting("lag2_min_c"));
    assert_eq!(reversed(23, 80.0, -40.0), setting("last_edge_c"));
    assert_eq!(reversed(25, 75.0, -35.0), setting("t_max_c"));
    assert_eq!(reversed(25, -41.0, 75.0), setting("t_min_c"));
}

#[test]
fn coefficients_are_checked() {
    for (cell, number) in [(0, 0), (0, 4), (1, 2), (1, 3), (0, 5), (1, 6)] {
        let at = CELLS_AT + size_of::<Terms>() * cell + 4 * number;
        for bad in [f32::NAN, f32::NEG_INFINITY, 2e20] {
            let error = TableError::Coefficient { cell, axis: 0 };
            assert_eq!(
                refused(spoilt(at, &bad.to_le_bytes())),
                ImageError::Table { channel: 0, error }
            );
        }
    }
}

#[test]
fn the_numbers_of_an_axis_are_checked() {
    let at = HEADER_LEN + CHANNEL_LEN + 4;
    let names = [
        "scale_factor_arcsec",
        "row_noise",
        "row_noise_interval_s",
        "rezero_limit",
    ];
    for (number, name) in names.into_iter().enumerate() {
        let axis = ImageError::Axis {
            channel: 0,
            axis: 0,
            name,
        };
        for bad in [f32::NAN, f32::INFINITY, -1e-9] {
            let image = spoilt(at + 4 * number, &bad.to_le_bytes());
            assert_eq!(refused(image), axis, "{bad}");
        }
    }
    for number in 4..6 {
        for bad in [f32::NAN, f32::INFINITY, -2e20] {
            let image = spoilt(at + 4 * number, &bad.to_le_bytes());
            assert_eq!(refused(image), setting("play_gains"), "{bad}");
        }
    }
}

/// Every axis has the gains of its own record.
#[test]
fn gains_of_plays_belong_to_their_axes() {
    let axes = [1.0, 2.0, 3.0].map(|gain| Axis {
        play_gains: [gain, -gain],
        ..AXIS
    });
    let cells = [CELLS[0]; 3];
    let mut bytes = AlignedBytes([0; 512]);
    encode(&INFO, &[channel(&cells, &axes)], &mut bytes.0).unwrap();
    let table = Image::read(&bytes.0).unwrap().table::<3>(0).unwrap();
    assert_eq!(table.play_gains(), &[[1.0, 2.0, 3.0], [-1.0, -2.0, -3.0]]);
    let thermal = table.thermal().settings();
    assert_eq!(*thermal, common::THERMAL);
}

/// A jump of 2^-16 of the bias, statically, at a rate or at a second lag; but one of rounding is none.
#[test]
fn jumps_are_refused_where_the_image_is_marked_as_continuous() {
    let second = CELLS_AT + size_of::<Terms>();
    let jump = ImageError::Jump {
        channel: 0,
        cell: 0,
        axis: 0,
    };
    for (at, value) in [(second, 0.25_f32), (second + 12, 0.5), (second + 20, 0.375)] {
        let far = value + 1.0 / 65_536.0;
        assert_eq!(refused(spoilt(at, &far.to_le_bytes())), jump);
        let (near, len) = spoilt(at, &value.next_up().to_le_bytes());
        assert!(Image::read(&near.0[..len]).unwrap().table::<1>(0).is_ok());
    }
    // Not marked: a table of the paper's kind, with jumps, is what its author wanted.
    let cells = [CELLS[0], CELLS[0]];
    let unmarked = Info {
        continuous: false,
        ..INFO
    };
    let mut bytes = AlignedBytes([0; 512]);
    encode(&unmarked, &[channel(&cells, &[AXIS])], &mut bytes.0).unwrap();
    assert!(Image::read(&bytes.0).unwrap().table::<1>(0).is_ok());
    encode(&INFO, &[channel(&cells, &[AXIS])], &mut bytes.0).unwrap();
    assert_eq!(refused((bytes, 512)), jump);
}

/// Where rate or second lag has one sense only, its limit there is enough for a jump.
#[test]
fn jumps_are_looked_for_at_every_limit() {
    let none = ThermalSettings {
        rate_min_c_per_min: 0.0,
        rate_max_c_per_min: 0.0,
        lag2_min_c: 0.0,
        lag2_max_c: 0.0,
        ..common::THERMAL
    };
    let mut hot = CELLS[1];
    hot.r[0] += 0.5;
    hot.s[0] += 0.5;
    let cells = [CELLS[0], hot];
    let jump = |thermal| {
        let channel = Channel {
            thermal,
            ..channel(&cells, &[AXIS])
        };
        channel.jump()
    };
    assert_eq!(jump(none), None);
    // `rate_min_c_per_min`, `rate_max_c_per_min`, `lag2_min_c`, `lag2_max_c`.
    for (number, limit) in [(8, -1.0), (9, 1.0), (13, -1.0), (14, 1.0)] {
        let mut settings = none.to_array();
        settings[number] = limit;
        assert_eq!(jump(ThermalSettings::from_array(settings)), Some((0, 0)));
    }
}

/// What does not agree within itself is refused before contents are looked at.
#[test]
fn inconsistent_fields_are_refused_on_reading() {
    let (cells, axis) = (HEADER_LEN + 112, HEADER_LEN + CHANNEL_LEN);
    for (at, with, name) in [
        (12, &283_u32.to_le_bytes()[..], "cells"),
        (12, &288_u32.to_le_bytes(), "total_len"),
        (12, &4097_u32.to_le_bytes(), "total_len"),
        (16, &84_u16.to_le_bytes(), "header_len"),
        (16, &76_u16.to_le_bytes(), "header_len"),
        (18, &120_u16.to_le_bytes(), "channel_len"),
        (18, &0_u16.to_le_bytes(), "channel_len"),
        (20, &32_u16.to_le_bytes(), "axis_len"),
        (20, &0_u16.to_le_bytes(), "axis_len"),
        (22, &1_u16.to_le_bytes(), "signature"),
        (28, &[0], "channels"),
        (28, &[7], "axes"),
        (29, &[0], "axes"),
        (29, &[7], "axes"),
        (30, &4_u16.to_le_bytes(), "total_len"),
        (32, &[2], "flags"),
        (44, &[0; 32], "serial"),
        (44, &[0xff], "serial"),
        (45, b"\n", "serial"),
        (cells, &0_u32.to_le_bytes(), "cells"),
        (cells, &3_u32.to_le_bytes(), "cells"),
        (cells, &1_u32.to_le_bytes(), "total_len"),
        (cells, &u32::MAX.to_le_bytes(), "cells"),
        (axis, &[0], "unit"),
        (axis, &[7], "unit"),
        (axis + 1, &[1], "unit"),
        (axis + 3, &[1], "unit"),
    ] {
        let (mut bytes, len) = example();
        bytes.0[at..at + with.len()].copy_from_slice(with);
        let total = u32::from_le_bytes(bytes.0[12..16].try_into().unwrap()) as usize;
        let whole = if tempco_image::contents_len(total).is_some() {
            total
        } else {
            len
        };
        let mut big = AlignedBytes([0; 8192]);
        big.0[..512].copy_from_slice(&bytes.0);
        common::reseal(&mut big.0[..whole]);
        let error = Image::read(&big.0).unwrap_err();
        assert_eq!(error, ImageError::Field(name), "{at}: {with:?}");
    }
}

/// Twice the channels in the same bytes.
#[test]
fn channels_must_fill_the_image() {
    let (bytes, len) = spoilt(28, &[2]);
    let error = Image::read(&bytes.0[..len]).unwrap_err();
    assert_eq!(error, ImageError::Field("cells"));
}

#[test]
fn another_shape_or_unit_is_refused() {
    let (bytes, _) = example();
    let image = Image::read(&bytes.0).unwrap();
    assert_eq!(image.table::<2>(0), Err(ImageError::Shape));
    assert_eq!(image.table::<1>(1), Err(ImageError::Shape));
    assert_eq!(image.tables::<2, 1>(), Err(ImageError::Shape));
    assert_eq!(image.expect_serial("SN7"), Ok(()));
    for other in ["SN", "SN71", "sn7", ""] {
        assert_eq!(image.expect_serial(other), Err(ImageError::Serial));
    }
}
