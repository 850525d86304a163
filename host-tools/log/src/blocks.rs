//! Cuts a stream of text into blocks of whole rows, in memory that does not grow with the stream.

use std::io::{self, Read};

use memchr::{memchr, memchr_iter, memrchr};
use thiserror::Error;

use super::records::{Records, lines};

/// A row longer than this is no row of numbers.
pub(super) const LONGEST_ROW: usize = 16 << 20;

/// Why there is no next block.
#[derive(Debug, Error)]
pub(super) enum BlockError {
    /// The stream failed.
    #[error(transparent)]
    Stream(#[from] io::Error),
    /// A row that is no row of numbers.
    #[error("no end within {} MiB: expected rows of numbers", LONGEST_ROW >> 20)]
    Endless {
        /// Its line.
        line: u64,
    },
}

/// Some whole rows.
#[derive(Debug)]
pub(super) struct Block {
    bytes: Vec<u8>,
    /// Line number of the first row; the file starts with line 1.
    pub(super) first_line: u64,
    /// Whether no cell is quoted and every row ends with a line feed.
    pub(super) is_plain: bool,
}

impl Block {
    fn new(mut bytes: Vec<u8>, first_line: u64, is_plain: bool) -> Self {
        if is_plain && bytes.last().is_some_and(|&byte| byte != b'\n') {
            bytes.push(b'\n');
        }
        Self {
            bytes,
            first_line,
            is_plain,
        }
    }

    pub(super) fn text(&self) -> &[u8] {
        &self.bytes
    }

    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

fn is_plain(text: &[u8]) -> bool {
    memchr(b'"', text).is_none()
        && memchr_iter(b'\r', text).all(|at| text.get(at + 1) == Some(&b'\n'))
}

/// Cuts a stream into blocks.
#[derive(Debug)]
pub(super) struct Blocks<R> {
    reader: R,
    separator: u8,
    /// Bytes in a block, about.
    size: usize,
    /// The start of a row whose end was not yet read.
    rest: Vec<u8>,
    line: u64,
    has_ended: bool,
}

impl<R: Read> Blocks<R> {
    /// Blocks of `size` bytes, or more where a row is longer, from line `line` on. Quotes count after
    /// this separator of cells.
    pub(super) fn new(reader: R, size: usize, line: u64, separator: u8) -> Self {
        Self {
            reader,
            separator,
            size,
            rest: Vec::new(),
            line,
            has_ended: false,
        }
    }

    /// The next block, in the memory of a former one; `None` at the end.
    ///
    /// # Errors
    /// A failure of the stream, and a row that has no end within 16 MiB.
    pub(super) fn next(&mut self, former: Vec<u8>) -> Result<Option<Block>, BlockError> {
        let mut bytes = former;
        bytes.clear();
        bytes.reserve(self.size.max(self.rest.len()) + 1);
        bytes.append(&mut self.rest);
        let mut size = self.size;
        let mut is_known_plain = false;
        while !self.has_ended {
            let wanted = size.saturating_sub(bytes.len()).max(1);
            let read = (&mut self.reader)
                .take(wanted as u64)
                .read_to_end(&mut bytes)?;
            self.has_ended = read < wanted;
            if self.has_ended {
                break;
            }
            if let Some((end, is_plain)) = last_row_end(&bytes, self.separator) {
                is_known_plain = is_plain;
                self.rest.extend_from_slice(&bytes[end..]);
                bytes.truncate(end);
                break;
            }
            if bytes.len() > LONGEST_ROW {
                return Err(BlockError::Endless { line: self.line });
            }
            size = (2 * size).min(LONGEST_ROW + 1);
        }
        if bytes.is_empty() {
            return Ok(None);
        }
        let first_line = self.line;
        let is_plain = is_known_plain || is_plain(&bytes);
        self.line += match is_plain {
            true => memchr_iter(b'\n', &bytes).count() as u64,
            false => u64::from(lines(&bytes, &self.rest)),
        };
        Ok(Some(Block::new(bytes, first_line, is_plain)))
    }

    /// The stream, read to its end.
    pub(super) fn into_inner(self) -> R {
        self.reader
    }
}

/// Where the last row ends that is whole for certain, and whether all up to there is plain.
fn last_row_end(bytes: &[u8], separator: u8) -> Option<(usize, bool)> {
    // Up to a line feed before which nothing is quoted, every row is whole.
    if let Some(at) = memrchr(b'\n', bytes)
        && is_plain(&bytes[..=at])
    {
        return Some((at + 1, true));
    }
    let mut records = Records::new(bytes, separator);
    let mut last = None;
    while records.next().is_some() && !records.rest().is_empty() {
        last = Some(bytes.len() - records.rest().len());
    }
    last.map(|end| (end, false))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str, size: usize) -> Vec<(u64, bool, String)> {
        let mut blocks = Blocks::new(text.as_bytes(), size, 1, b',');
        let mut all = Vec::new();
        while let Some(block) = blocks.next(Vec::new()).unwrap() {
            let text = String::from_utf8(block.text().to_vec()).unwrap();
            all.push((block.first_line, block.is_plain, text));
        }
        all
    }

    #[test]
    fn blocks_hold_whole_rows() {
        let block = |line, plain, text: &str| (line, plain, text.to_owned());
        assert_eq!(
            texts("a,b\r\n1,2\n\n34,5", 6),
            [
                block(1, true, "a,b\r\n"),
                block(2, true, "1,2\n\n"),
                block(4, true, "34,5\n")
            ]
        );
        assert_eq!(
            texts("a\n\"1\n2\"\n3\n4\n", 7),
            [
                block(1, true, "a\n"),
                block(2, false, "\"1\n2\"\n"),
                block(4, true, "3\n4\n")
            ]
        );
        assert_eq!(
            texts("a\rb\rc", 4),
            [block(1, false, "a\r"), block(2, false, "b\rc")]
        );
    }

    #[test]
    fn a_plain_block_ends_with_a_line_feed() {
        assert_eq!(texts("1,2", 100), [(1, true, "1,2\n".to_owned())]);
        assert_eq!(texts("1,\r2", 100), [(1, false, "1,\r2".to_owned())]);
    }

    #[test]
    fn a_row_without_end_is_refused_in_bounded_memory() {
        let mut blocks = Blocks::new(io::repeat(b'1'), 1 << 20, 1, b',');
        let error = blocks.next(Vec::new()).unwrap_err();
        assert!(matches!(error, BlockError::Endless { line: 1 }));
        assert!(error.to_string().contains("16 MiB"), "{error}");
    }
}
