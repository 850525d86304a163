//! Bytes in, checked messages out: a state machine of bounded size.

use cobs::{DecodeResult, DecoderState};

use crate::LinkError;
use crate::frame::{MAX_MESSAGE, open};

/// Frames that were taken and dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// With a right CRC.
    pub good: u32,
    /// Too long.
    pub long: u32,
    /// Cut, not stuffed, or with a wrong CRC.
    pub damaged: u32,
}

/// Finds frames in a stream of bytes.
pub struct Decoder {
    stuffing: DecoderState,
    /// What was unstuffed of the present frame.
    plain: [u8; MAX_MESSAGE + 4],
    len: usize,
    /// More bytes came than a frame can have; they are dropped up to the next zero.
    is_long: bool,
    counters: Counters,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder that has not seen a byte.
    pub const fn new() -> Self {
        Self {
            stuffing: DecoderState::Idle,
            plain: [0; MAX_MESSAGE + 4],
            len: 0,
            is_long: false,
            counters: Counters {
                good: 0,
                long: 0,
                damaged: 0,
            },
        }
    }

    /// Takes a byte; returns the postcard encoding of a [`Frame`](crate::Frame) whose CRC is right
    /// once its last byte came. What is no frame is counted and dropped.
    pub fn push(&mut self, byte: u8) -> Option<&[u8]> {
        let opened = match self.stuffing.feed(byte) {
            Ok(DecodeResult::NoData) => return None,
            Ok(DecodeResult::DataStart) => {
                (self.len, self.is_long) = (0, false);
                return None;
            }
            Ok(DecodeResult::DataContinue(byte)) => {
                match self.plain.get_mut(self.len) {
                    Some(place) => {
                        *place = byte;
                        self.len = self.len.saturating_add(1);
                    }
                    None => self.is_long = true,
                }
                return None;
            }
            Ok(DecodeResult::DataComplete) if !self.is_long => {
                let plain = self.plain.get(..self.len).ok_or(LinkError::Long);
                plain.and_then(open)
            }
            _ if self.is_long => Err(LinkError::Long),
            _ => Err(LinkError::Framing),
        };
        let counter = match opened {
            Ok(_) => &mut self.counters.good,
            Err(LinkError::Long) => &mut self.counters.long,
            Err(_) => &mut self.counters.damaged,
        };
        *counter = counter.wrapping_add(1);
        opened.ok()
    }

    /// Frames so far (each wraps at 2^32).
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }
}
