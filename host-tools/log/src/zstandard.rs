//! Unpacks Zstandard (RFC 8878).

use std::error::Error;
use std::io::{self, BufRead, Read};

use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};

/// The largest window in bytes, as of the command `zstd`: what is packed with a larger one takes
/// that much memory to unpack.
const MAX_WINDOW_BYTES: u64 = 1 << 27;

/// Frames, one behind another, as they are unpacked. The checksum of a frame is checked if it has
/// one.
pub(super) struct ZstdDecoder<R> {
    source: R,
    frame: FrameDecoder,
    within_frame: bool,
}

impl<R: BufRead> ZstdDecoder<R> {
    pub(super) fn new(source: R) -> Self {
        let mut frame = FrameDecoder::new();
        frame.set_max_window_size(MAX_WINDOW_BYTES);
        Self {
            source,
            frame,
            within_frame: false,
        }
    }

    pub(super) fn into_inner(self) -> R {
        self.source
    }

    /// Begins a frame, or passes over one that is to be skipped.
    fn begin(&mut self) -> io::Result<()> {
        use FrameDecoderError::ReadFrameHeaderError as Header;
        match self.frame.reset(&mut self.source) {
            Ok(()) => self.within_frame = true,
            Err(Header(ReadFrameHeaderError::SkipFrame { length, .. })) => {
                let mut skipped = (&mut self.source).take(length.into());
                if io::copy(&mut skipped, &mut io::sink())? < length.into() {
                    return Err(io::ErrorKind::UnexpectedEof.into());
                }
            }
            Err(cause) => return Err(of_source(cause)),
        }
        Ok(())
    }

    /// Ends a frame of which everything was taken.
    fn end(&mut self) -> io::Result<()> {
        self.within_frame = false;
        let stated = self.frame.get_checksum_from_data();
        if stated.is_some() && stated != self.frame.get_calculated_checksum() {
            return Err(io::Error::other("its checksum does not match"));
        }
        Ok(())
    }
}

impl<R: BufRead> Read for ZstdDecoder<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while !buffer.is_empty() {
            if !self.within_frame {
                if self.source.fill_buf()?.is_empty() {
                    break;
                }
                self.begin()?;
                continue;
            }
            while self.frame.can_collect() == 0 && !self.frame.is_finished() {
                let one = BlockDecodingStrategy::UptoBlocks(1);
                let decoded = self.frame.decode_blocks(&mut self.source, one);
                decoded.map_err(of_source)?;
            }
            match self.frame.read(buffer)? {
                0 => self.end()?,
                read => return Ok(read),
            }
        }
        Ok(0)
    }
}

/// The failure to read that is behind an error, or the error itself.
fn of_source(error: FrameDecoderError) -> io::Error {
    let mut cause: Option<&(dyn Error + 'static)> = Some(&error);
    while let Some(inner) = cause {
        if let Some(failed) = inner.downcast_ref::<io::Error>() {
            return match failed.raw_os_error() {
                Some(code) => io::Error::from_raw_os_error(code),
                None => io::Error::new(failed.kind(), failed.to_string()),
            };
        }
        cause = inner.source();
    }
    io::Error::other(error)
}

#[cfg(test)]
mod tests {
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};

    use super::*;

    fn unpacked(packed: &[u8]) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        ZstdDecoder::new(packed).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// A frame with a checksum.
    fn packed(bytes: &[u8]) -> Vec<u8> {
        compress_to_vec(bytes, CompressionLevel::Fastest)
    }

    /// Lines of digits, which repeat and do not.
    fn text() -> Vec<u8> {
        let line = |n: u64| format!("{n},{}\n", n.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40);
        (0..40_000).map(line).collect::<String>().into_bytes()
    }

    /// Frames of all levels of the library of zstd itself are read by the tests of the Python module.
    #[test]
    fn frames_are_unpacked_one_behind_another() {
        let text = text();
        let mut whole = Vec::new();
        let mut expected = Vec::new();
        for level in [CompressionLevel::Uncompressed, CompressionLevel::Fastest] {
            // A frame that is to be skipped, one without content, and one with it.
            whole.extend_from_slice(b"\x5a\x2a\x4d\x18\x03\0\0\0any");
            whole.extend(compress_to_vec(&b""[..], level));
            whole.extend(compress_to_vec(&text[..], level));
            expected.extend_from_slice(&text);
        }
        assert!(unpacked(&whole).unwrap() == expected);
        assert!(unpacked(b"").unwrap().is_empty());
    }

    #[test]
    fn what_is_cut_off_ends_too_early() {
        let text = text();
        let mut whole = b"\x5a\x2a\x4d\x18\x03\0\0\0any".to_vec();
        whole.extend(packed(&text[..3000]));
        for length in (1..whole.len()).filter(|&length| length != 11) {
            let error = unpacked(&whole[..length]).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::UnexpectedEof, "{length}");
        }
    }

    #[test]
    fn no_flipped_bit_of_a_frame_with_a_checksum_is_overlooked() {
        let text = &text()[..600];
        let mut whole = packed(text);
        for bit in 0..8 * whole.len() {
            whole[bit / 8] ^= 1 << (bit % 8);
            let same = unpacked(&whole).is_ok_and(|bytes| bytes != text);
            assert!(!same, "bit {bit}");
            whole[bit / 8] ^= 1 << (bit % 8);
        }
    }
}
