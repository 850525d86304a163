//! Arguments that several commands share: a set and a log, and how to read a log.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use anyhow::{Error, Result};
use tempco_evaluate::TAU_RANGE_S;
use tempco_fit::summary::{LogSummary, Plan, summarise_file};
use tempco_log::{
    AxisColumn, COLUMN_UNITS, Log, Mapping, ReadOptions, Reading, TempColumn, list_names, parallel,
    read_log_observed,
};
use tempco_set::{CoefficientSet, SCALE_FACTORS_ARCSEC, check_folder, load_set, set_of_image};

use crate::image::{Placed, is_image};
use crate::output::say;
use crate::progress::Progress;

/// A set, and a log to run it over.
#[derive(clap::Args)]
pub(crate) struct SetAndLog {
    /// Coefficient set (coefficients.json) or flash image (table.bin). An image has no names of
    /// axes: it takes the axes of the log in their order
    #[arg(value_name = "SET")]
    pub(crate) set: PathBuf,
    /// Log of the unit: CSV (plain, gzip or zstd) or Parquet
    #[arg(value_name = "LOG.csv")]
    pub(crate) log: PathBuf,
    #[command(flatten)]
    pub(crate) reading: LogArgs,
}

impl SetAndLog {
    /// Reads both; pulses become angles by the scale factor of the set, unless another is given.
    pub(crate) fn read(&self) -> Result<(CoefficientSet, Log)> {
        if is_image(&self.set) {
            // Before the log, which may be long.
            check_folder(&self.set)?;
            let image = Placed::read(&self.set)?;
            let log = self.reading.read(&self.log, None)?;
            return Ok((set_for(&self.set, &image, &log)?, log));
        }
        let set = load_set(&self.set)?;
        let log = self
            .reading
            .read(&self.log, set.settings.scale_factor_arcsec)?;
        Ok((set, log))
    }
}

/// Reads a further set for a log: `coefficients.json`, or an image.
pub(crate) fn load_set_for(path: &Path, log: &Log) -> Result<CoefficientSet> {
    if is_image(path) {
        check_folder(path)?;
        set_for(path, &Placed::read(path)?, log)
    } else {
        Ok(load_set(path)?)
    }
}

fn set_for(path: &Path, image: &Placed, log: &Log) -> Result<CoefficientSet> {
    let set = set_of_image(&image.image()?, log);
    set.map_err(|reason| Error::msg(format!("{}: {reason}", path.display())))
}

/// How a result is printed.
#[derive(clap::Args)]
pub(crate) struct PrintArgs {
    /// Print every table, and every message in full
    #[arg(long)]
    pub(crate) verbose: bool,
    /// Print one JSON object, which holds everything
    #[arg(long, conflicts_with = "verbose")]
    pub(crate) json: bool,
}

/// An averaging time on the command line.
pub(crate) fn averaging_time(text: &str) -> Result<f64, String> {
    number_in(text, &TAU_RANGE_S, "seconds")
}

/// Angle per pulse on the command line.
pub(crate) fn scale_factor(text: &str) -> Result<f64, String> {
    number_in(text, &SCALE_FACTORS_ARCSEC, "arcsec per pulse")
}

fn number_in(text: &str, range: &RangeInclusive<f64>, unit: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| {
        let (least, most) = (range.start(), range.end());
        format!("expected {unit}, {least:e} to {most:e}")
    })
}

/// How to read a log whose columns are not named `time_s`, `temp_c` and `NAME_UNIT`.
#[derive(clap::Args)]
#[command(next_help_heading = "Reading logs")]
pub(crate) struct LogArgs {
    /// Column of the time, in s. Default: time_s
    #[arg(long, value_name = "COL")]
    time: Option<String>,
    /// Column of the temperature, in degC. Default: temp_c. AXIS=COL gives an axis its own; may be
    /// repeated
    #[arg(long, value_name = "[AXIS=]COL", value_parser = temp_column)]
    temp: Vec<TempColumn>,
    /// Column of an axis, with its unit. May be repeated. Without, all columns with a name such as
    /// x_dph are read
    #[arg(long, value_name = "NAME=COL:UNIT", value_parser = axis_column)]
    axis: Vec<AxisColumn>,
    /// Angle per pulse, in arcsec. Turns pulse counts into deg/h
    #[arg(long, value_name = "ARCSEC", value_parser = scale_factor, allow_negative_numbers = true)]
    pub(crate) scale_factor: Option<f64>,
    /// Leave out and count rows with bad cells. Without, such a log is refused
    #[arg(long)]
    skip_bad_rows: bool,
}

impl LogArgs {
    /// Reads a log; the scale factor of the set is used unless one was given.
    pub(crate) fn read(&self, path: &Path, set_scale_factor: Option<f64>) -> Result<Log> {
        let paths = [path.to_owned()];
        let progress = Progress::over(&paths);
        let options = self.options(set_scale_factor);
        let log = read_log_observed(path, &options, |bytes| progress.add(bytes))?;
        drop(progress);
        say_reading(
            &log.file,
            &log.reading,
            &log.ignored_columns,
            log.skipped_rows,
        );
        Ok(log)
    }

    /// Summarises several logs at once.
    pub(crate) fn summarise_all(&self, paths: &[PathBuf], plan: &Plan) -> Result<Vec<LogSummary>> {
        let progress = Progress::over(paths);
        let options = self.options(None);
        let logs = parallel::map(paths, |path| {
            summarise_file(path, &options, plan, |bytes| progress.add(bytes))
        });
        drop(progress);
        let logs = logs.into_iter().collect::<Result<Vec<_>, _>>()?;
        for log in &logs {
            let (reading, ignored) = (log.reading(), log.ignored_columns());
            say_reading(log.file(), reading, ignored, log.skipped_rows());
        }
        Ok(logs)
    }

    /// How to read; the scale factor of the set is used unless one was given.
    pub(crate) fn options(&self, set_scale_factor: Option<f64>) -> ReadOptions {
        ReadOptions {
            mapping: Mapping {
                time: self.time.clone(),
                temps: self.temp.clone(),
                axes: self.axis.clone(),
            },
            scale_factor_arcsec: self.scale_factor.or(set_scale_factor),
            skip_bad_rows: self.skip_bad_rows,
        }
    }
}

/// Says how a log was read, names the columns that were not used, and counts the rows left out.
fn say_reading(file: &str, reading: &Reading, ignored_columns: &[String], skipped_rows: usize) {
    if !reading.is_plain() {
        say!("{file}: read as: {reading}");
    }
    if !ignored_columns.is_empty() {
        say!("{file}: columns not used: {}", list_names(ignored_columns));
    }
    if skipped_rows > 0 {
        say!("{file}: {skipped_rows} bad rows left out");
    }
}

fn temp_column(text: &str) -> Result<TempColumn, String> {
    let (axis, column) = match text.split_once('=') {
        Some((axis, column)) => (Some(axis.to_owned()), column),
        None => (None, text),
    };
    Ok(TempColumn {
        axis,
        column: column.to_owned(),
    })
}

fn axis_column(text: &str) -> Result<AxisColumn, String> {
    let expected = || format!("expected NAME=COL:UNIT with UNIT one of {COLUMN_UNITS}");
    let (name, rest) = text.split_once('=').ok_or_else(expected)?;
    let (column, unit) = rest.rsplit_once(':').ok_or_else(expected)?;
    Ok(AxisColumn {
        name: name.to_owned(),
        column: column.to_owned(),
        unit: unit
            .parse()
            .map_err(|()| format!("unknown unit `{unit}`; {}", expected()))?,
    })
}
