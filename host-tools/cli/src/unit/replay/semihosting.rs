//! Through the compensators alone, on boards without the application: files in, files out.

use anyhow::{Result, ensure};
use tempco::Table;
use tempco_qemu::{Board, Variant, replay};
use tempco_replay::{Header, Outcome, Record};
use tempco_set::{TableData, TableUse, use_tables};

use super::{Differences, Replay};
use crate::output::print;
use crate::unit::firmware::build;

/// Builds the firmware with the table of the set, runs it over the log, and prints its messages.
pub(super) fn in_qemu(put: &Replay, board: Board) -> Result<Differences> {
    let tables: Vec<&TableData> = put.inputs.iter().map(|i| &i.channel.table).collect();
    let streams = use_tables(&tables, MakeStreams(put))??;
    let image = build(Some(put.set), board, "replay", &Variant::USUAL)?;
    let (outcomes, run) = replay(&image, board, &streams.samples)?;
    for line in &run.log {
        print(format_args!("{board}: {line}"))?;
    }
    ensure!(
        run.succeeded(),
        "the firmware ended with exit code {}",
        run.exit_code
    );
    compare(&streams, &outcomes)
}

/// A log as the firmware takes it, and the expected answer.
struct Streams {
    samples: Vec<u8>,
    expected: Vec<u8>,
    outcome_len: usize,
}

/// Running the log through the host.
struct MakeStreams<'a>(&'a Replay<'a>);

impl TableUse for MakeStreams<'_> {
    type Output = Result<Streams>;

    fn with<const C: usize, const A: usize>(self, tables: &[Table<A>; C]) -> Self::Output {
        let Self(put) = self;
        let mut host = tempco_replay::Replay::new(tables);
        let mut samples = Header::samples::<C, A>().encode().to_vec();
        let mut expected = Header::outcomes::<C, A>(put.set.crc32()).encode().to_vec();
        for sample in put.samples::<C, A>() {
            append(&mut samples, &sample)?;
            append(&mut expected, &host.step(&sample))?;
        }
        Ok(Streams {
            samples,
            expected,
            outcome_len: Outcome::<C, A>::LEN,
        })
    }
}

fn append<R: Record>(bytes: &mut Vec<u8>, record: &R) -> Result<()> {
    let end = bytes.len();
    bytes.resize(end + R::LEN, 0);
    record.encode(&mut bytes[end..])?;
    Ok(())
}

fn compare(streams: &Streams, outcomes: &[u8]) -> Result<Differences> {
    let (expected_header, expected) = streams.expected.split_at(Header::LEN);
    ensure!(
        outcomes.get(..Header::LEN) == Some(expected_header),
        "the firmware answered with the header of another table"
    );
    let found = &outcomes[Header::LEN..];
    ensure!(
        found.len() == expected.len(),
        "the firmware answered {} bytes, expected {}",
        found.len(),
        expected.len()
    );
    let pairs = expected
        .chunks_exact(streams.outcome_len)
        .zip(found.chunks_exact(streams.outcome_len));
    let mut different = pairs
        .enumerate()
        .filter(|(_, (expected, found))| expected != found)
        .map(|(row, _)| row);
    let first = different.next();
    Ok(Differences {
        count: usize::from(first.is_some()) + different.count(),
        first,
        blocks: 0,
        first_block: None,
    })
}
