//! Rows of binary logs of autopilots: PX4 (`.ulg`) and ArduPilot (`.bin`).
//!
//! | modules | what they do |
//! | --- | --- |
//! | `window` | the bytes of a file, with a look ahead |
//! | `ulog`, `dataflash` | the records of a file, and what is damaged |
//! | `rows` | the chosen rows as numbers |
//! | `table` | the rows of one topic, by source |
//!
//! The rows of the one topic are kept as they stand in the file, and made numbers some at a time.
//!
//! Why no crate reads them: a damaged file must be refused with the place. `px4-ulog` says no places,
//! and panics on short records. `ardupilot-binlog` goes on behind a damaged part in silence, or stops
//! there. Both read whole files in the tests, to compare.

mod dataflash;
mod rows;
mod table;
#[cfg(test)]
mod tests;
mod ulog;
mod window;

pub(super) use rows::BinaryRows;
