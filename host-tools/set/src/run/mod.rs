//! A set run over a log by the core, as a unit switched on at its first row: in memory ([`apply()`]),
//! or row by row as the log is read once more ([`rerun()`]).

mod apply;
mod core_run;
mod stream;

pub use apply::{Applied, ApplyError, AxisOutput, ChannelInputs, apply, inputs};
pub use core_run::{is_usable, points_of, thermal_points, with_every_rate};
pub use stream::{Answers, ChannelAnswers, Reread, RerunError, is_rereadable, rerun};
