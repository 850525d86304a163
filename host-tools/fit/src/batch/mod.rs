//! Many units at once: which logs belong to which, and how the units compare.

mod find;
mod names;
mod outcome;
mod outlier;
mod summary;
mod summary_csv;

pub use find::{FindError, UnitLogs, find_units};
pub use names::{SUMMARY_FILES, SerialError, check_serial, is_folder_name};
pub use outcome::{AxisResult, Outcome, UnitResult};
pub use outlier::{LEAST_UNITS, OUTLIER_Z, robust_z};
pub use summary::{AxisOfUnit, BatchAxis, Summary};
