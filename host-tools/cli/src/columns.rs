//! `tempco columns`: how a log would be read.

use std::path::PathBuf;

use anyhow::Result;
use serde_json::json;
use tempco_log::{ColumnUse, LogStream};

use crate::Exit;
use crate::output::{WIDTH, print_json, print_lines, print_wrapped, table, within};
use crate::shared_args::LogArgs;

/// Show what each column of a log is taken for
///
/// Only the header and the first rows are read. Where a column is not recognised, or is taken for
/// something else, the options below name it. `fit` and the other commands take the same options.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco columns chamber.csv")]
pub(crate) struct Args {
    /// Log of a unit: CSV (plain, gzip or zstd), Parquet, ULog (.ulg) or DataFlash (.bin)
    #[arg(value_name = "LOG.csv")]
    log: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: LogArgs,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    let log = LogStream::open(&args.log, &args.reading.options(None)?)?;
    let (columns, reading) = (log.column_uses(), log.reading());
    if args.json {
        print_json(&json!({
            "file": args.log,
            "reading": (!reading.is_plain()).then(|| reading.to_string()),
            "columns": columns,
        }))?;
        return Ok(Exit::Acceptable);
    }
    let rows = columns.into_iter().map(|column| {
        let (used, unit) = (used_as(&column), column.unit.unwrap_or_default());
        vec![column.name, used, unit]
    });
    print_lines(within(
        &mut table(&["column", "taken for", "unit"], rows),
        WIDTH,
    ))?;
    if !reading.is_plain() {
        print_wrapped(&format!("read as: {reading}"))?;
    }
    Ok(Exit::Acceptable)
}

fn used_as(column: &ColumnUse) -> String {
    let axes = column.axes.join(", ");
    match column.role {
        Some("temperature") => format!("temperature of {axes}"),
        Some("axis") => format!("axis {axes}"),
        Some(role) => role.to_owned(),
        None => "-".to_owned(),
    }
}
