//! Bytes in, checked messages out: a state machine of bounded size.

use crate::LinkError;
use crate::frame::{MAX_FRAME, open};

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
    bytes: [u8; MAX_FRAME],
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
            bytes: [0; MAX_FRAME],
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
        if byte != 0 {
            match self.bytes.get_mut(self.len) {
                Some(place) => {
                    *place = byte;
                    self.len += 1;
                }
                None => self.is_long = true,
            }
            return None;
        }
        let len = core::mem::take(&mut self.len);
        let is_long = core::mem::take(&mut self.is_long);
        if len == 0 {
            return None;
        }
        let opened = if is_long {
            Err(LinkError::Long)
        } else {
            let stuffed = self.bytes.get_mut(..len).ok_or(LinkError::Long);
            stuffed.and_then(open)
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
