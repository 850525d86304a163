//! Records of text with quotes, by the rules of RFC 4180.

use csv_core::{ReadRecordResult, Reader, ReaderBuilder};
use memchr::memchr_iter;

/// The most cells of a record; a longer one counts as this long.
pub(super) const MOST_CELLS: usize = 1 << 16;

/// Goes through the records of a text; blank lines are none.
pub(super) struct Records<'a> {
    reader: Reader,
    rest: &'a [u8],
    /// Lines before `rest`.
    line: u32,
    unquoted: Vec<u8>,
    ends: Vec<usize>,
}

impl<'a> Records<'a> {
    /// Records whose cells are separated by a byte.
    pub(super) fn new(text: &'a [u8], separator: u8) -> Self {
        Self {
            reader: ReaderBuilder::new().delimiter(separator).build(),
            rest: text,
            line: 0,
            unquoted: vec![0; 256],
            ends: vec![0; 64],
        }
    }

    /// The cells of the next record, and the line it starts on, the first being 0.
    pub(super) fn next(&mut self) -> Option<(u32, Vec<&[u8]>)> {
        let blank = self.rest.iter().take_while(|b| matches!(b, b'\r' | b'\n'));
        self.skip(blank.count());
        if self.rest.is_empty() {
            return None;
        }
        self.reader.reset();
        let (mut input, mut written, mut cells) = (0, 0, 0);
        loop {
            let (result, read, wrote, ended) = self.reader.read_record(
                &self.rest[input..],
                &mut self.unquoted[written..],
                &mut self.ends[cells..],
            );
            input += read;
            written += wrote;
            cells += ended;
            match result {
                ReadRecordResult::OutputFull => self.unquoted.resize(2 * self.unquoted.len(), 0),
                ReadRecordResult::OutputEndsFull if cells < MOST_CELLS => {
                    self.ends.resize(2 * self.ends.len(), 0);
                }
                // Of a record at the end of the text: the end is told by an empty input.
                ReadRecordResult::InputEmpty if read > 0 => {}
                _ => break,
            }
        }
        let line = self.line;
        self.skip(input);
        let mut start = 0;
        let cells = self.ends[..cells].iter().map(|&end| {
            let cell = &self.unquoted[start..end];
            start = end;
            cell
        });
        Some((line, cells.collect()))
    }

    /// What follows the last record.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Lines passed so far.
    pub(super) fn line(&self) -> u32 {
        self.line
    }

    fn skip(&mut self, bytes: usize) {
        let (passed, rest) = self.rest.split_at(bytes);
        self.line += lines(passed, rest);
        self.rest = rest;
    }
}

/// Line ends in `text`, which `rest` follows: LF, CR LF, or CR alone.
pub(super) fn lines(text: &[u8], rest: &[u8]) -> u32 {
    let follower = |at: usize| text.get(at + 1).or_else(|| rest.first());
    let feeds = memchr_iter(b'\n', text).count();
    let returns = memchr_iter(b'\r', text).filter(|&at| follower(at) != Some(&b'\n'));
    (feeds + returns.count()) as u32
}
