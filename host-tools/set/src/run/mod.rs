//! A set run over a log by the core, as a unit switched on at its first row: a log in memory
//! ([`apply()`], [`apply_to_log()`]), or a file that is read chunk by chunk ([`apply_to_file()`]).

mod columns;
mod compensators;
mod file;
mod memory;
mod parts;
mod thermal_path;
mod updates;

pub use columns::{ApplyError, ChannelInputs};
pub use compensators::{Applied, AxisOutput, column_names};
pub use file::{KnownLog, RunError, apply_to_file, is_rereadable};
pub use memory::{apply, apply_to_log, inputs};
pub use parts::Part;
pub use thermal_path::{IntervalCache, is_usable, thermal_points, with_every_rate};
pub use updates::{Updates, thermal_period_s};
