//! The application on the host, over lines that deliver as much or little as they like.

use std::io;

use embedded_io::{ErrorKind, ErrorType, Read, Write};
use tempco_firmware::app::{ReplayError, replay};
use tempco_firmware::table::{CRC, TABLES};
use tempco_replay::{Header, HeaderError, Outcome, Record, Replay, Sample, Summary, decode_all};

const C: usize = 1;
const A: usize = 3;
type In = Sample<C, A>;

/// A line that transfers at most `step` bytes at once and breaks after `limit`.
struct Line {
    bytes: Vec<u8>,
    place: usize,
    step: usize,
    limit: usize,
}

impl Line {
    fn new(bytes: Vec<u8>, step: usize) -> Self {
        Self {
            bytes,
            place: 0,
            step,
            limit: usize::MAX,
        }
    }

    fn advance(&mut self, wanted: usize) -> Result<usize, ErrorKind> {
        if self.place >= self.limit {
            return Err(ErrorKind::BrokenPipe);
        }
        let count = wanted.min(self.step).min(self.limit - self.place);
        self.place += count;
        Ok(count)
    }
}

impl ErrorType for Line {
    type Error = ErrorKind;
}

impl Read for Line {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ErrorKind> {
        let from = self.place;
        let count = self.advance(buffer.len().min(self.bytes.len() - from))?;
        buffer[..count].copy_from_slice(&self.bytes[from..from + count]);
        Ok(count)
    }
}

impl Write for Line {
    fn write(&mut self, buffer: &[u8]) -> Result<usize, ErrorKind> {
        let count = self.advance(buffer.len())?;
        self.bytes.extend_from_slice(&buffer[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

fn samples(count: usize) -> Vec<In> {
    (0..count)
        .map(|i| Sample {
            // The bad temperatures are updates.
            update_s: (i % 3 != 1 || i % 50 == 49).then_some(1.0),
            temps_c: [if i % 50 == 49 {
                f32::NAN
            } else {
                20.0 + i as f32 * 0.01
            }],
            raw: [[0.1, 0.2, 0.3]],
        })
        .collect()
}

fn encode(samples: &[In]) -> Vec<u8> {
    let mut bytes = Header::samples::<C, A>().encode().to_vec();
    for sample in samples {
        let start = bytes.len();
        bytes.resize(start + In::LEN, 0);
        sample.encode(&mut bytes[start..]).unwrap();
    }
    bytes
}

fn run(
    bytes: Vec<u8>,
    step: usize,
) -> (Result<Summary, ReplayError<ErrorKind, ErrorKind>>, Vec<u8>) {
    let mut output = Line::new(Vec::new(), step);
    let result = replay(&TABLES, CRC, Line::new(bytes, step), &mut output);
    (result, output.bytes)
}

#[test]
fn outcomes_are_those_of_the_replay_however_the_bytes_arrive() {
    let samples = samples(1000);
    let mut reference = Replay::new(&TABLES);
    let expected: Vec<_> = samples
        .iter()
        .map(|sample| reference.step(sample))
        .collect();
    for step in [1, 7, In::LEN, 4095, 4096, usize::MAX] {
        let (summary, bytes) = run(encode(&samples), step);
        assert_eq!(summary, Ok(reference.summary()));
        let (header, records) = bytes.split_at(Header::LEN);
        let header = Header::decode(header).unwrap();
        header.expect(&Header::outcomes::<C, A>(CRC)).unwrap();
        let outcomes: Vec<Outcome<C, A>> = decode_all(records).unwrap().collect();
        assert_eq!(outcomes, expected, "step {step}");
    }
    let summary = reference.summary();
    assert_eq!(
        (summary.samples, summary.rejected, summary.restarts),
        (1000, 20, 1)
    );
}

#[test]
fn foreign_and_cut_streams_are_refused() {
    let whole = encode(&samples(300));
    for cut in [0, 1, Header::LEN - 1] {
        let (result, output) = run(whole[..cut].to_vec(), 4096);
        assert_eq!(
            result,
            Err(ReplayError::Header(HeaderError::Short { given: cut }))
        );
        assert!(output.is_empty());
    }
    let mut foreign = Header::samples::<3, 1>().encode().to_vec();
    foreign.extend_from_slice(&whole[Header::LEN..]);
    let (result, output) = run(foreign, 4096);
    assert!(matches!(
        result,
        Err(ReplayError::Header(HeaderError::Shape { .. }))
    ));
    assert!(output.is_empty());

    for cut in 1..In::LEN {
        let (result, output) = run(whole[..whole.len() - cut].to_vec(), 1000);
        let truncated = ReplayError::Truncated {
            samples: 299,
            given: In::LEN - cut,
            needed: In::LEN,
        };
        assert_eq!(result, Err(truncated));
        assert_eq!(output.len(), Header::LEN + 299 * Outcome::<C, A>::LEN);
    }
    assert_eq!(
        run(whole[..Header::LEN].to_vec(), 4096).0.unwrap().samples,
        0
    );
}

#[test]
fn broken_lines_are_reported_as_such() {
    let whole = encode(&samples(500));
    let mut input = Line::new(whole.clone(), 100);
    input.limit = 1000;
    let result = replay(&TABLES, CRC, input, &mut Line::new(Vec::new(), 100));
    assert_eq!(result, Err(ReplayError::Input(ErrorKind::BrokenPipe)));

    let mut output = Line::new(Vec::new(), 100);
    output.limit = 1000;
    let result = replay(&TABLES, CRC, Line::new(whole, 100), &mut output);
    assert_eq!(result, Err(ReplayError::Output(ErrorKind::BrokenPipe)));
    assert_eq!(
        io::Error::other(result.unwrap_err()).to_string(),
        "writing outcomes: BrokenPipe"
    );
}
