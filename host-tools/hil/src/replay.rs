//! A log through the unit and through the host, bit by bit.

use std::time::Duration;

use tempco::{MAX_AXES, Schedule, Stream, Table};
use tempco_link::{
    BlockCrc, ChannelTelemetry, Channels, MAX_BLOCK, Outcome, OutcomeBlock, Request, Response,
    Sample, SampleBlock, Telemetry,
};
use tempco_replay::Replay;

use crate::{Error, Unit};

/// What became of a replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Samples that were replayed.
    pub samples: u64,
    /// Those of which the unit made something else than the host.
    pub different: u64,
    /// The number of the first of these, from 0 on.
    pub first: Option<u64>,
    /// Blocks in which a bias or a flag is not the host's, by their CRC.
    pub different_blocks: u64,
    /// The number of the sample with which the first of these begins.
    pub first_block: Option<u64>,
    /// State of the unit before.
    pub before: Telemetry,
    /// State of the unit after.
    pub after: Telemetry,
}

impl Comparison {
    fn count(&mut self, is_same: bool) {
        if !is_same {
            self.different += 1;
            self.first.get_or_insert(self.samples);
        }
        self.samples += 1;
    }

    /// Takes the samples of a block, and whether its CRC is the same.
    fn count_block(&mut self, same: Vec<bool>, is_same_crc: bool) {
        if !is_same_crc {
            self.different_blocks += 1;
            self.first_block.get_or_insert(self.samples);
        }
        same.into_iter().for_each(|is_same| self.count(is_same));
    }
}

