//! Logs.

use std::path::PathBuf;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use tempco_log::{Axis, Channel, Frame, read_frame, read_log};

use crate::errors::{of_log, work};
use crate::options::Reading;

/// A log whose every value was checked on reading; its rows are in memory.
#[pyclass(frozen, module = "tempco")]
pub(crate) struct Log {
    pub(crate) log: tempco_log::Log,
    /// Angle per pulse that it was read with [arcsec].
    pub(crate) scale_factor_arcsec: Option<f64>,
}

#[pymethods]
impl Log {
    /// Reads a file.
    #[staticmethod]
    fn of_file(py: Python, path: PathBuf, reading: Reading) -> PyResult<Self> {
        let options = reading.options()?;
        let log = work(py, || read_log(&path, &options).map_err(of_log))?;
        Ok(Self {
            log,
            scale_factor_arcsec: options.scale_factor_arcsec,
        })
    }

    /// Takes columns, by their names.
    #[staticmethod]
    fn of_columns(
        py: Python,
        name: String,
        columns: Vec<(String, PyReadonlyArray1<f64>)>,
        reading: Reading,
    ) -> PyResult<Self> {
        let options = reading.options()?;
        let columns = columns.iter().map(|(name, values)| {
            let values = values.as_array();
            (name.clone(), values.iter().copied().collect())
        });
        let frame = Frame {
            name,
            columns: columns.collect(),
        };
        let log = work(py, || read_frame(frame, &options).map_err(of_log))?;
        Ok(Self {
            log,
            scale_factor_arcsec: options.scale_factor_arcsec,
        })
    }

    /// Name of the file, or what the columns were called.
    #[getter]
    fn name(&self) -> &str {
        &self.log.file
    }

    /// SHA-256 of the file, or of the columns, in hexadecimal.
    #[getter]
    fn sha256(&self) -> &str {
        &self.log.sha256
    }

    /// Number of rows.
    fn __len__(&self) -> usize {
        self.log.rows()
    }

    /// Median time between rows [s].
    #[getter]
    fn interval_s(&self) -> f64 {
        self.log.interval_s
    }

    /// For each axis its name, its unit, and the name of its temperature.
    #[getter]
    fn axes(&self) -> Vec<(&str, &str, &str)> {
        let axes = self.axes_of_channels();
        axes.map(|(channel, axis)| (&axis.name[..], axis.unit.name(), &channel.column[..]))
            .collect()
    }

    /// How it was read, where it is not a plain log; what must be judged of that; bad rows left out.
    #[getter]
    fn notes(&self) -> Vec<String> {
        let log = &self.log;
        let mut notes = Vec::new();
        if !log.reading.is_plain() {
            notes.push(format!("read as: {}", log.reading));
        }
        if !log.ignored_columns.is_empty() {
            notes.push(format!(
                "columns not used: {}",
                tempco_log::list_names(&log.ignored_columns)
            ));
        }
        let skipped = log.skipped_rows;
        if skipped.total() > 0 {
            notes.push(format!("{} bad rows left out: {skipped}", skipped.total()));
        }
        notes
    }

    /// Time of each row [s]: f64 of shape (rows,).
    fn time_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.log.time_s)
    }

    /// Temperature of each row for an axis [degC], as the core sees it: f32 of shape (rows,).
    fn temp_c<'py>(&self, py: Python<'py>, axis: &str) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let (channel, _) = self.axis(axis)?;
        Ok(PyArray1::from_slice(py, &channel.temp_c))
    }

    /// Value of an axis in each row [its unit]: f64 of shape (rows,).
    fn raw<'py>(&self, py: Python<'py>, axis: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (_, axis) = self.axis(axis)?;
        Ok(PyArray1::from_slice(py, &axis.raw))
    }
}

impl Log {
    fn axes_of_channels(&self) -> impl Iterator<Item = (&Channel, &Axis)> {
        let channels = self.log.channels.iter();
        channels.flat_map(|channel| channel.axes.iter().map(move |axis| (channel, axis)))
    }

    fn axis(&self, name: &str) -> PyResult<(&Channel, &Axis)> {
        let mut axes = self.axes_of_channels();
        axes.find(|(_, axis)| axis.name == name)
            .ok_or_else(|| PyKeyError::new_err(format!("no axis `{name}`")))
    }
}
