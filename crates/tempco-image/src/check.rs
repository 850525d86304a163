//! Block CRCs: one CRC-32P4 for every 4092 bytes of contents, all of them at the end, so that the
//! contents stay in one piece.

use crate::ImageError;

/// CRC-32P4 (AUTOSAR): polynomial 0xF4ACFB13, reflected, initial and final value all ones.
pub static CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_AUTOSAR);

/// Bytes that a CRC vouches for: the most for which it finds all errors of up to 5 bits.
pub const BLOCK_LEN: usize = 4092;

/// Bytes of an image with contents (all but the CRCs) of `contents_len` bytes. Saturating, as all
/// lengths are reckoned: no bytes are as many.
pub const fn total_len(contents_len: usize) -> usize {
    contents_len.saturating_add(4 * contents_len.div_ceil(BLOCK_LEN))
}

/// Bytes of the contents of an image of `total_len` bytes, unless no image is that long.
pub const fn contents_len(total: usize) -> Option<usize> {
    let contents = match total.checked_sub(4 * total.div_ceil(BLOCK_LEN + 4)) {
        Some(contents) => contents,
        None => return None,
    };
    if total_len(contents) == total {
        Some(contents)
    } else {
        None
    }
}

/// Contents and the CRCs behind them.
pub(crate) fn split(image: &[u8]) -> Option<(&[u8], &[u8])> {
    image.split_at_checked(contents_len(image.len())?)
}

/// Checks one block of a whole image.
pub(crate) fn check_block(image: &[u8], block: usize) -> Result<(), ImageError> {
    let check = || {
        let (contents, crcs) = split(image)?;
        let expected = crcs.as_chunks::<4>().0.get(block)?;
        let bytes = contents.chunks(BLOCK_LEN).nth(block)?;
        Some(CRC.checksum(bytes) == u32::from_le_bytes(*expected))
    };
    match check() {
        Some(true) => Ok(()),
        _ => Err(ImageError::Crc { block }),
    }
}

/// Writes the CRCs behind the contents.
pub(crate) fn seal(image: &mut [u8]) {
    let Some(at) = contents_len(image.len()) else {
        return;
    };
    if let Some((contents, crcs)) = image.split_at_mut_checked(at) {
        for (bytes, crc) in contents.chunks(BLOCK_LEN).zip(crcs.as_chunks_mut().0) {
            *crc = CRC.checksum(bytes).to_le_bytes();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_with_and_without_crcs_belong_together() {
        let mut possible = 0;
        for contents in 0..3 * BLOCK_LEN {
            assert_eq!(contents_len(total_len(contents)), Some(contents));
        }
        for total in 0..3 * (BLOCK_LEN + 4) {
            possible += usize::from(contents_len(total).is_some());
        }
        assert_eq!(possible, 3 * BLOCK_LEN);
    }

    /// The generator with its leading term; the bit of a power is the power.
    const GENERATOR: u64 = (1 << 32) | 0xf4ac_fb13;
    const WORD_BITS: usize = 8 * (BLOCK_LEN + 4);

    /// Remainders of the powers of x.
    fn syndromes() -> std::vec::Vec<u32> {
        let mut powers = std::vec![1_u64];
        for i in 1..=WORD_BITS {
            let power = powers[i - 1] << 1;
            powers.push(power ^ ((power >> 32) * GENERATOR));
        }
        powers.into_iter().map(|power| power as u32).collect()
    }

    /// By argument, of every code word of up to 32768 bits: 1, 3 and 5 wrong bits are found since
    /// the generator is a multiple of x + 1, all of whose multiples have an even number of terms;
    /// 2 since no power of x up to the length has remainder 1, so that no two bits have the same.
    #[test]
    fn odd_numbers_of_wrong_bits_and_pairs_are_found_in_every_block() {
        assert_eq!(GENERATOR.count_ones() % 2, 0);
        let distance = syndromes()[1..].iter().position(|&power| power == 1);
        assert_eq!(distance, None);
        assert_eq!(CRC.algorithm.poly, GENERATOR as u32);
    }

    /// 1 + x^a = x^b + x^c has no solution within a block; the first is at 32769 bits. Half a
    /// thousand million pairs: run with `--release -- --ignored`.
    #[test]
    #[ignore = "5 s in release"]
    fn four_wrong_bits_are_found_in_every_block() {
        let powers = syndromes();
        let mut seen = std::vec![0_u64; 1 << 26];
        let mut first = None;
        'search: for c in 2..=WORD_BITS {
            let sum = 1 ^ powers[c - 1];
            seen[(sum >> 6) as usize] |= 1 << (sum & 63);
            for b in 1..c - 1 {
                let sum = powers[b] ^ powers[c];
                if (seen[(sum >> 6) as usize] >> (sum & 63)) & 1 == 1 {
                    first = Some(c);
                    break 'search;
                }
            }
        }
        assert_eq!(first, Some(WORD_BITS), "the first is just beyond a block");
    }
}