/// Replays any log row by row, with thermal updates where the samples say so, through what the unit's
/// main loop runs in place of its compensator; `done` gets the number of samples so far.
///
/// All that the unit answers of a sample is compared: lag-compensated temperature, rate, status, bias
/// and compensated sample.
///
/// # Errors
/// As of [`Unit::ask`].
pub fn by_row<const C: usize, const A: usize>(
    unit: &mut Unit,
    tables: &[Table<'_, A>; C],
    samples: impl Iterator<Item = tempco_replay::Sample<C, A>>,
    mut done: impl FnMut(u64),
) -> Result<Comparison, Error> {
    let mut host = Replay::new(tables);
    observed(unit, |unit, comparison| {
        for sample in samples {
            let request = Request::Sample(Sample {
                update_s: sample.update_s,
                temps_c: sample.temps_c.into_iter().collect(),
                raw: sample.raw.into_iter().flatten().collect(),
            });
            let expected = outcome(&host.step(&sample));
            let is_same = unit.ask(&request, |response| match response {
                Response::Outcome(found) => Some(same_outcome(found, &expected)),
                _ => None,
            })?;
            comparison.count(is_same);
            done(comparison.samples);
        }
        Ok(())
    })
}

/// Replays a log of the unit's own sample rate through its sampling interrupt, in blocks, either
/// as fast as it goes or in real time; which samples are thermal updates is not looked at, and the
/// temperatures come from the rows at which they are due. `done` gets the number of samples so
/// far.
///
/// The compensated samples are compared, and of the last of each block all else as well. Biases and
/// flags of all samples of a block are compared by their CRC.
///
/// # Errors
/// As of [`Unit::ask`].
pub fn by_block<const C: usize, const A: usize>(
    unit: &mut Unit,
    tables: &[Table<'_, A>; C],
    schedule: &Schedule,
    real_time: bool,
    mut samples: impl Iterator<Item = tempco_replay::Sample<C, A>>,
    mut done: impl FnMut(u64),
) -> Result<Comparison, Error> {
    const { assert!(C * A > 0 && C * A <= MAX_AXES) }
    let mut host = Stream::new(tables, schedule);
    // Whole pulses in pulses per second: they take a byte each on the line instead of four.
    let scale = schedule.sample_rate_hz;
    let most = MAX_BLOCK / (4 * C * A);
    let mut until_update = 0;
    observed(unit, |unit, comparison| {
        loop {
            let is_due = until_update == 0;
            if is_due {
                until_update = usize::from(schedule.samples_per_update).max(1);
            }
            // A block ends where temperatures are due, since it takes them at its beginning.
            let block: Vec<_> = samples.by_ref().take(most.min(until_update)).collect();
            let Some(first) = block.first() else {
                return Ok(());
            };
            until_update -= block.len();
            let mut temps_c = Channels::new();
            if is_due {
                host.temperatures(&first.temps_c);
                temps_c.extend(first.temps_c);
            }
            let mut expected = Expected::default();
            let mut raw = Vec::with_capacity(MAX_BLOCK);
            for sample in &block {
                append(&mut raw, sample.raw.iter().flatten());
                expected.push(&host.sample(&sample.raw).into());
            }
            let values = block.iter().flat_map(|sample| sample.raw.iter().flatten());
            let counts: Option<Vec<u8>> = values.map(|value| count(*value, scale)).collect();
            let request = Request::Block(SampleBlock {
                temps_c,
                real_time,
                scale: counts.is_some().then_some(scale),
                raw: counts.as_ref().unwrap_or(&raw),
            });
            let takes = Duration::from_secs_f32(block.len() as f32 / schedule.sample_rate_hz);
            let crc = core::mem::take(&mut expected.crc).finish();
            let (same, is_same_crc) =
                unit.ask_patiently(&request, takes, |response| match response {
                    Response::Block(found) => {
                        let same = expected.compare(found, 4 * C * A)?;
                        Some((same, found.crc == crc))
                    }
                    _ => None,
                })?;
            comparison.count_block(same, is_same_crc);
            done(comparison.samples);
        }
    })
}

/// The byte of a value that is exactly so many counts.
fn count(value: f32, scale: f32) -> Option<u8> {
    let count = (value / scale).round() as i8;
    let is_exact = (f32::from(count) * scale).to_bits() == value.to_bits();
    is_exact.then_some(count.cast_unsigned())
}

/// What a block must be answered by.
#[derive(Default)]
struct Expected {
    compensated: Vec<u8>,
    /// Of the last sample.
    last: Outcome,
    /// Of the biases and flags of all samples.
    crc: BlockCrc,
}

impl Expected {
    fn push<const C: usize, const A: usize>(&mut self, made: &tempco_replay::Outcome<C, A>) {
        for channel in &made.channels {
            self.crc.add(channel.status, &channel.bias);
        }
        let made = outcome(made);
        append(&mut self.compensated, &made.compensated);
        self.last = made;
    }

    /// For each sample whether it is the same; none where the answer has another number of samples.
    fn compare(&self, found: &OutcomeBlock, sample_len: usize) -> Option<Vec<bool>> {
        if found.compensated.len() != self.compensated.len() {
            return None;
        }
        let pairs = found
            .compensated
            .chunks_exact(sample_len)
            .zip(self.compensated.chunks_exact(sample_len));
        let mut same: Vec<bool> = pairs.map(|(found, expected)| found == expected).collect();
        if let Some(of_last) = same.last_mut() {
            *of_last &= same_channels(&found.channels, &self.last.channels)
                && same_bits(&found.bias, &self.last.bias);
        }
        Some(same)
    }
}

/// Starts a replay in the unit, and looks at its state before and after. Telemetry that comes
/// unasked is turned off, since it takes the line's time.
fn observed(
    unit: &mut Unit,
    run: impl FnOnce(&mut Unit, &mut Comparison) -> Result<(), Error>,
) -> Result<Comparison, Error> {
    let before = unit.telemetry(0)?;
    unit.command(&Request::Restart)?;
    let mut comparison = Comparison {
        samples: 0,
        different: 0,
        first: None,
        different_blocks: 0,
        first_block: None,
        after: before.clone(),
        before,
    };
    run(unit, &mut comparison)?;
    comparison.after = unit.telemetry(0)?;
    Ok(comparison)
}

/// An outcome as it goes over the link.
fn outcome<const C: usize, const A: usize>(made: &tempco_replay::Outcome<C, A>) -> Outcome {
    let channels = made.channels.iter();
    Outcome {
        channels: channels
            .clone()
            .map(|channel| ChannelTelemetry {
                effective_c: channel.effective_c,
                rate_c_per_min: channel.rate_c_per_min,
                status: channel.flags().bits(),
            })
            .collect(),
        bias: channels.clone().flat_map(|channel| channel.bias).collect(),
        compensated: channels.flat_map(|channel| channel.compensated).collect(),
    }
}

fn append<'a>(bytes: &mut Vec<u8>, values: impl IntoIterator<Item = &'a f32>) {
    bytes.extend(values.into_iter().flat_map(|value| value.to_le_bytes()));
}

fn same_outcome(found: &Outcome, expected: &Outcome) -> bool {
    same_channels(&found.channels, &expected.channels)
        && same_bits(&found.bias, &expected.bias)
        && same_bits(&found.compensated, &expected.compensated)
}

fn same_channels(found: &[ChannelTelemetry], expected: &[ChannelTelemetry]) -> bool {
    let bits = |channel: &ChannelTelemetry| {
        let (effective_c, rate) = (channel.effective_c, channel.rate_c_per_min);
        (effective_c.to_bits(), rate.to_bits(), channel.status)
    };
    found.iter().map(bits).eq(expected.iter().map(bits))
}

/// Equal to the bit, for NaN and signed zeros.
fn same_bits(found: &[f32], expected: &[f32]) -> bool {
    let (found, expected) = (found.iter(), expected.iter());
    found
        .map(|value| value.to_bits())
        .eq(expected.map(|value| value.to_bits()))
}
