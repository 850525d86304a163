//! `tempco rezero`: the constant bias of a unit at rest.

use anyhow::{Result, ensure};
use tempco::Status;
use tempco_hil::{Identity, ReZeroed, re_zero};
use tempco_link::{Axes, Request};

use crate::Exit;
use crate::output::{figure, print, print_lines, table};
use crate::progress::Progress;
use crate::status::status_text;
use crate::unit::port_args::PortArgs;

/// Find the constant bias of a unit at rest
///
/// The unit takes the mean of its compensated samples, less what it should show, as a constant bias
/// and keeps it with its table. It gives up, and keeps what it had, where it is not valid and at
/// rest all the time.
///
/// Exit code 1: the unit gave up.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco rezero --port /dev/ttyUSB0 --expected 0,9.77,11.5")]
pub(crate) struct Args {
    #[command(flatten)]
    port: PortArgs,
    /// Averaging time, in s
    #[arg(long, value_name = "S", default_value_t = 60, value_parser = clap::value_parser!(u16).range(1..=3600))]
    seconds: u16,
    /// What each axis should show at rest, in its unit, such as the Earth's rate. Without, 0
    #[arg(long, value_name = "X,Y,..", value_delimiter = ',', value_parser = finite,
        allow_hyphen_values = true)]
    expected: Vec<f32>,
    /// Set all constant biases to 0 instead
    #[arg(long, conflicts_with_all = ["seconds", "expected"])]
    clear: bool,
}

fn finite(text: &str) -> Result<f32, &'static str> {
    let value = text.parse().ok().filter(|value: &f32| value.is_finite());
    value.ok_or("expected a number")
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let mut unit = args.port.connect()?;
    let identity = unit.identify()?;
    if args.clear {
        unit.command(&Request::ClearOffsets)?;
        print(format_args!(
            "unit {}: constant biases are 0",
            identity.serial
        ))?;
        return Ok(Exit::Acceptable);
    }
    let axes = identity.fits.len();
    ensure!(
        args.expected.is_empty() || args.expected.len() == axes,
        "--expected: {} numbers: expected {axes}, one per axis of unit {}",
        args.expected.len(),
        identity.serial
    );
    let expected: Axes = args.expected.iter().copied().collect();
    let progress = Progress::over_recording(Some(args.seconds.into()));
    let done = re_zero(&mut unit, args.seconds, expected, |done_s| {
        progress.at(done_s as u64);
    });
    drop(progress);
    match done? {
        ReZeroed::Done { before, after } => {
            print(format_args!("unit {}: re-zero done", identity.serial))?;
            show(&identity, &before, &after)?;
            Ok(Exit::Acceptable)
        }
        ReZeroed::GivenUp { detail } => {
            print(format_args!(
                "unit {}: re-zero given up, nothing has changed: {}",
                identity.serial,
                reason(detail)
            ))?;
            Ok(Exit::NotAcceptable)
        }
    }
}

fn show(identity: &Identity, before: &Axes, after: &Axes) -> Result<()> {
    let axes = identity.fits.iter().zip(before.iter().zip(after)).zip(0..);
    let rows = axes.map(|((fit, (before, after)), number): (_, u32)| {
        vec![
            number.to_string(),
            fit.unit.symbol().to_owned(),
            figure(f64::from(*before)),
            figure(f64::from(*after)),
        ]
    });
    print_lines(table(&["axis", "unit", "before", "now"], rows))
}

/// Why the unit gave up, from the detail of the fault.
fn reason(detail: u32) -> String {
    let low = detail & 0xffff;
    match detail >> 16 {
        1 => format!(
            "the status was not valid ({}); wait until `tempco monitor` shows ok",
            status_text(Status::from_bits(low as u16))
        ),
        2 => format!("axis {low} scattered more than at rest; is the unit still?"),
        3 => format!(
            "the constant bias of axis {low} would be beyond the limit of its board; state by \
             --expected what the unit should show"
        ),
        _ => format!("detail {detail:#x}"),
    }
}
