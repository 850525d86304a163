//! Runs a program and watches what it takes.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

use anyhow::{Context, Result, ensure};

/// Time between looks at the memory of a program.
const LOOK: Duration = Duration::from_millis(2);

/// What a run took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taken {
    /// From start to end \[s\].
    pub(super) seconds: f64,
    /// Most memory resident at a time; 0 where the system does not say (Linux does).
    pub(super) peak_memory_bytes: u64,
}

/// Runs a program to its end; it must succeed.
pub(super) fn watch(command: &mut Command) -> Result<Taken> {
    let name = format!("{command:?}");
    let start = Instant::now();
    let mut child = command
        .stdout(Stdio::null())
        .spawn()
        .with_context(|| name.clone())?;
    let status_file = format!("/proc/{}/status", child.id());
    let mut peak_memory_bytes = 0;
    let status = loop {
        // The system keeps the maximum; only what is added after the last look escapes.
        if let Some(peak) = fs::read_to_string(&status_file).ok().and_then(peak) {
            peak_memory_bytes = peak;
        }
        if let Some(status) = child.try_wait()? {
            break status;
        }
        thread::sleep(LOOK);
    };
    ensure!(status.success(), "{name} ended with {status}");
    Ok(Taken {
        seconds: start.elapsed().as_secs_f64(),
        peak_memory_bytes,
    })
}

fn peak(status: String) -> Option<u64> {
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kib)
}
