//! `tempco apply`: a log with its bias subtracted.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, Write};
use std::ops::Range;
use std::path::PathBuf;

use anyhow::{Context, Result};
use tempco::Status;
use tempco_evaluate::judge;
use tempco_log::parallel;
use tempco_set::CoefficientSet;
use tempco_set::escape::csv_cell;
use tempco_set::files::{Draft, keep_all};
use tempco_set::run::{KnownLog, Part, apply_to_file, apply_to_log, column_names, is_rereadable};

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
        let mut output = Output::begin(draft.file(), &set);
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
        let mut output = Output::begin(draft.file(), &set);
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

/// Rows that a thread writes at a time.
const ROWS_AT_A_TIME: usize = 2048;

/// The result, row after row.
struct Output<'a> {
    to: &'a mut File,
    /// The first failure of writing.
    written: io::Result<()>,
    /// Rows with a flag in their status.
    flagged: usize,
}

impl<'a> Output<'a> {
    /// Writes the names of the columns.
    fn begin(to: &'a mut File, set: &CoefficientSet) -> Self {
        let mut header = vec!["time_s".to_owned()];
        header.extend(column_names(set).iter().map(|name| csv_cell(name)));
        header.push("status".to_owned());
        let written = csv::Writer::from_writer(&mut *to).write_record(&header);
        Self {
            to,
            written: written.map_err(io::Error::from),
            flagged: 0,
        }
    }

    /// Writes rows, unless writing failed before.
    fn rows(&mut self, part: &Part) {
        if self.written.is_ok() {
            self.written = self.write(part);
        }
    }

    /// Writes rows. Their text takes most of the time of `apply`, so all cores make it.
    fn write(&mut self, part: &Part) -> io::Result<()> {
        let rows = part.time_s.len();
        let starts: Vec<usize> = (0..rows).step_by(ROWS_AT_A_TIME).collect();
        let texts = parallel::map(&starts, |&start| {
            text_of(part, start..rows.min(start + ROWS_AT_A_TIME))
        });
        for text in texts {
            self.to.write_all(&text)?;
        }
        let statuses = part.applied.status.iter();
        self.flagged += statuses.filter(|&&status| status != Status::OK).count();
        Ok(())
    }

    /// How many rows have a flag in their status.
    fn finish(self) -> io::Result<usize> {
        self.written.map(|()| self.flagged)
    }
}

/// Some rows of a part as text.
fn text_of(part: &Part, rows: Range<usize>) -> Vec<u8> {
    let (mut text, applied) = (Vec::new(), &part.applied);
    // The status of the row before, and what it is called.
    let (mut former, mut status_name) = (Status::OK, status_text(Status::OK));
    for row in rows {
        push_number(&mut text, part.time_s[row]);
        for input in &part.inputs {
            text.push(b',');
            push_number(&mut text, input.temp_c[row]);
        }
        for axis in &applied.axes {
            for value in [axis.raw[row], axis.bias[row], axis.compensated[row]] {
                text.push(b',');
                push_number(&mut text, value);
            }
        }
        let status = applied.status[row];
        if status != former {
            (former, status_name) = (status, status_text(status));
        }
        text.push(b',');
        text.extend_from_slice(status_name.as_bytes());
        text.push(b'\n');
    }
    text
}

/// Appends the shortest number that reads back as the same, without exponent. The standard formatting
/// takes several times as long.
fn push_number<T: zmij::Float + Display>(text: &mut Vec<u8>, value: T) {
    let mut buffer = zmij::Buffer::new();
    match buffer.format(value).as_bytes() {
        number if number.contains(&b'e') => {
            text.extend_from_slice(value.to_string().as_bytes());
        }
        [number @ .., b'.', b'0'] | number => text.extend_from_slice(number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text<T: zmij::Float + Display>(value: T) -> String {
        let mut text = Vec::new();
        push_number(&mut text, value);
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn numbers_read_back_as_they_were_and_are_as_short_as_the_standard_formatting() {
        let mut bits = 1_u64;
        for _ in 0..300_000 {
            bits = bits
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let (long, short) = (f64::from_bits(bits), f32::from_bits((bits >> 32) as u32));
            // Of usual size, too.
            let usual = (bits >> 40) as f32 * 1e-4 - 800.0;
            if !long.is_nan() {
                assert_eq!(text(long).parse(), Ok(long));
                assert_eq!(text(long).len(), long.to_string().len());
            }
            for short in [short, usual].into_iter().filter(|value| !value.is_nan()) {
                assert_eq!(text(short).parse(), Ok(short));
                assert_eq!(text(short).len(), short.to_string().len());
            }
        }
        for value in [0.0, -0.0, 1.0, -25.0, 1e16, 1e-7, f32::NAN] {
            assert_eq!(text(value), value.to_string());
        }
    }
}
