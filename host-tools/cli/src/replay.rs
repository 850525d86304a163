//! `tempco replay`: the same log through the firmware and through the host, bit by bit.

use anyhow::{Result, anyhow, ensure};
use clap::ValueEnum;
use tempco::Table;
use tempco_fit::apply::{ChannelInputs, inputs};
use tempco_fit::log::Log;
use tempco_fit::set::{CoefficientSet, TableData, TableUse, table_rs, use_tables, write_files};
use tempco_qemu::{Board, Workspace, build, ensure_qemu, ensure_target_of, replay};
use tempco_replay::{Header, Outcome, Record, Replay, Sample};

use crate::Verdict;
use crate::output::print;
use crate::shared_args::SetAndLog;

/// Run a log through the firmware and compare every result with the host, bit for bit
///
/// Builds the firmware with the table of the set; for that it needs the sources of tempco. What
/// is missing (compiler target, emulator) is installed. Exits with 1 where a result differs.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Where the firmware runs
    #[arg(long, value_enum)]
    target: Target,
    /// Board to build for: mps2-an386, stm32f405, mps2-an500 or mps2-an505
    #[arg(long, default_value = "mps2-an386")]
    board: Board,
    // Last, since what follows would stand under its heading.
    #[command(flatten)]
    put: SetAndLog,
}

#[derive(Clone, Copy, ValueEnum)]
enum Target {
    /// The emulator
    Qemu,
}

pub(crate) fn run(args: &Args) -> Result<Verdict> {
    let (set, log) = args.put.read()?;
    let inputs = inputs(&set, &log)?;
    let Target::Qemu = args.target;

    macro_rules! for_shapes {
        ($(($channels:literal, $axes:literal))+) => {
            match (inputs.len(), inputs[0].channel.axes.len()) {
                $(($channels, $axes) => streams::<$channels, $axes>(&set, &log, &inputs)?,)+
                (channels, axes) => {
                    return Err(anyhow!("{channels} channels of {axes} axes: expected up to 6 axes"));
                }
            }
        };
    }
    let streams = for_shapes!(
        (1, 1)(1, 2)(1, 3)(1, 4)(1, 5)(1, 6)(2, 1)(2, 2)(2, 3)(3, 1)(3, 2)(4, 1)(5, 1)(6, 1)
    );
    let outcomes = run_firmware(&set, args.board, &streams.samples)?;
    compare(&log, args.board, &streams, &outcomes)
}

/// A log as the firmware takes it, and what it should answer.
struct Streams {
    samples: Vec<u8>,
    expected: Vec<u8>,
    outcome_len: usize,
}

fn streams<const C: usize, const A: usize>(
    set: &CoefficientSet,
    log: &Log,
    inputs: &[ChannelInputs],
) -> Result<Streams> {
    let data: Vec<&TableData> = inputs.iter().map(|input| &input.channel.table).collect();
    let data: [&TableData; C] = data
        .try_into()
        .map_err(|_| anyhow!("channels of the set"))?;
    use_tables::<C, A, _>(data, MakeStreams { set, log, inputs })?
}

/// Running the log through the host.
struct MakeStreams<'a> {
    set: &'a CoefficientSet,
    log: &'a Log,
    inputs: &'a [ChannelInputs<'a>],
}

impl<const C: usize, const A: usize> TableUse<C, A> for MakeStreams<'_> {
    type Output = Result<Streams>;

    fn with<const PLAYS: usize, const SLOW: usize>(
        self,
        tables: &[Table<A, PLAYS, SLOW>; C],
    ) -> Self::Output {
        let Self { set, log, inputs } = self;
        let mut host = Replay::new(tables);
        let mut samples = Header::samples::<C, A>().encode().to_vec();
        let mut expected = Header::outcomes::<C, A>(set.crc32()).encode().to_vec();
        for (row, dt_s) in log.intervals_s().enumerate() {
            let sample = Sample::<C, A> {
                dt_s,
                temps_c: std::array::from_fn(|channel| inputs[channel].temp_c[row]),
                raw: std::array::from_fn(|channel| inputs[channel].row(row)),
            };
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

/// Builds the image with the set's table, runs it over the samples, shows its log.
fn run_firmware(set: &CoefficientSet, board: Board, samples: &[u8]) -> Result<Vec<u8>> {
    let workspace = Workspace::find()?;
    ensure_target_of(&workspace, board)?;
    ensure_qemu(&workspace)?;
    let folder = std::env::temp_dir().join(format!("tempco-replay-{}", std::process::id()));
    write_files(&folder, &[("table.rs", table_rs(set).as_bytes())])?;
    let image = build(&workspace, board, "replay", Some(&folder.join("table.rs")));
    let _ = std::fs::remove_dir_all(&folder);
    let (outcomes, run) = replay(&image?, board, samples)?;
    for line in &run.log {
        print(format_args!("{board}: {line}"))?;
    }
    ensure!(
        run.succeeded(),
        "the firmware ended with exit code {}",
        run.exit_code
    );
    Ok(outcomes)
}

fn compare(log: &Log, board: Board, streams: &Streams, outcomes: &[u8]) -> Result<Verdict> {
    let (expected_header, expected) = streams.expected.split_at(Header::LEN);
    ensure!(
        outcomes.get(..Header::LEN) == Some(expected_header),
        "the firmware answered with another header than its table's"
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
    let different: Vec<usize> = pairs
        .enumerate()
        .filter(|(_, (expected, found))| expected != found)
        .map(|(row, _)| row)
        .collect();
    print(format_args!(
        "{} of {} samples differ between host and {board}",
        different.len(),
        log.rows()
    ))?;
    if let Some(&row) = different.first() {
        eprintln!(
            "the first one that differs is row {} at {} s",
            row + 1,
            log.time_s[row]
        );
    }
    Ok(Verdict::of(different.is_empty()))
}
