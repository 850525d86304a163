//! What only a target has: logs, files and an exit through semihosting; panics and faults.
//!
//! There is one way out for logs, defmt over semihosting's standard output (`logger`). Printing
//! there by any other means would corrupt its frames.

mod failure;
mod files;

// Linked for what it defines: the critical section that the logger needs.
use cortex_m as _;

pub use files::{Argument, FileError, Input, Output, arguments};

use crate::{board::BOARD, table};

/// Says which image this is.
pub fn banner(image: &str) {
    defmt::info!(
        "tempco {=str} {=str} on {=str}: unit {=str}, {=usize} channel(s) of {=usize} axes, {=usize} cells, table {=u32:08x}",
        image,
        env!("CARGO_PKG_VERSION"),
        BOARD.name,
        table::SERIAL,
        table::CHANNELS,
        table::AXES,
        table::TABLES
            .iter()
            .map(|table| table.cells().len())
            .sum::<usize>(),
        table::CRC,
    );
}

/// Ends the program: 0 if all went well, else 1.
pub fn exit(success: bool) -> ! {
    semihosting::process::exit(if success { 0 } else { 1 })
}
