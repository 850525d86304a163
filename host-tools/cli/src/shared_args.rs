//! Arguments that several commands share: a set and a log, and how to read a log.

use std::collections::BTreeSet;
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use anyhow::{Context, Error, Result, bail};
use tempco_evaluate::TAU_RANGE_S;
use tempco_fit::Plan;
use tempco_fit::summary::{LogSummary, is_summary, read_summary, summarise_file};
use tempco_log::{
    Log, LogError, Mapping, ReadOptions, Reading, SkippedRows, Survey, list_names, parallel,
    read_log_observed, survey_log_observed,
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
    /// Log of the unit: CSV (plain, gzip or zstd), Parquet, ULog (.ulg) or DataFlash (.bin)
    #[arg(value_name = "LOG.csv")]
    pub(crate) log: PathBuf,
    #[command(flatten)]
    pub(crate) reading: LogArgs,
}

impl SetAndLog {
    /// Reads both; pulses become angles by the scale factor of the set, unless another is given.
    pub(crate) fn read(&self) -> Result<(CoefficientSet, Log)> {
        self.both(|set| self.reading.read(&self.log, set), |log| log)
    }

    /// The same, without keeping the rows; also says how to read these.
    pub(crate) fn survey(&self) -> Result<(CoefficientSet, (Survey, ReadOptions))> {
        self.both(
            |set| self.reading.survey(&self.log, set),
            |(survey, _)| &survey.head,
        )
    }

    /// Reads the set, then the log.
    fn both<T>(
        &self,
        read: impl FnOnce(Option<&CoefficientSet>) -> Result<T>,
        log: impl FnOnce(&T) -> &Log,
    ) -> Result<(CoefficientSet, T)> {
        if is_image(&self.set) {
            // Before the log, which may be long.
            check_folder(&self.set)?;
            let image = Placed::read(&self.set)?;
            let of_log = read(None)?;
            return Ok((set_for(&self.set, &image, log(&of_log))?, of_log));
        }
        let set = load_set(&self.set)?;
        let of_log = read(Some(&set))?;
        Ok((set, of_log))
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
    /// Column of the time. Default: time_s, or a name with its unit such as "Time [ms]". UNIT is s,
    /// ms, us, ns, iso (clock times), or 100hz (a counter); without, it is in the name, or s
    #[arg(long, value_name = "COL[:UNIT]")]
    time: Option<String>,
    /// Column of the temperature. AXIS=COL gives an axis its own; may be repeated. Default: temp_c.
    /// UNIT is degc, degf or k; without, it is in the name, or degc
    #[arg(long, value_name = "[AXIS=]COL[*SCALE][+OFFSET][:UNIT]")]
    temp: Vec<String>,
    /// Column of an axis, with its unit after scale and offset. May be repeated. Without, all columns
    /// with a name such as x_dph or "Gyro X [deg/s]" are read
    #[arg(long, value_name = "NAME=COL[*SCALE][+OFFSET]:UNIT")]
    axis: Vec<String>,
    /// Read only the rows that have this in a column. May be repeated
    #[arg(long = "where", value_name = "COL=VALUE")]
    filter: Vec<String>,
    /// Read only this instance of the sensor, of a log of PX4 or ArduPilot. Without, fit makes a set
    /// of each; others read the one that the set was fitted to
    #[arg(long, value_name = "N")]
    instance: Option<u32>,
    /// Log with the temperatures, joined by time. The last one is held, for 10 s at most
    #[arg(long, value_name = "FILE")]
    join: Option<PathBuf>,
    /// TOML file with these options: time = "...", temp = ["..."], axis = ["..."], where = ["..."],
    /// instance = 0, join = "..."
    #[arg(long, value_name = "FILE.toml")]
    map: Option<PathBuf>,
    /// Angle per pulse, in arcsec. Turns pulse counts into deg/h
    #[arg(long, value_name = "ARCSEC", value_parser = scale_factor, allow_negative_numbers = true)]
    pub(crate) scale_factor: Option<f64>,
    /// Leave out and count rows with bad cells. Without, such a log is refused
    #[arg(long)]
    skip_bad_rows: bool,
}

impl LogArgs {
    /// Reads a log. What is not given is as kept in the set, where the columns of the log fit.
    pub(crate) fn read(&self, path: &Path, set: Option<&CoefficientSet>) -> Result<Log> {
        let paths = [path.to_owned()];
        let progress = Progress::over(&paths);
        let options = self.options(set)?;
        let log = read_log_observed(path, &options, |bytes| progress.add(bytes))?;
        drop(progress);
        Self::check(path, &options, &log, set)?;
        Ok(log)
    }

    /// Reads a log as [`read`](Self::read) does, without keeping its rows.
    fn survey(&self, path: &Path, set: Option<&CoefficientSet>) -> Result<(Survey, ReadOptions)> {
        let paths = [path.to_owned()];
        let progress = Progress::over(&paths);
        let options = self.options(set)?;
        let survey = survey_log_observed(path, &options, |bytes| progress.add(bytes))?;
        drop(progress);
        Self::check(path, &options, &survey.head, set)?;
        Ok((survey, options))
    }

