//! Chamber logs: typed, checked, in units.
//!
//! ```text
//! source (hash, unpack) -> head -> blocks -> rows -> order -> stream -+-> read (the whole log)
//!                   parquet ----------------^         +-> chunks, for whoever reads in one pass
//! ```
//!
//! | modules | what they do |
//! | --- | --- |
//! | `encoding`, `head`, `dialect` | text: its encoding, separator and header |
//! | `source`, `blocks`, `records`, `decimal`, `rows`, `pipeline` | text: unpacked, cut into blocks, parsed on all cores |
//! | `parquet`, `parquet_file`, `parquet_columns`, `parquet_filters`, `time_types`, `pages` | tables of Parquet, columns of times, pages of bounded size |
//! | `frame` | columns in memory |
//! | `binary` | logs of autopilots: ULog of PX4, DataFlash of ArduPilot |
//! | `names`, `known`, `mapping`, `time` | what names say; known loggers; columns that a user names |
//! | `time_column`, `temp_columns`, `axis_columns`, `channel_columns`, `filter_columns`, `columns`, [`AxisUnit`] | which column is what, in which unit |
//! | `slot`, `layout`, `text_layout`, `decimal_comma` | what the cells of a column must hold |
//! | `order`, `row_numbers`, `clock`, `bursts` | times that increase: counters that wrap, restarts, stamps of whole bursts |
//! | `hold`, `join` | temperatures where a row has none: the last one, or that of another log |
//! | `interval`, `stream`, `chunk`, `skipped` | rows in chunks, their usual interval; bad rows, counted by reason |
//! | `log`, `read`, `reading`, `doubt` | a whole [`Log`], how it was read, and what is in doubt of that |
//! | [`signals`] | signals that are not what they are said to be |
//! | [`decimate`], [`median`], [`turns`], [`parallel`] | an evenly spaced sample of a series; medians; where it turns; work on all cores |
#![forbid(unsafe_code)]

mod axis_columns;
mod binary;
mod blocks;
mod bursts;
mod channel_columns;
mod chunk;
mod clock;
mod column_use;
mod columns;
#[cfg(test)]
mod columns_tests;
mod decimal;
mod decimal_comma;
pub mod decimate;
mod dialect;
#[cfg(test)]
mod dialect_tests;
mod doubt;
mod encoding;
mod error;
mod excerpt;
mod filter_columns;
mod frame;
mod head;
mod hold;
mod interval;
mod join;
mod known;
mod layout;
mod log;
#[cfg(test)]
mod logger_tests;
mod mapping;
pub mod median;
mod names;
mod order;
mod pages;
pub mod parallel;
mod parquet;
mod parquet_columns;
mod parquet_file;
mod parquet_filters;
#[cfg(test)]
mod parquet_tests;
mod pipeline;
mod read;
mod reading;
mod records;
mod row_numbers;
mod rows;
pub mod signals;
mod skipped;
mod slot;
mod source;
mod stream;
mod temp_columns;
#[cfg(test)]
mod tests;
mod text_layout;
mod time;
mod time_column;
mod time_types;
pub mod turns;
mod unit;
mod zstandard;

pub use axis_columns::AxisColumn;
pub use channel_columns::ChannelColumns;
pub use chunk::Chunk;
pub use column_use::ColumnUse;
pub use doubt::{Doubt, DoubtKind};
pub use error::LogError;
pub use excerpt::list_names;
pub use frame::Frame;
pub use interval::Intervals;
pub use log::{Axis, Channel, Log};
pub use mapping::Mapping;
pub use read::{ReadOptions, Survey, read_frame, read_log, read_log_observed, survey_log_observed};
pub use reading::Reading;
pub use skipped::SkippedRows;
pub use source::hex;
pub use stream::LogStream;
pub use unit::{AxisUnit, COLUMN_UNITS, ColumnUnit};
