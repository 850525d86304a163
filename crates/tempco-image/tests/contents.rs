//! Valid CRCs over bad contents: validation refuses them by name.

mod common;

use common::{
    Bytes, CELLS, CHANNEL_LEN, HEADER_LEN, INFO, PLAYS, SLOW_PART, channel, example,
    example_with_history, spoil, spoilt,
};
use tempco::{TableError, Terms};
use tempco_image::{AlignedBytes, Channel, ChannelHistory, Image, ImageError, Info, Unit, encode};

fn refused((bytes, len): (Bytes, usize)) -> ImageError {
    let image = Image::read(&bytes.0[..len]).expect("integrity is not at fault");
    let error = image.table::<1, 2, 1>(0).unwrap_err();
    assert_eq!(image.validate().unwrap_err(), error);
    assert_eq!(image.tables::<1, 1, 2, 1>().unwrap_err(), error);
    error
}

fn setting(name: &'static str) -> ImageError {
    let error = TableError::Setting(name);
    ImageError::Table { channel: 0, error }
}

#[test]
fn thermal_settings_grid_and_limits_are_checked() {
    let names = [
        "sensor_min_c",
        "sensor_max_c",
        "spike_gate_c",
        "max_slew_c_per_min",
        "hold_s",
        "heal_s",
        "tau_s",
        "kappa",
        "rate_min_c_per_min",
        "rate_max_c_per_min",
        "reference_c",
        "first_edge_c",
        "last_edge_c",
        "t_min_c",
        "t_max_c",
    ];
    for (number, name) in names.into_iter().enumerate() {
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
    assert_eq!(reversed(11, 80.0, -40.0), setting("last_edge_c"));
    assert_eq!(reversed(13, 75.0, -35.0), setting("t_max_c"));
    assert_eq!(reversed(13, -41.0, 75.0), setting("t_min_c"));
}

#[test]
fn coefficients_are_checked() {
    for (cell, number) in [(0, 0), (0, 4), (1, 2), (1, 3)] {
        let at = HEADER_LEN + CHANNEL_LEN + size_of::<Terms>() * cell + 4 * number;
        for bad in [f32::NAN, f32::NEG_INFINITY, 2e20] {
            let error = TableError::Coefficient { cell, axis: 0 };
            assert_eq!(
                refused(spoilt(at, &bad.to_le_bytes())),
                ImageError::Table { channel: 0, error }
            );
        }
    }
}

/// Two plays of half width and gain, a second lag of time constant, limit and gain.
#[test]
fn history_terms_are_checked() {
    let (width, gain) = (&[f32::NAN, -0.001, 1001.0][..], &[f32::NAN, 2e20][..]);
    let tau = &[f32::NAN, 59.9, 60_001.0][..];
    for (number, name, bad) in [
        (0, "half_width_c", width),
        (1, "gain of a play", gain),
        (2, "half_width_c", width),
        (3, "gain of a play", gain),
        (4, "tau_s of a second thermal lag", tau),
        (5, "limit_c", width),
        (6, "gain of a second thermal lag", gain),
    ] {
        let at = HEADER_LEN + CHANNEL_LEN + 4 * number;
        for bad in bad {
            let image = spoil(example_with_history(), at, &bad.to_le_bytes());
            assert_eq!(refused(image), setting(name), "{bad}");
        }
    }
}

/// A jump of 2^-16 of the bias, statically or at a rate; but one of rounding is none.
#[test]
fn jumps_are_refused_where_the_image_is_marked_as_continuous() {
    let second = HEADER_LEN + CHANNEL_LEN + 20;
    let jump = ImageError::Jump {
        channel: 0,
        cell: 0,
        axis: 0,
    };
    for (at, value) in [(second, 0.25_f32), (second + 12, 0.5)] {
        let far = value + 1.0 / 65_536.0;
        assert_eq!(refused(spoilt(at, &far.to_le_bytes())), jump);
        let (near, len) = spoilt(at, &value.next_up().to_le_bytes());
        assert!(
            Image::read(&near.0[..len])
                .unwrap()
                .table::<1, 0, 0>(0)
                .is_ok()
        );
    }
    // Not marked: a table of the paper's kind, with jumps, is what its author wanted.
    let cells = [CELLS[0], CELLS[0]];
    let unmarked = Info {
        continuous: false,
        ..INFO
    };
    let mut bytes = AlignedBytes([0; 512]);
    encode(&unmarked, &[channel(&cells, &[Unit::Dph])], &mut bytes.0).unwrap();
    assert!(Image::read(&bytes.0).unwrap().table::<1, 0, 0>(0).is_ok());
    encode(&INFO, &[channel(&cells, &[Unit::Dph])], &mut bytes.0).unwrap();
    assert_eq!(refused((bytes, 512)), jump);
}

/// What does not agree within itself is refused before contents are looked at.
#[test]
fn inconsistent_fields_are_refused_on_reading() {
    let channel = HEADER_LEN;
    for (at, with, name) in [
        (12, &187_u32.to_le_bytes()[..], "cells"),
        (12, &192_u32.to_le_bytes(), "total_len"),
        (12, &4097_u32.to_le_bytes(), "total_len"),
        (16, &76_u16.to_le_bytes(), "header_len"),
        (16, &68_u16.to_le_bytes(), "header_len"),
        (18, &80_u16.to_le_bytes(), "channel_len"),
        (18, &0_u16.to_le_bytes(), "channel_len"),
        (24, &[0], "channels"),
        (24, &[7], "axes"),
        (25, &[0], "axes"),
        (25, &[7], "axes"),
        (26, &[3], "plays"),
        (27, &[2], "slow_parts"),
        (28, &[2], "flags"),
        (36, &[0; 32], "serial"),
        (36, &[0xff], "serial"),
        (37, b"\n", "serial"),
        (channel + 60, &0_u32.to_le_bytes(), "cells"),
        (channel + 60, &3_u32.to_le_bytes(), "cells"),
        (channel + 60, &1_u32.to_le_bytes(), "total_len"),
        (channel + 60, &u32::MAX.to_le_bytes(), "cells"),
        (channel + 64, &[0], "units"),
        (channel + 64, &[7], "units"),
        (channel + 65, &[1], "units"),
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
    let (bytes, len) = spoilt(24, &[2]);
    let error = Image::read(&bytes.0[..len]).unwrap_err();
    assert_eq!(error, ImageError::Field("cells"));
}

#[test]
fn another_shape_or_unit_is_refused() {
    let (bytes, _) = example();
    let image = Image::read(&bytes.0).unwrap();
    assert_eq!(image.table::<2, 0, 0>(0), Err(ImageError::Shape));
    assert_eq!(image.table::<1, 0, 0>(1), Err(ImageError::Shape));
    assert_eq!(image.tables::<2, 1, 0, 0>(), Err(ImageError::Shape));
    assert_eq!(image.expect_serial("SN7"), Ok(()));
    for other in ["SN", "SN71", "sn7", ""] {
        assert_eq!(image.expect_serial(other), Err(ImageError::Serial));
    }
}

#[test]
fn what_an_image_cannot_hold_is_not_written() {
    let mut out = [0; 400];
    let good = channel(&CELLS, &[Unit::Dph]);
    let long = "a serial number beyond 32 letters";
    for serial in ["", long, "SN\n7", "SN\0"] {
        let info = Info { serial, ..INFO };
        let error = encode(&info, &[good], &mut out).unwrap_err();
        assert_eq!(error, ImageError::Field("serial"));
    }
    let refuse = |channels: &[Channel], out: &mut [u8]| encode(&INFO, channels, out).unwrap_err();
    assert_eq!(refuse(&[], &mut out), ImageError::Shape);
    assert_eq!(refuse(&[channel(&CELLS, &[])], &mut out), ImageError::Shape);
    let three = channel(&CELLS, &[Unit::G; 3]);
    assert_eq!(refuse(&[three], &mut out), ImageError::Field("cells"));
    assert_eq!(refuse(&[good, three], &mut out), ImageError::Shape);
    let many = [Terms::clone(&CELLS[0]); 1025];
    let many = channel(&many, &[Unit::Dph]);
    assert_eq!(refuse(&[many], &mut out), ImageError::Field("cells"));
    let with_play = Channel {
        history: ChannelHistory::new(&PLAYS[..1], &[]).unwrap(),
        ..good
    };
    assert_eq!(refuse(&[good, with_play], &mut out), ImageError::Shape);
    for (plays, slow_parts, name) in [(3, 0, "plays"), (0, 2, "slow_parts")] {
        let (plays, slow_parts) = (vec![PLAYS[0]; plays], vec![SLOW_PART; slow_parts]);
        let error = ChannelHistory::new(&plays, &slow_parts).unwrap_err();
        assert_eq!(error, ImageError::Field(name));
    }
    let short = ImageError::Short {
        given: 187,
        needed: 188,
    };
    assert_eq!(refuse(&[good], &mut out[..187]), short);
}
