//! Damage of every kind is found: flips, truncations, blank flash, random corruption.

mod common;

use common::{Random, example, examples};
use tempco::Terms;
use tempco_image::{AlignedBytes, CRC, Image, ImageError, MAX_LEN, encode, encoded_len};

fn is_accepted(bytes: &[u8]) -> bool {
    Image::read(bytes).is_ok_and(|image| image.validate().is_ok())
}

#[test]
fn the_undamaged_image_is_accepted() {
    let [(bytes, len), (signed, more)] = examples();
    assert_eq!((len, more), (284, 284 + 8));
    assert!(is_accepted(&bytes.0[..len]) && is_accepted(&signed.0[..more]));
}

/// All 1- and 2-bit flips by reading; all 3-bit flips by reading a third of a flip pair at random.
#[test]
fn flipped_bits_are_found() {
    for (mut bytes, len) in examples() {
        let image = &mut bytes.0[..len];
        let flip = |image: &mut [u8], bit: usize| image[bit / 8] ^= 1 << (bit % 8);
        let mut random = Random(1);
        for first in 0..8 * len {
            flip(image, first);
            assert!(!is_accepted(image), "bit {first}");
            for second in 0..first {
                flip(image, second);
                assert!(!is_accepted(image), "bits {first} {second}");
                if second % 16 == 0 {
                    let third = random.below(8 * len);
                    if third != first && third != second {
                        flip(image, third);
                        assert!(!is_accepted(image), "bits {first} {second} {third}");
                        flip(image, third);
                    }
                }
                flip(image, second);
            }
            flip(image, first);
        }
        assert!(is_accepted(image));
    }
}

/// All 3-bit flips of the header, whose CRC is at a fixed place, and of the example as one code
/// word: what a flipped bit does to a CRC does not depend on the other bits, so three flips are
/// missed only if the effect of one is the sum of the other two.
#[test]
fn all_triples_of_flipped_bits_are_found() {
    for (bytes, len) in examples() {
        for word in [&bytes.0[..80], &bytes.0[..len]] {
            let effects: Vec<u32> = (0..8 * word.len())
                .map(|bit| {
                    let covered = word.len() - 4;
                    let mut flipped = word.to_vec();
                    flipped[bit / 8] ^= 1 << (bit % 8);
                    let of = |word: &[u8]| {
                        let stored = u32::from_le_bytes(word[covered..].try_into().unwrap());
                        CRC.checksum(&word[..covered]) ^ stored
                    };
                    of(&flipped) ^ of(word)
                })
                .collect();
            let set: std::collections::HashSet<u32> = effects.iter().copied().collect();
            assert_eq!(set.len(), effects.len(), "two flips cancel");
            assert!(!set.contains(&0));
            for (i, first) in effects.iter().enumerate() {
                for second in &effects[..i] {
                    assert!(!set.contains(&(first ^ second)));
                }
            }
        }
    }
}

/// The lengths in a damaged header are not followed, even if a CRC at the place they lead to were
/// right.
#[test]
fn damage_of_the_header_is_found_by_its_own_crc() {
    for (bit, (mut bytes, len)) in (8 * 12..8 * 80).flat_map(|bit| examples().map(|e| (bit, e))) {
        bytes.0[bit / 8] ^= 1 << (bit % 8);
        let crc = CRC.checksum(&bytes.0[..len - 4]);
        bytes.0[len - 4..len].copy_from_slice(&crc.to_le_bytes());
        assert_eq!(
            Image::read(&bytes.0).unwrap_err(),
            ImageError::Header,
            "{bit}"
        );
    }
}

