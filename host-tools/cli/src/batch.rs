//! `tempco fit --batch`: a set for every unit of a folder, and a summary of all.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail, ensure};
use tempco_fit::batch::{
    AxisResult, Outcome, SUMMARY_FILES, Summary, UnitLogs, UnitResult, check_serial, find_units,
};
use tempco_fit::{FitOptions, Plan};
use tempco_log::{ReadOptions, parallel};
use tempco_report::{Calibration, batch_page};
use tempco_set::WarningCode;
use tempco_set::files::write_files;
use tempco_set::run::is_rereadable;

use crate::Exit;
use crate::judgement::say_rejections;
use crate::output::{WIDTH, percent, print, print_lines, print_wrapped, say, table, within};
use crate::progress::Progress;
use crate::report::{reading_again, rows_of};
use crate::shared_args::summary_of;

/// Fits every unit found in `folder`; the serial number in `options` is replaced by the unit's.
pub(crate) fn run(
    folder: &Path,
    out: &Path,
    reading: &ReadOptions,
    options: &FitOptions,
    with_report: bool,
) -> Result<Exit> {
    // Options that no unit can be fitted with.
    let plan = Plan::new(options.plan.clone())?;
    let units = find_units(folder, out)?;
    let progress = Progress::over(units.iter().flat_map(|unit| &unit.logs));
    let outcomes = parallel::map(&units, |unit| Outcome {
        serial: unit.serial.clone(),
        logs: unit.logs.len(),
        result: caught(|| {
            check_serial(&unit.serial, &units)?;
            fit_unit(unit, out, (reading, &plan, options), with_report, &progress)
        })
        .map_err(|error| format!("{error:#}")),
    });
    drop(progress);
    let summary = Summary::new(outcomes);
    let (csv, html) = (summary.csv(), batch_page(&summary, with_report)?);
    let [csv_name, html_name] = SUMMARY_FILES;
    let files = [(csv_name, &csv[..]), (html_name, html.as_bytes())];
    write_files(out, &files).context("the summary was not written")?;
    show(&summary)?;
    print(format_args!(
        "wrote the sets and {} and {}",
        out.join(csv_name).display(),
        out.join(html_name).display()
    ))?;
    Ok(Exit::of(summary.is_acceptable()))
}

/// A fault of this program in the work on one unit must not stop the others.
fn caught<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|cause| {
        let text = cause.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| cause.downcast_ref::<&str>().copied());
        Err(anyhow!(
            "a fault of tempco, please report it: {}",
            text.unwrap_or("without a message")
        ))
    })
}

/// Reads, fits and writes one unit: all its files or none.
fn fit_unit(
    unit: &UnitLogs,
    out: &Path,
    (reading, plan, options): (&ReadOptions, &Plan, &FitOptions),
    with_report: bool,
    progress: &Progress,
) -> Result<UnitResult> {
    ensure!(
        !unit.logs.is_empty(),
        "no log in its folder: expected .csv, .csv.gz, .csv.zst, .parquet, .ulg, .bin or .summary"
    );
    // A pipe that nobody writes to would block without end.
    let other = unit
        .logs
        .iter()
        .find(|path| path.exists() && !is_rereadable(path));
    if let Some(other) = other {
        bail!("{}: expected a regular file", other.display());
    }
    let options = FitOptions {
        serial: unit.serial.clone(),
        ..options.clone()
    };
    let logs = unit
        .logs
        .iter()
        .map(|path| summary_of(path, reading, plan, |bytes| progress.add(bytes)))
        .collect::<Result<Vec<_>, _>>()?;
    for log in logs.iter().filter(|log| !log.reading().is_plain()) {
        say!(
            "unit {}: {}: read as: {}",
            unit.serial,
            log.file(),
            log.reading()
        );
    }
    let rows = rows_of(&unit.logs);
    let rows = Some(&rows[..]).filter(|_| with_report);
    let observer = reading_again(&unit.logs);
    let calibration = Calibration::new(&logs, &options, rows, reading, observer)?;
    let folder = out.join(&unit.serial);
    calibration.write(&folder).context("nothing was written")?;
    Ok(UnitResult::new(&calibration.fit.set, calibration.judgement))
}

/// A row for each unit, with its worst axis.
fn show(summary: &Summary) -> Result<()> {
    let header = ["serial", "verdict", "outlier", "worst axis", "improvement"];
    let units = summary.units().iter().enumerate();
    let rows = units.map(|(number, unit)| {
        let outlier = if summary.is_outlier(number) {
            "yes"
        } else {
            ""
        };
        let worst = unit.result.as_ref().ok().and_then(UnitResult::worst_axis);
        vec![
            unit.serial.clone(),
            summary.verdict(number).to_owned(),
            outlier.to_owned(),
            worst.map_or_else(String::new, |axis| axis.axis.clone()),
            worst
                .and_then(AxisResult::improvement)
                .map_or_else(String::new, percent),
        ]
    });
    print_lines(within(&mut table(&header, rows), WIDTH))?;
    for unit in summary.units() {
        match &unit.result {
            Err(error) => say!("unit {}: {error}", unit.serial),
            Ok(figures) => {
                say_rejections(format_args!("unit {}:", unit.serial), &figures.judgement);
            }
        }
    }
    show_warnings(summary)
}

/// Each code once, with the units that it is of; the summary has the messages.
fn show_warnings(summary: &Summary) -> Result<()> {
    for code in WarningCode::ALL {
        let warned = |unit: &&Outcome| {
            let figures = unit.result.as_ref();
            figures.is_ok_and(|of| of.judgement.warnings.iter().any(|of| of.code == *code))
        };
        let units = summary.units().iter().filter(warned);
        let serials: Vec<&str> = units.map(|unit| unit.serial.as_str()).collect();
        if !serials.is_empty() {
            let (code, count) = (code.name(), serials.len());
            let units = if count == 1 { "unit" } else { "units" };
            print_wrapped(&format!(
                "warning {code}: {count} {units}: {}",
                serials.join(", ")
            ))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_of_its_unit() {
        let whole = caught(|| Ok(7));
        assert_eq!(whole.unwrap(), 7);
        let text = |error: anyhow::Error| format!("{error:#}");
        let refused = caught(|| -> Result<()> { bail!("refused") });
        assert_eq!(text(refused.unwrap_err()), "refused");
        for index in [3, 4] {
            let fault = caught(|| Ok([1, 2, 3][index]));
            let message = text(fault.unwrap_err());
            assert!(message.contains("but the index is"), "{message}");
        }
        let fixed = caught(|| -> Result<()> { panic!("fixed") });
        assert!(text(fixed.unwrap_err()).ends_with("please report it: fixed"));
    }
}
