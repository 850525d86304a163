//! The CRC by which the biases and flags of all samples of a block are compared.

use tempco_image::CRC;

/// CRC-32P4 of the words of a block: for each sample, channel by channel, the status and then the
/// biases of its axes; 4 bytes each, low byte first.
pub struct BlockCrc(crc::Digest<'static, u32>);

impl Default for BlockCrc {
    fn default() -> Self {
        Self(CRC.digest())
    }
}

impl BlockCrc {
    /// Takes a channel of a sample: the bits of its `tempco::Status`, and its biases \[unit of the
    /// axis\].
    pub fn add(&mut self, status: u32, bias: &[f32]) {
        self.0.update(&status.to_le_bytes());
        for bias in bias {
            self.0.update(&bias.to_le_bytes());
        }
    }

    /// The CRC of what was taken.
    pub fn finish(self) -> u32 {
        self.0.finalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_that_of_the_words_in_order() {
        let mut crc = BlockCrc::default();
        crc.add(0x0102, &[1.0, -2.0]);
        crc.add(3, &[0.5]);
        let bytes = [
            2, 1, 0, 0, 0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0, 3, 0, 0, 0, 0, 0, 0, 0x3f,
        ];
        assert_eq!(crc.finish(), CRC.checksum(&bytes));
    }
}