#[test]
fn truncated_images_and_blank_flash_are_refused() {
    for (bytes, len) in examples() {
        for shorter in 0..len {
            assert!(!is_accepted(&bytes.0[..shorter]), "{shorter} bytes");
        }
        // The rest of the sector, whatever it holds, is not part of the image.
        assert!(is_accepted(&bytes.0));
        for fill in [0x00, 0xff] {
            let blank = AlignedBytes([fill; 4096]);
            for len in [0, 4, 79, 80, 284, 4096] {
                let error = Image::read(&blank.0[..len]).unwrap_err();
                let expected = if len < 80 {
                    ImageError::Short {
                        given: len,
                        needed: 80,
                    }
                } else {
                    ImageError::Magic
                };
                assert_eq!(error, expected);
            }
            // A write that broke off, or an erase that began.
            for from in 0..len {
                let mut torn = bytes;
                torn.0[from..].fill(fill);
                let same = torn.0[..len] == bytes.0[..len];
                assert_eq!(is_accepted(&torn.0), same, "{fill:x} from {from}");
            }
        }
    }
}

/// Overwrites a random stretch, or flips 4 to 67 random bits, `count` times each.
fn corrupt_at_random(count: u32) {
    for (bytes, len) in examples() {
        let mut random = Random(2);
        for _ in 0..count {
            let mut image = bytes;
            if random.next() & 1 == 0 {
                let from = random.below(len);
                let end = len.min(from + 1 + random.below(len));
                image.0[from..end].fill_with(|| random.next() as u8);
            } else {
                for _ in 0..4 + random.below(64) {
                    let bit = random.below(8 * len);
                    image.0[bit / 8] ^= 1 << (bit % 8);
                }
            }
            if image.0[..len] != bytes.0[..len] {
                assert!(!is_accepted(&image.0[..len]));
            }
        }
    }
}

#[test]
fn random_corruption_is_found() {
    corrupt_at_random(50_000);
}

#[test]
#[ignore = "ten million; 10 s in release"]
fn random_corruption_is_found_ten_million_times() {
    corrupt_at_random(5_000_000);
}

/// Both channels of three axes, more than one block: flips in every block and in every CRC.
#[test]
fn every_block_of_a_long_image_is_covered() {
    let cells = [Terms::new([0.5, 0.0, 0.0], [0.25, 0.0]); 3 * 128];
    let channel = common::channel(&cells, &[common::AXIS; 3]);
    let channels = [channel, channel];
    let mut bytes = AlignedBytes([0; MAX_LEN]);
    let len = encode(&common::INFO, &channels, &mut bytes.0).unwrap();
    assert_eq!(len, encoded_len(&common::INFO, &channels));
    assert_eq!(len, 80 + 2 * (116 + 3 * 28 + 3 * 128 * 28) + 6 * 4);
    let image = Image::read(&bytes.0).unwrap();
    assert_eq!((image.blocks(), image.channel(1)), (6, Ok(channel)));
    let [_, second] = image.tables::<2, 3>().unwrap();
    assert_eq!(second.cells().as_flattened(), cells);

    let mut random = Random(3);
    for first in (0..8 * len).step_by(61) {
        let mut flipped = bytes;
        let second = random.below(8 * len);
        for bit in [first, second] {
            flipped.0[bit / 8] ^= 1 << (bit % 8);
        }
        assert!(
            first == second || !is_accepted(&flipped.0),
            "{first} {second}"
        );
    }
}

#[test]
fn one_block_is_checked_at_a_time() {
    let (bytes, _) = example();
    let image = Image::read(&bytes.0).unwrap();
    assert_eq!(image.blocks(), 1);
    assert_eq!(image.check_block(0), Ok(()));
    assert_eq!(image.check_block(1), Err(ImageError::Crc { block: 1 }));
}

#[test]
fn cells_are_used_in_place_and_only_if_aligned() {
    let (bytes, len) = example();
    let table = Image::read(&bytes.0).unwrap().table::<1>(0).unwrap();
    let cells = table.cells().as_ptr() as usize;
    assert_eq!(cells, bytes.0.as_ptr() as usize + common::CELLS_AT);

    let mut shifted = AlignedBytes([0; 512]);
    for shift in 1..4 {
        shifted.0[shift..shift + len].copy_from_slice(&bytes.0[..len]);
        let error = Image::read(&shifted.0[shift..]).unwrap_err();
        assert_eq!(error, ImageError::Alignment);
    }
}
