//! `tempco apply` reads a file twice and keeps no row of it; a pipe it reads once.

#![cfg(unix)]

use std::fs;
use std::io::Write;
use std::process::{Command, Stdio};

use tempco_tests::{Bench, tempco};

/// A set of two axes of pulses and a log of more than one block of text.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write(
        "set.csv",
        "gyro,segment,temp_min_c,temp_max_c,a0_pulses,a1_pulses_per_c,a2_pulses_per_c2\n\
         X,1,-15,80,0.0173,-0.0014,0.00001\nY,1,-15,80,0.0064,0.0004,-0.00004\n",
    );
    bench.ok("simulate --unit paper --profile verification --rate 0.5 --out log.csv");
    bench
}

/// Runs `tempco` with a file through a pipe.
fn through_a_pipe(command: &mut Command, bytes: &[u8]) -> String {
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(bytes).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_pipe_gives_the_rows_of_the_file() {
    let bench = bench();
    let said = bench.ok("apply set.csv log.csv --out of_file.csv");
    let mut command = tempco();
    command.current_dir(bench.path("")).args([
        "apply",
        "set.csv",
        "/dev/stdin",
        "--out",
        "of_pipe.csv",
    ]);
    let log = fs::read(bench.path("log.csv")).unwrap();
    let of_pipe = through_a_pipe(&mut command, &log);
    assert_eq!(of_pipe, said.replace("of_file", "of_pipe"));
    let [file, pipe] =
        ["of_file.csv", "of_pipe.csv"].map(|name| fs::read(bench.path(name)).unwrap());
    assert!(file == pipe);
    let rows = file.iter().filter(|&&byte| byte == b'\n').count() - 1;
    assert!(
        rows > 20_000 && said.starts_with(&format!("{rows} rows, ")),
        "{said}"
    );
}

/// Peak memory, of a log and of one ten times as long \[KiB\].
#[test]
#[cfg(target_os = "linux")]
fn memory_does_not_grow_with_the_log() {
    let bench = bench();
    let text = fs::read_to_string(bench.path("log.csv")).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let peak = |copies: u32| {
        let name = format!("of{copies}.csv");
        let mut file = fs::File::create(bench.path(&name)).unwrap();
        writeln!(file, "{header}").unwrap();
        for copy in 0..copies {
            for row in rows.lines() {
                let (time_s, rest) = row.split_once(',').unwrap();
                let time_s = time_s.parse::<f64>().unwrap() + f64::from(copy) * 1e5;
                writeln!(file, "{time_s},{rest}").unwrap();
            }
        }
        let mut command = tempco();
        let child = command
            .current_dir(bench.path(""))
            .args(["apply", "set.csv", &name, "--out", "out.csv"])
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        peak_kib(child)
    };
    let (short, long) = (peak(2), peak(16));
    println!("{short} {long} KiB");
    assert!(long < short + 8 * 1024, "{short} {long}");
}

/// The most memory that a process had while it ran \[KiB\].
#[cfg(target_os = "linux")]
fn peak_kib(mut child: std::process::Child) -> u64 {
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.trim().split(' ').next()?.parse().ok());
        peak = kib.unwrap_or(peak).max(peak);
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    assert!(child.wait().unwrap().success() && peak > 0);
    peak
}
