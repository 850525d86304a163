//! Text as UTF-8, in whichever encoding it was written.

use std::io::{self, Read};

use super::source::Text;

/// Bytes of UTF-16 decoded at a time.
const RAW_BYTES: usize = 1 << 16;

/// How the characters of a text are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Utf8,
    Utf16Le,
    Utf16Be,
}

impl Encoding {
    /// By the mark at the start, or by the zeros between the letters of a header.
    fn of(head: &[u8]) -> Self {
        match head {
            [0xff, 0xfe, ..] => Self::Utf16Le,
            [0xfe, 0xff, ..] => Self::Utf16Be,
            [1..=0xff, 0, 1..=0xff, 0] => Self::Utf16Le,
            [0, 1..=0xff, 0, 1..=0xff] => Self::Utf16Be,
            _ => Self::Utf8,
        }
    }
}

/// A text that is read as UTF-8.
pub(super) struct Utf8Text {
    text: Text,
    pub(super) encoding: Encoding,
    /// Bytes that were read and not yet handed out: as they stand, or decoded.
    ready: Vec<u8>,
    handed_out: usize,
    /// Bytes of UTF-16 whose character is not yet complete.
    rest: Vec<u8>,
}

impl Utf8Text {
    /// Looks at the first bytes.
    pub(super) fn new(mut text: Text) -> io::Result<Self> {
        let mut head = Vec::new();
        (&mut text).take(4).read_to_end(&mut head)?;
        let encoding = Encoding::of(&head);
        let (ready, rest) = match encoding {
            Encoding::Utf8 => (head, Vec::new()),
            _ => (Vec::new(), head),
        };
        Ok(Self {
            text,
            encoding,
            ready,
            handed_out: 0,
            rest,
        })
    }

    /// The text as it stands in the file.
    pub(super) fn into_inner(self) -> Text {
        self.text
    }

    /// Decodes some more; `ready` stays empty at the end of the text.
    fn decode(&mut self) -> io::Result<()> {
        let mut raw = std::mem::take(&mut self.rest);
        let read = (&mut self.text)
            .take(RAW_BYTES as u64)
            .read_to_end(&mut raw)?;
        let unit = |pair: &[u8]| match self.encoding {
            Encoding::Utf16Be => u16::from_be_bytes([pair[0], pair[1]]),
            _ => u16::from_le_bytes([pair[0], pair[1]]),
        };
        let mut whole = raw.len() & !1;
        let is_at_end = read == 0;
        // The first half of a pair waits for its second half.
        let is_half = whole >= 2 && (0xd800..0xdc00).contains(&unit(&raw[whole - 2..]));
        if is_half && !is_at_end {
            whole -= 2;
        }
        let mut text: String = char::decode_utf16(raw[..whole].chunks_exact(2).map(unit))
            .map(|unit| unit.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect();
        let rest = raw.split_off(whole);
        if is_at_end && !rest.is_empty() {
            text.push(char::REPLACEMENT_CHARACTER);
        } else {
            self.rest = rest;
        }
        self.ready = text.into_bytes();
        self.handed_out = 0;
        Ok(())
    }
}

impl Read for Utf8Text {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.handed_out == self.ready.len() {
            if self.encoding == Encoding::Utf8 {
                return self.text.read(buffer);
            }
            self.decode()?;
            // One byte of a character may have been all there was.
            if self.ready.is_empty() && !self.rest.is_empty() {
                self.decode()?;
            }
        }
        let ready = &self.ready[self.handed_out..];
        let length = ready.len().min(buffer.len());
        buffer[..length].copy_from_slice(&ready[..length]);
        self.handed_out += length;
        Ok(length)
    }
}
