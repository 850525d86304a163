//! Coefficient sets: fitted, judged, applied, written.

use std::path::PathBuf;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde::Serialize;
use tempco_evaluate::{evaluate, judge};
use tempco_fit::FitOptions;
use tempco_fit::summary::LogSummary;
use tempco_log::AxisUnit;
use tempco_report::{Calibration, Rows};
use tempco_set::parameters::{self, Autopilot, export_parameters};
use tempco_set::run::{apply_to_log, column_names};
use tempco_set::{
    CoefficientSet, Judged, Judgement, load_set, table_bin, table_h, table_rs, write_set,
};

use crate::errors::{FitError, SetError, of_calibration, of_evaluation, of_set, work};
use crate::log::Log;
use crate::options::{Reading, method};
use crate::summary::Summary;

/// A coefficient set, with the verdict on it.
#[pyclass(frozen, module = "tempco")]
pub(crate) struct Set {
    set: CoefficientSet,
    judgement: Judgement,
    /// The report of its fit, if that was asked for.
    report: Option<String>,
}

/// Fits a set to summaries. `rows` has the log of each, for the report.
#[pyfunction]
#[pyo3(signature = (summaries, rows, reading, serial, model, overlap, segments, report))]
#[expect(clippy::too_many_arguments, reason = "Python passes them by name")]
pub(crate) fn fit(
    py: Python,
    summaries: Vec<Py<Summary>>,
    rows: Vec<Option<RowsOf>>,
    reading: Reading,
    serial: String,
    model: &str,
    overlap: &str,
    segments: Option<&str>,
    report: bool,
) -> PyResult<Set> {
    let reading = reading.options()?;
    let logs: Vec<LogSummary> = summaries
        .iter()
        .map(|of| of.get().summary.clone())
        .collect();
    let Some(first) = logs.first() else {
        return Err(FitError::new_err("no logs: expected one or more"));
    };
    let options = FitOptions {
        serial,
        method: method(model, overlap, segments)?,
        plan: first.plan().options().clone(),
    };
    let calibration = work(py, || {
        let rows: Vec<Rows> = rows.iter().map(RowsOf::rows).collect();
        let rows = Some(&rows[..]).filter(|_| report);
        Calibration::new(&logs, &options, rows, &reading, |_| ()).map_err(of_calibration)
    })?;
    Ok(Set {
        set: calibration.fit.set,
        judgement: calibration.judgement,
        report: calibration.report.map(|report| report.html),
    })
}

/// Where the rows of a log are.
#[derive(FromPyObject)]
pub(crate) enum RowsOf {
    Log(Py<Log>),
    File(PathBuf),
}

impl RowsOf {
    fn rows(of: &Option<Self>) -> Rows<'_> {
        match of {
            Some(Self::Log(log)) => Rows::Log(&log.get().log),
            Some(Self::File(path)) => Rows::File(path),
            None => Rows::None,
        }
    }
}

/// Reads a set from `coefficients.json`.
#[pyfunction]
pub(crate) fn load(py: Python, path: PathBuf) -> PyResult<Set> {
    let set = work(py, || load_set(&path).map_err(of_set))?;
    Ok(Set {
        judgement: judge(&set, None),
        set,
        report: None,
    })
}

