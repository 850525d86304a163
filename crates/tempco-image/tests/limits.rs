//! What an image cannot hold is neither written nor read.

mod common;

use common::{AXIS, CELLS, HEADER_LEN, INFO, SIGNED, channel, reseal};
use tempco::{MAX_AXES, Terms};
use tempco_image::{
    AlignedBytes, Axis, Channel, Image, ImageError, Info, MAX_CELLS_LEN, MAX_LEN,
    MAX_SIGNATURE_LEN, encode, encoded_len, max_cells, total_len,
};

type Room = AlignedBytes<{ MAX_LEN + 1024 }>;

fn room() -> Box<Room> {
    Box::new(AlignedBytes([0; MAX_LEN + 1024]))
}

/// A full signature.
const SIGNATURE: [u8; MAX_SIGNATURE_LEN] = [0xa5; MAX_SIGNATURE_LEN];

#[test]
fn what_an_image_cannot_hold_is_not_written() {
    let mut out = [0; 400];
    let good = channel(&CELLS, &[AXIS]);
    let long = "a serial number beyond 32 letters";
    for serial in ["", long, "SN\n7", "SN\0"] {
        let info = Info { serial, ..INFO };
        let error = encode(&info, &[good], &mut out).unwrap_err();
        assert_eq!(error, ImageError::Field("serial"));
    }
    let refuse = |channels: &[Channel], out: &mut [u8]| encode(&INFO, channels, out).unwrap_err();
    assert_eq!(refuse(&[], &mut out), ImageError::Shape);
    assert_eq!(refuse(&[channel(&CELLS, &[])], &mut out), ImageError::Shape);
    let three = channel(&CELLS, &[AXIS; 3]);
    assert_eq!(refuse(&[three], &mut out), ImageError::Field("cells"));
    assert_eq!(refuse(&[good, three], &mut out), ImageError::Shape);
    let mut with_gap = good;
    with_gap.axes[2] = Some(AXIS);
    assert_eq!(refuse(&[with_gap], &mut out), ImageError::Shape);
    let many = [CELLS[0]; 1025];
    let many = channel(&many, &[AXIS]);
    assert_eq!(refuse(&[many], &mut out), ImageError::Field("cells"));
    let short = ImageError::Short {
        given: 283,
        needed: 284,
    };
    assert_eq!(refuse(&[good], &mut out[..283]), short);
}

/// A length that is a multiple of 4 and at most 128, with a key, or neither.
#[test]
fn signatures_are_of_a_length_that_fits_and_have_a_key() {
    let good = channel(&CELLS, &[AXIS]);
    let long = [0; MAX_SIGNATURE_LEN + 4];
    for (key_id, signature) in [(1, &b""[..]), (0, b"four"), (1, b"three!!"), (1, &long)] {
        let info = Info {
            key_id,
            signature,
            ..INFO
        };
        let error = encode(&info, &[good], &mut room().0).unwrap_err();
        assert_eq!(error, ImageError::Field("signature"));

        // The same by hand: behind the only channel.
        let mut bytes = room();
        let len = encode(&INFO, &[good], &mut bytes.0).unwrap() - 4;
        bytes.0[len..len + signature.len()].copy_from_slice(signature);
        let total = total_len(len + signature.len());
        bytes.0[12..16].copy_from_slice(&(total as u32).to_le_bytes());
        bytes.0[22..24].copy_from_slice(&key_id.to_le_bytes());
        bytes.0[30..32].copy_from_slice(&(signature.len() as u16).to_le_bytes());
        reseal(&mut bytes.0[..total]);
        let error = Image::read(&bytes.0).unwrap_err();
        assert_eq!(error, ImageError::Field("signature"));
    }
}

/// The most that an image may have is written and read for any number of channels and axes.
#[test]
fn the_largest_images_fit() {
    assert_eq!([1, 2, 3, 4, 6].map(max_cells), [877, 438, 292, 219, 146]);
    let cells = [Terms::new([0.5], [0.25]); MAX_CELLS_LEN / size_of::<Terms>()];
    let info = Info {
        signature: &SIGNATURE,
        ..SIGNED
    };
    let mut longest = 0;
    for channels in 1..=MAX_AXES {
        for axes in 1..=MAX_AXES / channels {
            let count = max_cells(channels * axes);
            let channel = channel(&cells[..axes * count], &[AXIS; MAX_AXES][..axes]);
            let mut bytes = room();
            let len = encode(&info, &vec![channel; channels], &mut bytes.0).unwrap();
            longest = longest.max(len);
            let image = Image::read(&bytes.0).unwrap();
            assert_eq!(image.validate(), Ok(()));
            assert_eq!(image.info(), &info);
            assert_eq!(image.channel(channels - 1), Ok(channel));
        }
    }
    // A cell of six axes is 168 bytes: up to 167 are left over.
    assert!(longest <= MAX_LEN && longest + 168 > MAX_LEN, "{longest}");
}

/// One cell more than that, over all channels: one of two of them may have many, but not both.
#[test]
fn more_cells_than_an_image_has_room_for_are_refused() {
    let cells = [Terms::new([0.5], [0.25]); 879];
    let of = |count: usize, axes: &[Axis]| channel(&cells[..count], axes);
    for channels in [
        vec![of(878, &[AXIS])],
        vec![of(3 * 293, &[AXIS; 3])],
        vec![of(800, &[AXIS]), of(78, &[AXIS])],
    ] {
        let all: usize = channels.iter().map(|channel| channel.cells.len()).sum();
        let error = encode(&INFO, &channels, &mut room().0).unwrap_err();
        let cells_len = all * size_of::<Terms>();
        assert_eq!(error, ImageError::TooLarge { cells_len });
        assert_eq!(
            error.to_string(),
            format!(
                "the cells take {cells_len} bytes, but an image has room for 24576; fewer cells are needed"
            )
        );
    }
    let two = [of(800, &[AXIS]), of(77, &[AXIS])];
    assert!(encode(&INFO, &two, &mut room().0).is_ok());

    // Written by another program: one cell more behind the last.
    let mut bytes = room();
    let len = encode(&INFO, &[of(877, &[AXIS])], &mut bytes.0).unwrap();
    let contents = encoded_len(&INFO, &[of(877, &[AXIS])]) - 4 * len.div_ceil(4096);
    bytes.0[contents..contents + size_of::<Terms>()].fill(0);
    let total = total_len(contents + size_of::<Terms>());
    bytes.0[12..16].copy_from_slice(&(total as u32).to_le_bytes());
    bytes.0[HEADER_LEN + 112..HEADER_LEN + 116].copy_from_slice(&878_u32.to_le_bytes());
    reseal(&mut bytes.0[..total]);
    let cells_len = 878 * size_of::<Terms>();
    assert_eq!(
        Image::read(&bytes.0).unwrap_err(),
        ImageError::TooLarge { cells_len }
    );
}