    /// Says how a log was read.
    ///
    /// # Errors
    /// A log that lacks the temperatures of another file.
    fn check(
        path: &Path,
        options: &ReadOptions,
        log: &Log,
        set: Option<&CoefficientSet>,
    ) -> Result<()> {
        let joined = log.reading.mapping.as_ref();
        let joined = joined.and_then(|mapping| mapping.join.as_ref());
        let inputs = set.map_or(&[][..], |set| &set.provenance.inputs);
        let is_fitted = inputs.iter().any(|input| input.sha256 == log.sha256);
        if let (Some(joined), None, false) = (joined, &options.mapping.join, is_fitted) {
            bail!(
                "{}: the set was fitted with temperatures of {joined}: expected --join FILE, with \
                 those of this log",
                path.display()
            );
        }
        say_reading(
            &log.file,
            &log.reading,
            &log.ignored_columns,
            log.skipped_rows,
        );
        Ok(())
    }

    /// Summarises several logs at once.
    ///
    /// # Errors
    /// What is wrong with a log. Logs with several sources are no error: their numbers are returned.
    pub(crate) fn summarise_all(
        paths: &[PathBuf],
        options: &ReadOptions,
        plan: &Plan,
    ) -> Result<Summaries> {
        let progress = Progress::over(paths);
        let logs = parallel::map(paths, |path| {
            summary_of(path, options, plan, |bytes| progress.add(bytes))
        });
        drop(progress);
        let mut instances = BTreeSet::new();
        for log in &logs {
            let error = log.as_ref().err().and_then(Error::downcast_ref);
            if let Some(LogError::Sources {
                instances: of_log, ..
            }) = error
            {
                instances.extend(of_log);
            }
        }
        if !instances.is_empty() {
            return Ok(Summaries::OfInstances(instances));
        }
        let logs = logs.into_iter().collect::<Result<Vec<_>, _>>()?;
        for log in &logs {
            let (reading, ignored) = (log.reading(), log.ignored_columns());
            say_reading(log.file(), reading, ignored, log.skipped_rows());
        }
        Ok(Summaries::Of(logs))
    }

    /// An option that was given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let options = [
            ("--time", self.time.is_some()),
            ("--temp", !self.temp.is_empty()),
            ("--axis", !self.axis.is_empty()),
            ("--where", !self.filter.is_empty()),
            ("--instance", self.instance.is_some()),
            ("--join", self.join.is_some()),
            ("--map", self.map.is_some()),
            ("--scale-factor", self.scale_factor.is_some()),
            ("--skip-bad-rows", self.skip_bad_rows),
        ];
        let given = options.iter().find(|(_, is_given)| *is_given);
        given.map(|(option, _)| *option)
    }

    /// How to read; what is not given is as kept in the set.
    ///
    /// # Errors
    /// A file of a mapping that cannot be read.
    pub(crate) fn options(&self, set: Option<&CoefficientSet>) -> Result<ReadOptions> {
        let given = Mapping {
            time: self.time.clone(),
            temp: self.temp.clone(),
            axis: self.axis.clone(),
            filter: self.filter.clone(),
            instance: self.instance,
            join: self.join.as_ref().map(|path| path.display().to_string()),
        };
        let mapping = match &self.map {
            Some(path) => given.or(&mapping_file(path)?),
            None => given,
        };
        let inputs = set.map_or(&[][..], |set| &set.provenance.inputs);
        let kept = inputs.iter().filter_map(|input| input.mapping.clone());
        let of_set = set.and_then(|set| set.settings.scale_factor_arcsec);
        Ok(ReadOptions {
            mapping,
            kept: kept.collect(),
            scale_factor_arcsec: self.scale_factor.or(of_set),
            skip_bad_rows: self.skip_bad_rows,
        })
    }
}

/// The summary of a log, or the one that a file holds; tells `observer` how many more bytes were read.
///
/// # Errors
/// What is wrong with the file.
pub(crate) fn summary_of(
    path: &Path,
    options: &ReadOptions,
    plan: &Plan,
    mut observer: impl FnMut(u64),
) -> Result<LogSummary> {
    if is_summary(path) {
        let summary = read_summary(path)?;
        observer(fs::metadata(path).map_or(0, |metadata| metadata.len()));
        return Ok(summary);
    }
    Ok(summarise_file(path, options, plan, observer)?)
}

/// What logs were summarised to.
pub(crate) enum Summaries {
    Of(Vec<LogSummary>),
    /// Nothing yet: the rows of these sources are in the logs.
    OfInstances(BTreeSet<u32>),
}

fn mapping_file(path: &Path) -> Result<Mapping> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    toml::from_str(&text).with_context(|| {
        format!(
            "{}: expected time = \"...\", temp = [\"...\"], axis = [\"...\"], where = [\"...\"] or \
             join = \"...\"",
            path.display()
        )
    })
}

/// Says how a log was read, names the columns that were not used, and counts the rows left out.
pub(crate) fn say_reading(
    file: &str,
    reading: &Reading,
    ignored_columns: &[String],
    skipped_rows: SkippedRows,
) {
    if !reading.is_plain() {
        say!("{file}: read as: {reading}");
    }
    if !ignored_columns.is_empty() {
        say!("{file}: columns not used: {}", list_names(ignored_columns));
    }
    let total = skipped_rows.total();
    if total > 0 {
        say!("{file}: {total} bad rows left out: {skipped_rows}");
    }
}
