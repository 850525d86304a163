//! The Python module `tempco._core`: logs, summaries and sets as Python objects.
//!
//! What Python users see is in `python/tempco`; here is what must be Rust. Every call that takes time
//! releases the interpreter's lock, and a panic becomes an exception.

mod errors;
mod log;
mod options;
mod set;
mod simulation;
mod summary;

use pyo3::prelude::pymodule;

/// The module.
#[pymodule]
mod _core {
    use pyo3::prelude::*;
    use pyo3::types::IntoPyDict;
    use tempco_set::{RejectionCode, WarningCode};

    #[pymodule_export]
    use crate::errors::{EvaluateError, FitError, LogError, SetError, TempcoError};
    #[pymodule_export]
    use crate::log::Log;
    #[pymodule_export]
    use crate::set::{Set, fit, import_parameters, load};
    #[pymodule_export]
    use crate::simulation::simulate;
    #[pymodule_export]
    use crate::summary::Summary;

    /// Adds the flags of a status, by name, and what each code of a reason means and advises.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let flags = tempco::Status::NAMES.iter();
        let flags = flags.map(|(flag, name)| (*name, flag.bits()));
        module.add("STATUS", flags.into_py_dict(module.py())?)?;
        let rejections = RejectionCode::ALL.iter();
        let rejections = rejections.map(|of| (of.name(), (of.meaning(), of.advice())));
        let warnings = WarningCode::ALL.iter();
        let warnings = warnings.map(|of| (of.name(), (of.meaning(), of.advice())));
        module.add(
            "CODES",
            rejections.chain(warnings).into_py_dict(module.py())?,
        )
    }
}
