//! `tempco inspect`: what is in a coefficient set.

mod show;

use std::path::PathBuf;

use anyhow::{Result, ensure};
use serde_json::{Value, json};
use tempco_evaluate::{boundaries, judge};
use tempco_set::{ChannelSet, CoefficientSet, Judgement, RejectionCode, read_set};

use crate::Exit;
use crate::answer::{Answer, channel_notes};
use crate::image;
use crate::shared_args::PrintArgs;

/// Show a coefficient set or a flash image, with its verdict
///
/// Prints how the set does on the fitted logs, its ranges, its CRC and where it comes from; with
/// --verbose also its coefficients. A flash image has no verdict, but can be compared with its set.
///
/// Exit code 1: the set is rejected, the image was not made from the set, or the files in the
/// folder of the set do not belong together.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco inspect RLG-7/coefficients.json")]
pub(crate) struct Args {
    /// Coefficient set (coefficients.json), printed static coefficients (.csv) or flash image (.bin)
    #[arg(value_name = "SET")]
    set: PathBuf,
    /// For a flash image: the coefficients.json that it should be made from
    #[arg(long, value_name = "SET")]
    against: Option<PathBuf>,
    #[command(flatten)]
    print: PrintArgs,
}

/// Logs that are named; the others are counted.
const LOGS_NAMED: usize = 2;

pub(crate) fn run(args: &Args) -> Result<Exit> {
    if image::is_image(&args.set) {
        ensure!(
            !args.print.json,
            "--json: expected with a coefficient set only"
        );
        return image::inspect(&args.set, args.against.as_deref(), args.print.verbose);
    }
    ensure!(
        args.against.is_none(),
        "--against: expected with a flash image (.bin) only"
    );
    let set = read_set(&args.set)?;
    let judgement = judge(&set, None);
    let answer = Answer {
        set: &set,
        judgement: &judgement,
        evaluation: None,
        is_against: false,
        notes: notes(&set),
        written: Vec::new(),
    };
    let json = || derived(&set, &judgement);
    answer.print(&args.print, &args.set, json, || show::show(&set))?;
    let is_whole = image::is_folder_whole(&args.set);
    Ok(Exit::of(judgement.is_accepted() && is_whole))
}

/// The set with what follows from it.
fn derived(set: &CoefficientSet, judgement: &Judgement) -> Value {
    let of_channel = |channel: &ChannelSet| {
        let axes = channel.axes.iter().enumerate().map(|(number, axis)| {
            json!({
                "axis": axis.name,
                "unit": axis.unit,
                "static_range": channel.table.static_range(number),
                "rounding_bound": channel.table.rounding_bound(number).total,
                "max_jump": channel.table.max_jump(number),
                "boundaries": boundaries(channel, number),
            })
        });
        json!({"temperature": channel.temperature, "axes": axes.collect::<Vec<_>>()})
    };
    let channels: Vec<Value> = set.channels.iter().map(of_channel).collect();
    let rejections = judgement.rejections.iter();
    let alarms = rejections.filter(|of| of.code == RejectionCode::SegmentsDisagree);
    let alarms: Vec<_> = alarms.map(|of| of.axis.as_deref()).collect();
    json!({
        "set": set,
        "rejected": !judgement.is_accepted(),
        "alarms": alarms,
        "channels": channels,
    })
}

/// Ranges, and where the set comes from.
fn notes(set: &CoefficientSet) -> Vec<String> {
    let mut notes: Vec<String> = set.channels.iter().flat_map(channel_notes).collect();
    let provenance = &set.provenance;
    notes.push(format!(
        "table CRC-32P4 {}, made by {} at {}",
        set.table_crc32, provenance.tool, provenance.created
    ));
    let inputs = provenance.inputs.iter().take(LOGS_NAMED);
    let named: Vec<String> = inputs
        .map(|input| format!("{} ({} rows)", input.file, input.rows))
        .collect();
    if !named.is_empty() {
        let more = match provenance.inputs.len().saturating_sub(LOGS_NAMED) {
            0 => String::new(),
            count => format!(" and {count} more"),
        };
        notes.push(format!("fitted to {}{more}", named.join(", ")));
    }
    if let Some(last) = set.sign_offs.last() {
        let outcome = if last.accepted {
            "accepted"
        } else {
            "rejected"
        };
        let (file, judged) = (&last.file, &last.judged);
        notes.push(format!("signed off on {file} at {judged}: {outcome}"));
    }
    notes
}
