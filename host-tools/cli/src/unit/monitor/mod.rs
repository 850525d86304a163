//! `tempco monitor`: what a unit measures, and its state.

mod show;

use std::io::{IsTerminal, stdout};
use std::time::Duration;

use anyhow::Result;
use serde::Serialize;
use tempco_hil::Unit;
use tempco_link::Telemetry;

use crate::Exit;
use crate::output::{print_json, say};
use crate::status::status_names;
use crate::unit::port_args::{PortArgs, check_period};

/// Time beyond the period without a message, after which the unit is asked again: it may have been
/// reset.
const SILENCE: Duration = Duration::from_secs(2);

/// Show what a unit measures, and its state
///
/// Prints temperatures, rates, samples, biases, faults and counters.
///
/// A live view on a terminal, else one line per message. Ends with an error if the unit sends
/// nothing any more. A reset of the unit does not end it.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco monitor --port /dev/ttyUSB0")]
pub(crate) struct Args {
    #[command(flatten)]
    port: PortArgs,
    /// Time between messages, in ms
    #[arg(long, value_name = "MS", default_value_t = 1000)]
    period: u32,
    /// End after this number of messages. Without, Ctrl-C ends it
    #[arg(long, value_name = "N")]
    count: Option<u64>,
    /// Print one JSON object per message
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    check_period(args.period)?;
    let mut unit = args.port.connect()?;
    let identity = unit.identify()?;
    let mut view = show::View::new(&identity, stdout().is_terminal());
    if !args.json {
        view.begin()?;
    }
    let mut next = Some(unit.telemetry(args.period)?);
    let mut left = args.count;
    let mut last: Option<u32> = None;
    while left != Some(0) {
        let telemetry = match next.take() {
            Some(telemetry) => telemetry,
            None => wait(&mut unit, args.period)?,
        };
        say_lost(last, telemetry.index);
        last = Some(telemetry.index);
        if args.json {
            print_json(&Message::new(&telemetry))?;
        } else {
            view.show(&telemetry)?;
        }
        left = left.map(|left| left - 1);
    }
    unit.telemetry(0)?;
    Ok(Exit::Acceptable)
}

/// The next message; after a silence the unit is asked again.
fn wait(unit: &mut Unit, period_ms: u32) -> Result<Telemetry> {
    let timeout = Duration::from_millis(period_ms.into()) + SILENCE;
    match unit.wait_telemetry(timeout)? {
        Some(telemetry) => Ok(telemetry),
        None => Ok(unit.telemetry(period_ms)?),
    }
}

/// Says how many messages were missed between two.
fn say_lost(last: Option<u32>, index: u32) {
    match last.map(|last| index.wrapping_sub(last)) {
        Some(missed @ 2..=0x7fff_ffff) => say!("{} messages were lost", missed - 1),
        Some(0x8000_0000..) => say!("the unit was reset"),
        _ => {}
    }
}

/// A message as JSON: the numbers of the link, with names for its bits.
#[derive(Serialize)]
struct Message<'a> {
    #[serde(flatten)]
    telemetry: &'a Telemetry,
    /// Names of the faults that are present.
    fault_names: Vec<&'static str>,
    /// Flags in the status of each channel.
    status_names: Vec<Vec<&'static str>>,
}

impl<'a> Message<'a> {
    fn new(telemetry: &'a Telemetry) -> Self {
        let channels = telemetry.outcome.channels.iter();
        Self {
            telemetry,
            fault_names: telemetry.faults.iter().map(|fault| fault.name()).collect(),
            status_names: channels
                .map(|channel| status_names(tempco::Status::from_bits(channel.status)))
                .collect(),
        }
    }
}
