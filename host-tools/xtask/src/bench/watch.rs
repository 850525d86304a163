//! Runs a program and watches what it takes.

use std::io::{BufWriter, Write};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

use anyhow::{Context, Result, ensure};

use super::log::write_rows;

/// Time between looks at the memory of a program.
const LOOK: Duration = Duration::from_millis(2);

/// Ticks of the system's clock in a second, in which it counts processor time.
const TICKS_PER_S: f64 = 100.0;

/// What a run took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taken {
    /// From start to end \[s\].
    pub(super) seconds: f64,
    /// Processor time, of the program and of the system for it \[s\]; 0 where the system does not say.
    pub(super) cpu_s: f64,
    /// Most memory resident at a time; 0 where the system does not say (Linux does).
    pub(super) peak_memory_bytes: u64,
}

/// Runs a program to its end; it must do its work. Its input is the log of so many rows, if that is
/// asked for.
pub(super) fn watch(command: &mut Command, input_rows: Option<u64>) -> Result<Taken> {
    let name = format!("{command:?}");
    let (start, cpu_before_s) = (Instant::now(), cpu_of_children_s());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    if input_rows.is_some() {
        command.stdin(Stdio::piped());
    }
    let mut child = command.spawn().with_context(|| name.clone())?;
    let writer = input_rows.zip(child.stdin.take()).map(|(rows, pipe)| {
        thread::spawn(move || -> Result<()> {
            let mut pipe = BufWriter::with_capacity(1 << 16, pipe);
            write_rows(&mut pipe, rows)?;
            Ok(pipe.flush()?)
        })
    });
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
    let seconds = start.elapsed().as_secs_f64();
    // 1: it was done, and the set is rejected.
    ensure!(
        matches!(status.code(), Some(0 | 1)),
        "{name} ended with {status}"
    );
    if let Some(writer) = writer {
        writer.join().expect("writing cannot panic")?;
    }
    Ok(Taken {
        seconds,
        cpu_s: cpu_of_children_s() - cpu_before_s,
        peak_memory_bytes,
    })
}

/// Processor time of all programs that this one has run to their end \[s\].
fn cpu_of_children_s() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // After the name of the program, which is in brackets and may have blanks.
    let fields = stat.rsplit(')').next().unwrap_or_default();
    let ticks = fields.split_whitespace().skip(13).take(2);
    ticks
        .filter_map(|ticks| ticks.parse::<f64>().ok())
        .sum::<f64>()
        / TICKS_PER_S
}

fn peak(status: String) -> Option<u64> {
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kib)
}
