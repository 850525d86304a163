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
use tempco_set::run::{KnownLog, Part, apply_to_file, apply_to_log, is_rereadable};

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
        let log = KnownLog::new(path, &survey.head);
        let progress = Progress::over([path]);
        let observer = |bytes| progress.add(bytes);
        apply_to_file(&set, None, &log, &options, observer, |part| {
            output.rows(&part)
        })?;
        drop(progress);
        (survey.rows, output.finish().with_context(at_out)?)
    } else {
        let (set, log) = args.put.read()?;
        say_rejections(set_path.display(), &judge(&set, None));
        draft = Draft::create(&args.out)?;
        let mut output = Output::begin(draft.file(), &set).with_context(at_out)?;
        apply_to_log(&set, None, &log, |part| output.rows(&part))?;
        (log.rows(), output.finish().with_context(at_out)?)
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
    /// The first failure of writing.
    written: io::Result<()>,
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
        Ok(Self {
            to,
            written: Ok(()),
            flagged: 0,
        })
    }

    /// Writes rows, unless writing failed before.
    fn rows(&mut self, part: &Part) {
        if self.written.is_ok() {
            self.written = self.write(part);
        }
    }

    fn write(&mut self, part: &Part) -> io::Result<()> {
        let (out, applied) = (&mut self.to, &part.applied);
        for (row, time_s) in part.time_s.iter().enumerate() {
            write!(out, "{time_s}")?;
            for input in &part.inputs {
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
        self.written?;
        self.to.flush()?;
        Ok(self.flagged)
    }
}
