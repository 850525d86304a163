//! Signals that end the command: it removes unfinished files, ends emulators, then ends by the signal.

use std::fs;
use std::io;
use std::thread;

use tempco_qemu::end_all_machines;
use tempco_set::files;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

/// Waits for signals in a thread of its own.
pub(crate) fn watch() -> io::Result<()> {
    let ignored = ignored();
    let heeded = [SIGHUP, SIGINT, SIGTERM];
    let heeded = heeded
        .into_iter()
        .filter(|signal| ignored & bit(*signal) == 0);
    let mut signals = Signals::new(heeded)?;
    thread::spawn(move || {
        for signal in signals.forever() {
            files::abandon();
            end_all_machines();
            let _ = emulate_default_handler(signal);
        }
    });
    Ok(())
}

/// The signals that were ignored when the command began: by `nohup`, or by a shell for a command in
/// the background. They stay ignored. Where they cannot be known, `nohup` is honoured.
fn ignored() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.unwrap_or(bit(SIGHUP))
}

const fn bit(signal: i32) -> u64 {
    1 << (signal - 1)
}
