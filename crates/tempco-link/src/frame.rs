//! Frames: a message with its numbers, encoded, checked and stuffed.

use core::fmt;

use cobs::CobsEncoder;
use serde::{Deserialize, Serialize};
use tempco_image::CRC;

/// The most bytes of an encoded message with its numbers; a test holds the longest ones to it.
pub const MAX_MESSAGE: usize = 1088;
/// The most bytes of a frame on the wire.
pub const MAX_FRAME: usize = cobs::max_encoding_length(MAX_MESSAGE + 4) + 2;

/// A message with its numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Frame<M> {
    /// Number of the session, given by the unit; 0 for a hello and its answer.
    pub session: u32,
    /// Number of the request in the session, from 1 on (0 is left out when it wraps); 0 for what
    /// was not asked for.
    pub sequence: u16,
    /// The message.
    pub message: M,
}

/// Why a frame was not made or not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum LinkError {
    /// More than [`MAX_FRAME`] bytes.
    Long,
    /// The bytes are not stuffed by COBS, or too few.
    Framing,
    /// The CRC does not belong to the message.
    Crc,
    /// The CRC is right, but the message is none that this version knows.
    Message,
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Long => "the frame is too long",
            Self::Framing => "the frame is cut or not stuffed",
            Self::Crc => "the CRC of the frame is wrong",
            Self::Message => "the message is not one that this version knows",
        })
    }
}

impl core::error::Error for LinkError {}

impl<M: Serialize> Frame<M> {
    /// Writes the frame as it goes over the wire, zeros included, and returns its length.
    ///
    /// # Errors
    /// [`LinkError::Long`].
    pub fn encode(&self, wire: &mut [u8; MAX_FRAME]) -> Result<usize, LinkError> {
        let mut plain = [0; MAX_MESSAGE + 4];
        let (message, _) = plain.split_at_mut(MAX_MESSAGE);
        let len = postcard::to_slice(self, message)
            .map_err(|_| LinkError::Long)?
            .len();
        let (message, rest) = plain.split_at_mut_checked(len).ok_or(LinkError::Long)?;
        let crc = rest.first_chunk_mut().ok_or(LinkError::Long)?;
        *crc = CRC.checksum(message).to_le_bytes();
        let plain = plain.get(..len + 4).ok_or(LinkError::Long)?;
        // Not by `try_encode_including_sentinels`, which indexes.
        let (first, stuffed) = wire.split_first_mut().ok_or(LinkError::Long)?;
        *first = 0;
        let mut encoder = CobsEncoder::new(stuffed);
        encoder.push(plain).map_err(|_| LinkError::Long)?;
        let len = encoder.finalize();
        *stuffed.get_mut(len).ok_or(LinkError::Long)? = 0;
        Ok(len + 2)
    }
}

/// The message in unstuffed bytes, with its numbers.
pub(crate) fn open(plain: &[u8]) -> Result<&[u8], LinkError> {
    let (message, crc) = plain.split_last_chunk().ok_or(LinkError::Framing)?;
    // The CRC of nothing is zero, so that a row of zeros would be a frame.
    if message.is_empty() {
        return Err(LinkError::Framing);
    }
    if CRC.checksum(message) == u32::from_le_bytes(*crc) {
        Ok(message)
    } else {
        Err(LinkError::Crc)
    }
}

/// The numbers of a frame whose message may not be known.
#[derive(Deserialize)]
pub(crate) struct Numbers {
    pub(crate) session: u32,
    pub(crate) sequence: u16,
}

/// Reads a whole message and nothing behind it.
pub(crate) fn read<'de, T: Deserialize<'de>>(plain: &'de [u8]) -> Result<T, LinkError> {
    match postcard::take_from_bytes(plain) {
        Ok((value, [])) => Ok(value),
        _ => Err(LinkError::Message),
    }
}

/// Reads the numbers alone.
pub(crate) fn read_numbers(plain: &[u8]) -> Option<Numbers> {
    let (numbers, _) = postcard::take_from_bytes(plain).ok()?;
    Some(numbers)
}
