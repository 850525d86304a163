//! Exceptions. They have the words of the command, with file, line and column.

use std::error::Error;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::marker::Ungil;
use pyo3::prelude::*;
use tempco_report::CalibrationError;

create_exception!(tempco, TempcoError, PyValueError, "What tempco refuses.");
create_exception!(tempco, LogError, TempcoError, "A log cannot be read.");
create_exception!(tempco, FitError, TempcoError, "Logs cannot be fitted.");
create_exception!(
    tempco,
    SetError,
    TempcoError,
    "A set cannot be read, written or used."
);
create_exception!(
    tempco,
    EvaluateError,
    TempcoError,
    "A set cannot be judged on a log."
);

/// The exception of a log that cannot be read.
pub(crate) fn of_log(error: impl Error) -> PyErr {
    LogError::new_err(error.to_string())
}

/// The exception of logs that cannot be fitted.
pub(crate) fn of_fit(error: impl Error) -> PyErr {
    FitError::new_err(error.to_string())
}

/// The exception of a set that cannot be used.
pub(crate) fn of_set(error: impl Error) -> PyErr {
    SetError::new_err(error.to_string())
}

/// The exception of a set that cannot be judged on a log.
pub(crate) fn of_evaluation(error: impl Error) -> PyErr {
    EvaluateError::new_err(error.to_string())
}

/// The exception of a unit that cannot be calibrated.
pub(crate) fn of_calibration(error: CalibrationError) -> PyErr {
    match error {
        CalibrationError::Run(error) => of_log(error),
        error => of_fit(error),
    }
}

/// Works without the interpreter's lock. A panic becomes an exception.
pub(crate) fn work<T: Ungil + Send>(
    py: Python,
    work: impl FnOnce() -> PyResult<T> + Ungil + Send,
) -> PyResult<T> {
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(work)));
    done.unwrap_or_else(|cause| {
        let text = cause.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| cause.downcast_ref::<&str>().copied());
        Err(TempcoError::new_err(format!(
            "a fault of tempco, please report it: {}",
            text.unwrap_or("without a message")
        )))
    })
}
