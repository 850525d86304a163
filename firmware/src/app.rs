//! The application: samples in, outcomes out.

use core::fmt;

use embedded_io::{Read, Write};
use heapless::Vec;
use tempco::Table;
use tempco_replay::{Header, HeaderError, Outcome, Record, Replay, Sample, Summary};

/// Bytes that are read or written at once; a record must fit.
const BLOCK: usize = 4096;

/// Replays samples from `input` through the compensators and writes the outcomes to `output`.
///
/// Whatever arrives is worked off and answered before more is read, so that a slow line sees each
/// outcome as soon as it can.
///
/// # Errors
/// A stream that is not of this image's shape, that ends within a record, or whose ends fail. The
/// outcomes of all complete samples before that are written.
pub fn replay<R: Read, W: Write, const C: usize, const A: usize>(
    tables: &[Table<'_, A>; C],
    table_crc: u32,
    mut input: R,
    mut output: W,
) -> Result<Summary, ReplayError<R::Error, W::Error>> {
    const { assert!(Sample::<C, A>::LEN <= BLOCK && Outcome::<C, A>::LEN <= BLOCK) }
    let mut received = Vec::<u8, BLOCK>::new();
    read_header::<_, _, C, A>(&mut input, &mut received)?;
    let header = Header::outcomes::<C, A>(table_crc).encode();
    output.write_all(&header).map_err(ReplayError::Output)?;

    let mut replay = Replay::new(tables);
    let mut outcomes = Vec::<u8, BLOCK>::new();
    loop {
        let mut used = 0;
        while let Some(Ok(sample)) = received.get(used..).map(Sample::decode) {
            used += Sample::<C, A>::LEN;
            append(&replay.step(&sample), &mut outcomes, &mut output)?;
        }
        output.write_all(&outcomes).map_err(ReplayError::Output)?;
        outcomes.clear();
        received.drain(..used);
        if receive(&mut input, &mut received)? == 0 {
            break;
        }
    }
    output.flush().map_err(ReplayError::Output)?;
    match received.len() {
        0 => Ok(replay.summary()),
        given => Err(ReplayError::Truncated {
            samples: replay.summary().samples,
            given,
            needed: Sample::<C, A>::LEN,
        }),
    }
}

/// Reads until the header is complete, and checks it.
fn read_header<R: Read, E, const C: usize, const A: usize>(
    input: &mut R,
    received: &mut Vec<u8, BLOCK>,
) -> Result<(), ReplayError<R::Error, E>> {
    while received.len() < Header::LEN && receive(input, received)? > 0 {}
    Header::decode(received)
        .and_then(|header| header.expect(&Header::samples::<C, A>()))
        .map_err(ReplayError::Header)?;
    received.drain(..Header::LEN);
    Ok(())
}

/// Reads what there is behind what was received; 0 at the end of the input.
fn receive<R: Read, E>(
    input: &mut R,
    received: &mut Vec<u8, BLOCK>,
) -> Result<usize, ReplayError<R::Error, E>> {
    let before = received.len();
    // Cannot fail: the new length is the capacity.
    _ = received.resize(BLOCK, 0);
    let free = received.get_mut(before..).unwrap_or_default();
    let result = input.read(free);
    received.truncate(before + result.as_ref().map_or(0, |count| *count));
    result.map_err(ReplayError::Input)
}

/// Adds an outcome to the block, after writing the block where it is full.
fn append<W: Write, E, const C: usize, const A: usize>(
    outcome: &Outcome<C, A>,
    block: &mut Vec<u8, BLOCK>,
    output: &mut W,
) -> Result<(), ReplayError<E, W::Error>> {
    if BLOCK - block.len() < Outcome::<C, A>::LEN {
        output.write_all(block).map_err(ReplayError::Output)?;
        block.clear();
    }
    let start = block.len();
    // Neither can fail: there is room for one outcome.
    _ = block.resize(start + Outcome::<C, A>::LEN, 0);
    _ = outcome.encode(block.get_mut(start..).unwrap_or_default());
    Ok(())
}

/// Why a replay stopped; `I` and `O` are the errors of input and output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[non_exhaustive]
pub enum ReplayError<I, O> {
    /// The input does not belong to this image.
    Header(HeaderError),
    /// The input ends within a sample.
    Truncated {
        /// Complete samples before it; their outcomes are written.
        samples: u32,
        /// Bytes of the incomplete sample.
        given: usize,
        /// Bytes of a complete sample.
        needed: usize,
    },
    /// Reading failed.
    Input(I),
    /// Writing failed.
    Output(O),
}

impl<I: fmt::Display, O: fmt::Display> fmt::Display for ReplayError<I, O> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Header(error) => error.fmt(f),
            Self::Truncated {
                samples,
                given,
                needed,
            } => write!(
                f,
                "the input ends {given} bytes into a sample of {needed}, after {samples} samples"
            ),
            Self::Input(error) => write!(f, "reading samples: {error}"),
            Self::Output(error) => write!(f, "writing outcomes: {error}"),
        }
    }
}

impl<I, O> core::error::Error for ReplayError<I, O>
where
    I: fmt::Debug + fmt::Display,
    O: fmt::Debug + fmt::Display,
{
}
