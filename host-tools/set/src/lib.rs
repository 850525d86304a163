//! The coefficient set of a unit: its records and its table, what is emitted from it and read back,
//! and its run over a log.
//!
//! Whatever flies is computed by the `tempco` core itself: [`run`] drives it over a log.
//!
//! | modules | what they do |
//! | --- | --- |
//! | `set`, `axis`, `table`, `history`, `provenance`, `outliers`, `extent`, `selection`, `model_kind` | the records that `coefficients.json` holds |
//! | `judgement` | the verdict on a set, with rejections and warnings |
//! | `segment`, `model` | segments of temperature and the polynomials in them |
//! | `tabulate`, [`build`] | fitted polynomials to a table and a set |
//! | `check`, `rounding` | whether a set that was read holds together; bounds on the table's rounding |
//! | `emit` | `table.rs`, `table.h`, `table.bin`, and a set from a flash image |
//! | `load`, `version1`, `import`, `folder` | sets from files, also of version 0.1; printed coefficients; the folder of a set |
//! | `dispatch` | numbers of channels and axes, from a file to the compiler |
//! | [`run`] | the core over a log: in memory, or as a stream |
//! | [`escape`], [`files`] | texts from elsewhere; files that belong together |
#![forbid(unsafe_code)]

mod axis;
pub mod build;
mod check;
mod dispatch;
mod emit;
pub mod escape;
mod extent;
pub mod files;
mod folder;
mod history;
mod import;
mod judgement;
mod load;
mod model;
mod model_kind;
mod outliers;
pub mod parameters;
mod provenance;
mod rounding;
pub mod run;
mod segment;
mod selection;
mod set;
mod table;
mod tabulate;
mod version1;

pub use axis::{AxisSet, AxisStatistics, CoefficientSigmas, GainSet, NoiseSet};
pub use check::SCALE_FACTORS_ARCSEC;
pub use dispatch::{ShapeUse, TableUse, use_axis, use_shape, use_tables};
pub use emit::{axis_unit, set_of_image, table_bin, table_h, table_rs};
pub use extent::{Extent, TooFast};
pub use folder::{MARK, REPORT, TABLE_BIN, WriteError, file_names, strangers, write_set};
pub use history::{HistoryGain, HistoryTerm};
pub use judgement::{Judged, Judgement, Rejection, RejectionCode, Verdict, Warning, WarningCode};
pub use load::{SetError, check_folder, load_set, read_set};
pub use model::{AxisModel, COMPOSITE, LOCAL_TERMS, Mismatch, Polynomial, TERMS};
pub use model_kind::Model;
pub use outliers::{BiasStep, Disturbance, Outliers, Stretch};
pub use provenance::{Input, Provenance, SignOff};
pub use rounding::RoundingBound;
pub use segment::{Overlap, Piece, Segment, SegmentError, Segmentation};
pub use selection::{Candidate, HeldOutErrors, Place, Selection, SimplerModel, Surpassed};
pub use set::{
    ChannelSet, CoefficientSet, Coverage, FORMAT_VERSION, MISMATCH_ALARM, SegmentSet, Settings,
};
pub use table::TableData;
