//! Summaries of logs: all that a fit needs of them.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use tempco_fit::summary::{LogSummary, read_summary, summarise_file, summarise_log};

use crate::errors::{LogError, of_log, work};
use crate::log::Log;
use crate::options::{PlanFields, Reading};

/// All that a fit needs of a log, some MB for a log of any length. It can be pickled.
#[pyclass(frozen, module = "tempco")]
pub(crate) struct Summary {
    pub(crate) summary: LogSummary,
}

#[pymethods]
impl Summary {
    /// Of a log in memory.
    #[staticmethod]
    fn of_log(py: Python, log: Py<Log>, plan: PlanFields) -> PyResult<Self> {
        let log = log.get();
        let plan = plan.plan(log.scale_factor_arcsec)?;
        let summary = work(py, || Ok(summarise_log(&log.log, &plan)))?;
        Ok(Self { summary })
    }

    /// Of a file, which is read in memory of a fixed size.
    #[staticmethod]
    fn of_file(py: Python, path: PathBuf, reading: Reading, plan: PlanFields) -> PyResult<Self> {
        let options = reading.options()?;
        let plan = plan.plan(options.scale_factor_arcsec)?;
        let summary = work(py, || {
            summarise_file(&path, &options, &plan, |_| ()).map_err(of_log)
        })?;
        Ok(Self { summary })
    }

    /// Reads a file that `tempco summarise` wrote.
    #[staticmethod]
    fn read(py: Python, path: PathBuf) -> PyResult<Self> {
        let summary = work(py, || read_summary(&path).map_err(of_log))?;
        Ok(Self { summary })
    }

    /// The summary that `bytes()` gave.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let summary = LogSummary::from_bytes(bytes).map_err(LogError::new_err)?;
        Ok(Self { summary })
    }

    /// The bytes of a summary file: versioned, with a checksum.
    fn __bytes__<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.summary.to_bytes())
    }

    /// How it is pickled.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let from_bytes = py.get_type::<Self>().getattr("from_bytes")?;
        Ok((from_bytes, (self.__bytes__(py),)))
    }

    /// Name of the log.
    #[getter]
    fn name(&self) -> &str {
        self.summary.file()
    }

    /// SHA-256 of the log, in hexadecimal.
    #[getter]
    fn sha256(&self) -> &str {
        self.summary.sha256()
    }

    /// Number of rows of the log.
    #[getter]
    fn rows(&self) -> usize {
        self.summary.rows()
    }
}
