//! The start of a text: its encoding, separator and header, before rows are read.

use std::io::{self, Chain, Cursor, Read};

use super::blocks::{BlockError, LONGEST_ROW};
use super::dialect::{Header, find_header};
use super::encoding::Utf8Text;
use super::source::Text;

/// Bytes in which a header is looked for first; more where there is none.
const FIRST_BYTES: usize = 1 << 16;

/// What follows a header.
pub(super) type Body = Chain<Cursor<Vec<u8>>, Utf8Text>;

/// Why a text has no header.
pub(super) enum HeadError {
    Read(BlockError),
    /// There are only blanks.
    Empty,
    /// It could be divided in two ways.
    Doubtful(String),
}

impl From<io::Error> for HeadError {
    fn from(cause: io::Error) -> Self {
        Self::Read(cause.into())
    }
}

/// Reads up to the end of the header; returns it, and the text that follows.
pub(super) fn read_head(text: Text) -> Result<(Header, Body), HeadError> {
    let mut text = Utf8Text::new(text)?;
    let (mut head, mut size) = (Vec::new(), FIRST_BYTES);
    loop {
        let wanted = size - head.len();
        let read = (&mut text).take(wanted as u64).read_to_end(&mut head)?;
        if head.starts_with(b"\xef\xbb\xbf") {
            head.drain(..3);
        }
        let is_at_end = read < wanted;
        if is_at_end && head.iter().all(u8::is_ascii_whitespace) {
            return Err(HeadError::Empty);
        }
        // A row may be too long to be read, but then the header before it is known.
        let is_all = is_at_end || head.len() > LONGEST_ROW;
        if let Some(header) = find_header(&head, is_at_end, is_all).map_err(HeadError::Doubtful)? {
            let rows = head.split_off(header.length);
            return Ok((header, Cursor::new(rows).chain(text)));
        }
        if is_all {
            return Err(HeadError::Read(BlockError::Endless { line: 1 }));
        }
        size *= 2;
    }
}
