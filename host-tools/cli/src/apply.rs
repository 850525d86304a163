//! `tempco apply`: a log with its bias subtracted.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use anyhow::{Context, Result};
use tempco::Status;
use tempco_evaluate::judge;
use tempco_set::CoefficientSet;
use tempco_set::escape::csv_cell;
use tempco_set::files::{Draft, keep_all};
use tempco_set::run::{
    Applied, ChannelInputs, KnownLog, apply, apply_to_file, inputs, is_rereadable,
};

use crate::Exit;
use crate::judgement::say_rejections;
use crate::output::print;
use crate::progress::Progress;
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
    let (set_path, path) = (&args.put.set, &args.put.log);
    let at_out = || args.out.display().to_string();
    let mut draft;
    let (rows, flagged) = if is_rereadable(path) {
        // The interval must be known first, so the log is read twice: no row is kept in memory.
        let (set, (survey, options)) = args.put.survey()?;
        say_rejections(set_path.display(), &judge(&set, None));
        draft = Draft::create(&args.out)?;
        let mut output = Output::begin(draft.file(), &set).with_context(at_out)?;
        let log = KnownLog {
            path: path.clone(),
            interval_s: survey.head.interval_s,
            sha256: survey.head.sha256,
        };
        let progress = Progress::over([path]);
        let (mut shown, mut written) = (0, Ok(()));
        apply_to_file(&set, &log, &options, |time_s, inputs, applied, bytes| {
            if written.is_ok() {
                written = output.rows(time_s, inputs, applied);
            }
            progress.add(bytes - shown);
            shown = bytes;
        })?;
        drop(progress);
        let flagged = written.and_then(|()| output.finish());
        (survey.rows, flagged.with_context(at_out)?)
    } else {
        let (set, log) = args.put.read()?;
        say_rejections(set_path.display(), &judge(&set, None));
        let (inputs, applied) = (inputs(&set, &log)?, apply(&set, &log)?);
        draft = Draft::create(&args.out)?;
        let mut output = Output::begin(draft.file(), &set).with_context(at_out)?;
        let written = output.rows(&log.time_s, &inputs, &applied);
        let flagged = written.and_then(|()| output.finish());
        (log.rows(), flagged.with_context(at_out)?)
    };
    keep_all(vec![draft])?;
    print(format_args!(
        "{rows} rows, {flagged} with a flag in their status; wrote {}",
        args.out.display()
    ))?;
    Ok(Exit::Acceptable)
}

/// The result, row after row.
struct Output<'a> {
    to: BufWriter<&'a mut File>,
    /// Rows with a flag in their status.
    flagged: usize,
}

impl<'a> Output<'a> {
    /// Writes the names of the columns.
    fn begin(file: &'a mut File, set: &CoefficientSet) -> io::Result<Self> {
        let mut header = vec!["time_s".to_owned()];
        let temperatures = set.channels.iter().map(|of| csv_cell(&of.temperature));
        header.extend(temperatures);
        for (_, axis) in set.axes() {
            for what in ["raw", "bias", "compensated"] {
                let name = format!("{}_{what}_{}", axis.name, axis.unit.name());
                header.push(csv_cell(&name));
            }
        }
        header.push("status".to_owned());
        let mut to = BufWriter::new(file);
        csv::Writer::from_writer(&mut to).write_record(&header)?;
        Ok(Self { to, flagged: 0 })
    }

    fn rows(
        &mut self,
        time_s: &[f64],
        inputs: &[ChannelInputs],
        applied: &Applied,
    ) -> io::Result<()> {
        let out = &mut self.to;
        for (row, time_s) in time_s.iter().enumerate() {
            write!(out, "{time_s}")?;
            for input in inputs {
                write!(out, ",{}", input.temp_c[row])?;
            }
            for axis in &applied.axes {
                let (raw, bias) = (axis.raw[row], axis.bias[row]);
                write!(out, ",{raw},{bias},{}", axis.compensated[row])?;
            }
            let status = applied.status[row];
            writeln!(out, ",{}", status_text(status))?;
            self.flagged += usize::from(status != Status::OK);
        }
        Ok(())
    }

    /// How many rows have a flag in their status.
    fn finish(mut self) -> io::Result<usize> {
        self.to.flush()?;
        Ok(self.flagged)
    }
}
