//! Through the whole application, over its serial link.

use std::path::Path;

use anyhow::{Context, Result, anyhow, ensure};
use tempco_hil::replay::{Comparison, by_block, by_row};
use tempco_hil::{Identity, Patience, Unit, open};
use tempco_link::{FaultSet, Telemetry};
use tempco_set::{ShapeUse, use_shape};

use super::{Differences, Replay};
use crate::output::print;
use crate::progress::Progress;
use crate::unit::port_args::bank_name;

/// The interval of a log may differ by this share from the unit's: times in logs are rounded.
const INTERVAL_TOLERANCE: f64 = 0.1;

/// On a unit, which must have the set.
pub(super) fn at_port(
    put: &Replay,
    port: &Path,
    baud: u32,
    real_time: bool,
) -> Result<(Differences, String)> {
    let mut unit = Unit::connect(open(port, baud)?, Patience::default())
        .with_context(|| port.display().to_string())?;
    let identity = unit.identify()?;
    let (expected, found) = (put.set.crc32(), identity.table_crc);
    ensure!(
        identity.bank.is_some() && found == expected,
        "{}: unit {} runs on {}, but the set is table {expected:08x}: write it with `tempco \
         flash-set SET --port {}`",
        port.display(),
        identity.serial,
        match identity.bank {
            Some(_) => format!("table {found:08x}"),
            None => "no table".to_owned(),
        },
        port.display()
    );
    let place = format!("unit {} at {}", identity.serial, port.display());
    Ok((through(put, &mut unit, &identity, real_time)?, place))
}

/// Replays the log, and prints the state of the unit before and after.
pub(super) fn through(
    put: &Replay,
    unit: &mut Unit,
    identity: &Identity,
    real_time: bool,
) -> Result<Differences> {
    print(format_args!(
        "unit {}, {}, {} channel(s) of {} axes, table {:08x}{}",
        identity.serial,
        identity.firmware,
        identity.channels,
        identity.axes,
        identity.table_crc,
        identity.bank.map(bank_name).unwrap_or_default()
    ))?;
    let in_blocks = is_of_sample_rate(put, identity);
    ensure!(
        in_blocks || !real_time,
        "--real-time: {}: rows {} s apart: expected the sample interval of the unit, {} s, \
         throughout",
        put.log.file,
        put.log.interval_s,
        1.0 / identity.schedule.sample_rate_hz
    );
    let (channels, axes) = (put.inputs.len(), put.inputs[0].channel.axes.len());
    let task = Compare {
        put,
        unit,
        identity,
        in_blocks,
        real_time,
    };
    let comparison = use_shape(channels, axes, task)
        .with_context(|| format!("{channels} channels of {axes} axes: expected up to 6 axes"))??;
    show_state(&comparison.before, &comparison.after)?;
    Ok(Differences {
        count: comparison.different as usize,
        first: comparison.first.map(|row| row as usize),
        blocks: comparison.different_blocks as usize,
        first_block: comparison.first_block.map(|row| row as usize),
    })
}

/// Whether the rows of the log follow each other as the samples of the unit do.
fn is_of_sample_rate(put: &Replay, identity: &Identity) -> bool {
    let rate_hz = f64::from(identity.schedule.sample_rate_hz);
    let is_near = |dt_s: f32| (f64::from(dt_s) * rate_hz - 1.0).abs() < INTERVAL_TOLERANCE;
    put.log.intervals_s().all(is_near)
}

/// Replaying the log through the unit and through the host.
struct Compare<'a, 'u> {
    put: &'a Replay<'a>,
    unit: &'u mut Unit,
    identity: &'a Identity,
    in_blocks: bool,
    real_time: bool,
}

impl ShapeUse for Compare<'_, '_> {
    type Output = Result<Comparison>;

    fn with<const C: usize, const A: usize>(self) -> Self::Output {
        let Self {
            put,
            unit,
            identity,
            in_blocks,
            real_time,
        } = self;
        // The tables that are in the unit.
        let image = put.image.image()?;
        let tables = image.tables::<C, A>()?;
        let progress = Progress::over_rows(put.log.rows() as u64);
        let done = |rows| progress.at(rows);
        let samples = put.samples::<C, A>();
        let comparison = if in_blocks {
            by_block(unit, &tables, &identity.schedule, real_time, samples, done)
        } else {
            by_row(unit, &tables, samples, done)
        };
        comparison.map_err(|error| anyhow!(error))
    }
}

fn show_state(before: &Telemetry, after: &Telemetry) -> Result<()> {
    let newer = |count: fn(&Telemetry) -> u32| count(after).wrapping_sub(count(before));
    print(format_args!(
        "meanwhile in the unit: {} gyro samples, {} overruns, {} frames dropped, {} temperatures \
         rejected",
        newer(|t| t.samples),
        newer(|t| t.overruns),
        newer(|t| t.dropped_frames),
        newer(|t| t.rejected),
    ))?;
    let state = |t: &Telemetry| {
        let load = f64::from(t.load_permille) / 10.0;
        let latency = f64::from(t.latency_ns) / 1000.0;
        let FaultSet(bits) = t.faults;
        let faults = if bits == 0 {
            "no faults".to_owned()
        } else {
            format!("faults: {}", t.faults)
        };
        format!("load {load:.1} %, longest latency {latency:.1} us, {faults}")
    };
    print(format_args!("  before: {}", state(before)))?;
    print(format_args!("  after:  {}", state(after)))
}
