//! A reader refuses a newer major version and passes over what a newer minor version adds.

mod common;

use common::{CELLS, CHANNEL_LEN, HEADER_LEN, example, reseal, spoilt};
use tempco_image::{AlignedBytes, Image, ImageError, total_len};

#[test]
fn another_major_version_is_refused_and_named() {
    for major in [0, 2, 0xffff] {
        let bytes = u16::to_le_bytes(major);
        let (image, _) = spoilt(8, &bytes);
        let error = Image::read(&image.0).unwrap_err();
        assert_eq!(error, ImageError::Format { major });
        let (image, _) = spoilt(20, &bytes);
        let error = Image::read(&image.0).unwrap_err();
        assert_eq!(error, ImageError::Model { major });
    }
}

/// Of a newer layout even the CRC may be another.
#[test]
fn a_newer_major_version_is_named_whatever_else_changed() {
    let (mut image, _) = example();
    image.0[8] = 2;
    let error = Image::read(&image.0).unwrap_err();
    assert_eq!(error, ImageError::Format { major: 2 });
}

/// An image as version 1.3 might write it: 8 bytes more of header, 4 more of each channel, a flag.
fn from_the_future() -> (AlignedBytes<512>, usize) {
    let (old, len) = example();
    let contents = [
        &old.0[..HEADER_LEN],
        b"newthing",
        &old.0[HEADER_LEN..HEADER_LEN + CHANNEL_LEN],
        b"more",
        &old.0[HEADER_LEN + CHANNEL_LEN..len - 4],
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
    ] {
        image.0[at..at + 2].copy_from_slice(&(value as u16).to_le_bytes());
    }
    image.0[28] |= 2;
    reseal(&mut image.0[..len]);
    (image, len)
}

#[test]
fn a_newer_minor_version_is_read() {
    let (bytes, len) = from_the_future();
    let image = Image::read(&bytes.0[..len]).unwrap();
    assert_eq!(image.format(), (1, 3));
    let table = image.table::<1, 0, 0>(0).unwrap();
    assert_eq!(table.cells().as_flattened(), CELLS);
    assert_eq!(table.t_max_c(), 75.0);

    let (bytes, _) = spoilt(22, &[9]);
    assert_eq!(Image::read(&bytes.0).unwrap().model(), (1, 9));
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
