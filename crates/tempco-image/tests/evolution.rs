//! A reader refuses a newer major version and passes over what a newer minor version adds.

mod common;

use common::{
    AXIS, AXIS_LEN, CELLS, CHANNEL_LEN, HEADER_LEN, SIGNED, channel, example, reseal, spoilt,
};
use tempco::Terms;
use tempco_image::{AlignedBytes, Axis, Image, ImageError, Unit, encode, total_len};

#[test]
fn another_major_version_is_refused_and_named() {
    for major in [0, 1, 3, 0xffff] {
        let bytes = u16::to_le_bytes(major);
        let (image, _) = spoilt(8, &bytes);
        let error = Image::read(&image.0).unwrap_err();
        assert_eq!(error, ImageError::Format { major });
        let (image, _) = spoilt(24, &bytes);
        let error = Image::read(&image.0).unwrap_err();
        assert_eq!(error, ImageError::Model { major });
    }
}

/// Of another layout even the CRC may be another. A table of an older one can be written again.
#[test]
fn another_major_version_is_named_whatever_else_changed() {
    let message = |major: u8| {
        let (mut image, _) = example();
        image.0[8] = major;
        let error = Image::read(&image.0).unwrap_err();
        let major = major.into();
        assert_eq!(error, ImageError::Format { major });
        error.to_string()
    };
    let again = "layout version 1, expected 2; write it again from coefficients.json";
    assert_eq!(message(1), again);
    assert_eq!(message(3), "layout version 3, expected 2");
}

/// Two axes that differ.
const AXES: [Axis; 2] = [
    AXIS,
    Axis {
        unit: Unit::Dps,
        play_gains: [0.75, 1.5],
        ..AXIS
    },
];

fn cells() -> [Terms; 4] {
    [CELLS[0], CELLS[0], CELLS[1], CELLS[1]]
}

/// An image as version 2.3 might write it: 8 bytes more of header, 4 more of each channel, 8 more
/// of each axis, a flag.
fn from_the_future() -> (AlignedBytes<512>, usize) {
    let mut old = AlignedBytes([0; 512]);
    let len = encode(&SIGNED, &[channel(&cells(), &AXES)], &mut old.0).unwrap();
    let first_at = HEADER_LEN + CHANNEL_LEN;
    let second_at = first_at + AXIS_LEN;
    let contents = [
        &old.0[..HEADER_LEN],
        b"newthing",
        &old.0[HEADER_LEN..first_at],
        b"more",
        &old.0[first_at..second_at],
        b"of first",
        &old.0[second_at..second_at + AXIS_LEN],
        b"of other",
        &old.0[second_at + AXIS_LEN..len - 4],
    ]
    .concat();
    let mut image = AlignedBytes([0; 512]);
    image.0[..contents.len()].copy_from_slice(&contents);
    let len = total_len(contents.len());
    for (at, value) in [
        (10, 3),
        (12, len),
        (16, HEADER_LEN + 8),
        (18, CHANNEL_LEN + 4),
        (20, AXIS_LEN + 8),
    ] {
        image.0[at..at + 2].copy_from_slice(&(value as u16).to_le_bytes());
    }
    image.0[32] |= 2;
    reseal(&mut image.0[..len]);
    (image, len)
}

#[test]
fn a_newer_minor_version_is_read() {
    let (bytes, len) = from_the_future();
    let image = Image::read(&bytes.0[..len]).unwrap();
    assert_eq!(image.format(), (2, 3));
    let table = image.table::<2>(0).unwrap();
    assert_eq!(table.cells().as_flattened(), cells());
    assert_eq!(table.t_max_c(), 75.0);
    assert_eq!(table.play_gains(), &[[0.5, 0.75], [-0.25, 1.5]]);
    assert_eq!(image.channel(0).unwrap().axes, Axis::array(&AXES));
    assert_eq!(image.info(), &SIGNED);

    let (bytes, _) = spoilt(26, &[9]);
    assert_eq!(Image::read(&bytes.0).unwrap().model(), (2, 9));
}

/// What a newer minor version adds is covered by the CRCs like the rest.
#[test]
fn additions_are_not_exempt_from_the_crc() {
    let (bytes, len) = from_the_future();
    for bit in 0..8 * len {
        let mut flipped = bytes;
        flipped.0[bit / 8] ^= 1 << (bit % 8);
        assert!(Image::read(&flipped.0[..len]).is_err(), "bit {bit}");
    }
}
