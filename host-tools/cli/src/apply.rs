//! `tempco apply`: a log with its bias subtracted.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Result;
use tempco::Status;
use tempco_evaluate::judge;
use tempco_log::Log;
use tempco_set::CoefficientSet;
use tempco_set::escape::csv_cell;
use tempco_set::run::{Applied, apply, inputs};

use crate::Exit;
use crate::judgement::say_rejections;
use crate::output::{print, write_file};
use crate::shared_args::SetAndLog;
use crate::status::status_text;

/// Compensate a log with a coefficient set, as the firmware does
///
/// Columns of the result: time_s, the temperatures, for each axis NAME_raw_UNIT, NAME_bias_UNIT and
/// NAME_compensated_UNIT, and status (ok, or flags joined by +).
#[derive(clap::Args)]
#[command(
    after_help = "Example: tempco apply RLG-7/coefficients.json verification.csv --out out.csv"
)]
pub(crate) struct Args {
    /// Where to write the result
    #[arg(long, value_name = "OUT.csv")]
    out: PathBuf,
    // Last: later options would stand under its heading.
    #[command(flatten)]
    put: SetAndLog,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let (set, log) = args.put.read()?;
    say_rejections(args.put.set.display(), &judge(&set, None));
    let applied = apply(&set, &log)?;
    write_file(&args.out, &to_csv(&set, &log, &applied)?)?;
    let flagged = applied.status.iter().filter(|s| **s != Status::OK).count();
    print(format_args!(
        "{} rows, {flagged} with a flag in their status; wrote {}",
        log.rows(),
        args.out.display()
    ))?;
    Ok(Exit::Acceptable)
}

fn to_csv(set: &CoefficientSet, log: &Log, applied: &Applied) -> Result<Vec<u8>> {
    let mut out = Vec::with_capacity(100 * log.rows());
    let inputs = inputs(set, log)?;
    let mut header = vec!["time_s".to_owned()];
    header.extend(
        inputs
            .iter()
            .map(|input| csv_cell(&input.channel.temperature)),
    );
    for (_, axis) in set.axes() {
        for what in ["raw", "bias", "compensated"] {
            header.push(csv_cell(&format!(
                "{}_{what}_{}",
                axis.name,
                axis.unit.name()
            )));
        }
    }
    header.push("status".to_owned());
    csv::Writer::from_writer(&mut out).write_record(&header)?;
    for row in 0..log.rows() {
        write!(out, "{}", log.time_s[row])?;
        for input in &inputs {
            write!(out, ",{}", input.temp_c[row])?;
        }
        for axis in &applied.axes {
            let (raw, bias) = (axis.raw[row], axis.bias[row]);
            write!(out, ",{raw},{bias},{}", axis.compensated[row])?;
        }
        writeln!(out, ",{}", status_text(applied.status[row]))?;
    }
    Ok(out)
}
