//! The bytes of a file as they pass, with a look ahead.

use std::io::{self, Read};

/// Bytes read at a time.
const READ_BYTES: usize = 1 << 18;

/// A place in a file that moves forwards.
pub(super) struct Window<R> {
    source: R,
    buffer: Vec<u8>,
    /// The place in the buffer.
    at: usize,
    /// The place in the file \[bytes\].
    offset: u64,
    is_ended: bool,
}

impl<R: Read> Window<R> {
    pub(super) fn new(source: R) -> Self {
        Self {
            source,
            buffer: Vec::new(),
            at: 0,
            offset: 0,
            is_ended: false,
        }
    }

    /// The place in the file \[bytes\].
    pub(super) fn offset(&self) -> u64 {
        self.offset
    }

    /// The next `count` bytes, or fewer at the end of the file.
    pub(super) fn peek(&mut self, count: usize) -> io::Result<&[u8]> {
        if self.buffer.len() - self.at < count && !self.is_ended {
            self.buffer.drain(..self.at);
            self.at = 0;
            let wanted = count.max(READ_BYTES) - self.buffer.len();
            let read = (&mut self.source).take(wanted as u64);
            self.is_ended = { read }.read_to_end(&mut self.buffer)? < wanted;
        }
        let end = self.buffer.len().min(self.at + count);
        Ok(&self.buffer[self.at..end])
    }

    /// Passes bytes that were looked at.
    pub(super) fn pass(&mut self, count: usize) {
        debug_assert!(self.at + count <= self.buffer.len());
        self.at += count;
        self.offset += count as u64;
    }

    /// Passes all that is left; returns how many bytes that was.
    pub(super) fn pass_all(&mut self) -> io::Result<u64> {
        let from = self.offset;
        loop {
            let left = self.peek(READ_BYTES)?.len();
            if left == 0 {
                return Ok(self.offset - from);
            }
            self.pass(left);
        }
    }

    pub(super) fn into_inner(self) -> R {
        self.source
    }
}
