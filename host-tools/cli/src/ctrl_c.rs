//! Ctrl-C on Windows: the command removes what is unfinished, then ends as it would by itself.

use std::process;

use tempco_set::files;

/// The exit code of programs that are ended by Ctrl-C.
const CONTROL_C_EXIT: i32 = 0xC000_013A_u32.cast_signed();

/// Waits for Ctrl-C and Ctrl-Break in a thread of its own.
pub(crate) fn watch() -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(|| {
        files::abandon();
        process::exit(CONTROL_C_EXIT);
    })
}