/// What an axis loses: name and unit, range at rest, largest and RMS difference, rate and history.
type LossFields = ((String, &'static str), f64, (f64, f64), f64);

/// Makes a set of the parameters of an autopilot.
#[pyfunction]
pub(crate) fn import_parameters(
    py: Python,
    path: PathBuf,
    from: &str,
    instance: Option<u32>,
    unit: &str,
    serial: &str,
) -> PyResult<Set> {
    let autopilot = autopilot(from)?;
    let instance = instance.unwrap_or(*autopilot.instances().start());
    let units = [AxisUnit::Dph, AxisUnit::Dps, AxisUnit::Radps];
    let found = units.into_iter().find(|known| known.name() == unit);
    let Some(unit) = found else {
        let message = format!("unit `{unit}`: expected dph, dps or radps");
        return Err(SetError::new_err(message));
    };
    let imported = work(py, || {
        parameters::import_parameters(&path, autopilot, instance, unit, serial).map_err(of_set)
    })?;
    Ok(Set {
        judgement: judge(&imported.set, None),
        set: imported.set,
        report: None,
    })
}

fn autopilot(name: &str) -> PyResult<Autopilot> {
    match name {
        "px4" => Ok(Autopilot::Px4),
        "ardupilot" => Ok(Autopilot::ArduPilot),
        other => Err(SetError::new_err(format!(
            "`{other}`: expected px4 or ardupilot"
        ))),
    }
}

#[pymethods]
impl Set {
    /// Serial number of the unit.
    #[getter]
    fn serial(&self) -> &str {
        &self.set.serial
    }

    /// CRC-32 of the table, in hexadecimal: the same table has the same, however it was made.
    #[getter]
    fn table_crc32(&self) -> &str {
        &self.set.table_crc32
    }

    /// The verdict, what rejects the set and what warns of it, as JSON.
    fn judgement_json(&self) -> PyResult<String> {
        json(&self.judgement)
    }

    /// The whole set as JSON: the text of coefficients.json.
    fn to_json(&self) -> String {
        self.set.to_json()
    }

    /// The table as a Rust constant.
    fn table_rs(&self) -> String {
        table_rs(&self.set)
    }

    /// The table as a C header.
    fn table_h(&self) -> String {
        table_h(&self.set)
    }

    /// The table as a flash image.
    fn table_bin<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let image = table_bin(&self.set).map_err(SetError::new_err)?;
        Ok(PyBytes::new(py, &image))
    }

    /// The report of the fit as HTML; None if it was not asked for.
    #[getter]
    fn report(&self) -> Option<&str> {
        self.report.as_deref()
    }

    /// Writes the files of the set into a folder, all or none.
    fn save(&self, py: Python, folder: PathBuf) -> PyResult<()> {
        work(py, || {
            write_set(&folder, &self.set, self.report.as_deref()).map_err(of_set)
        })
    }

    /// Names, units and temperatures of the axes.
    #[getter]
    fn axes(&self) -> Vec<(&str, &str, &str)> {
        let axes = self.set.axes();
        axes.map(|(channel, axis)| {
            let temperature = &self.set.channels[channel].temperature;
            (&axis.name[..], axis.unit.name(), &temperature[..])
        })
        .collect()
    }

    /// The set as parameters of an autopilot: their text, and for each axis its name, its unit, the range
    /// of its bias at rest, how far the cubic is off at most and as RMS, and what rate and history add.
    fn export(
        &self,
        to: &str,
        instance: Option<u32>,
        device_id: i32,
    ) -> PyResult<(String, Vec<LossFields>)> {
        let autopilot = autopilot(to)?;
        let instance = instance.unwrap_or(*autopilot.instances().start());
        let exported = export_parameters(&self.set, autopilot, instance, device_id)
            .map_err(SetError::new_err)?;
        let losses = exported.losses.into_iter().map(|of| {
            let (static_range, cubic) = (of.static_range, (of.largest, of.rms));
            let axis = (of.axis, of.unit.name());
            (axis, static_range, cubic, of.rate_and_history)
        });
        Ok((exported.text, losses.collect()))
    }

    /// Runs the core over a log. Returns the columns that `tempco apply` writes, and status as flags.
    fn apply<'py>(&self, py: Python<'py>, log: Py<Log>) -> PyResult<Bound<'py, PyDict>> {
        let log = &log.get().log;
        let columns = work(py, || self.columns(log).map_err(of_set))?;
        let result = PyDict::new(py);
        result.set_item("time_s", PyArray1::from_slice(py, &log.time_s))?;
        for (name, values) in columns.values {
            result.set_item(name, PyArray1::from_vec(py, values))?;
        }
        result.set_item("status", PyArray1::from_vec(py, columns.status))?;
        Ok(result)
    }

    /// Judges the set on a log: figures, verdict and reasons as JSON.
    fn evaluate_json(
        &self,
        py: Python,
        log: Py<Log>,
        against: Option<Py<Set>>,
        tau_s: f64,
    ) -> PyResult<String> {
        let log = &log.get().log;
        let against = against.as_ref().map(|other| &other.get().set);
        work(py, || {
            let evaluation = evaluate(&self.set, log, against, tau_s).map_err(of_evaluation)?;
            json(&Judged {
                of: &evaluation,
                judgement: &judge(&self.set, Some(&evaluation)),
            })
        })
    }
}

/// The columns of a compensated log.
struct Columns {
    values: Vec<(String, Vec<f32>)>,
    status: Vec<u16>,
}

impl Set {
    fn columns(&self, log: &tempco_log::Log) -> Result<Columns, tempco_set::run::ApplyError> {
        let names = column_names(&self.set).into_iter();
        let mut columns = Columns {
            values: names
                .map(|name| (name, Vec::with_capacity(log.rows())))
                .collect(),
            status: Vec::with_capacity(log.rows()),
        };
        apply_to_log(&self.set, None, log, |part| {
            let temps_c = part.inputs.iter().map(|input| input.temp_c);
            let axes = part.applied.axes.iter();
            let axes = axes.flat_map(|of| [&of.raw[..], &of.bias, &of.compensated]);
            for ((_, column), values) in columns.values.iter_mut().zip(temps_c.chain(axes)) {
                column.extend_from_slice(values);
            }
            columns
                .status
                .extend(part.applied.status.iter().map(|status| status.bits()));
        })?;
        Ok(columns)
    }
}

fn json(of: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(of).map_err(of_set)
}
