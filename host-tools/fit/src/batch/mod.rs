//! Many units at once: which logs belong to which, and how the units compare.

mod figures;
mod find;
mod names;
mod outlier;
mod summary;

pub use figures::{AxisFigures, Outcome, UnitFigures};
pub use find::{FindError, UnitLogs, find_units};
pub use names::{SUMMARY_FILES, SerialError, check_serial};
pub use outlier::{LEAST_UNITS, OUTLIER_Z, robust_z};
pub use summary::Summary;
