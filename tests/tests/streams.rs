//! Commands read a file twice and keep no row of it, however long it is; a pipe they read once.

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
    // 1: the set is rejected.
    assert!(matches!(output.status.code(), Some(0 | 1)));
    String::from_utf8(output.stdout).unwrap()
}

/// What a command says of the log, as a file and through a pipe.
fn of_file_and_pipe(bench: &Bench, arguments: &str) -> [String; 2] {
    let of_file = bench.run(arguments).out;
    let of_pipe = arguments
        .replace("log.csv", "/dev/stdin")
        .replace("of_file", "of_pipe");
    let mut command = tempco();
    command.current_dir(bench.path("")).args(of_pipe.split(' '));
    let log = fs::read(bench.path("log.csv")).unwrap();
    let said = through_a_pipe(&mut command, &log);
    [of_file, said.replace("of_pipe", "of_file")]
}

#[test]
fn a_pipe_gives_the_rows_of_the_file() {
    let bench = bench();
    let [said, of_pipe] = of_file_and_pipe(&bench, "apply set.csv log.csv --out of_file.csv");
    assert_eq!(of_pipe, said);
    let [file, pipe] =
        ["of_file.csv", "of_pipe.csv"].map(|name| fs::read(bench.path(name)).unwrap());
    assert!(file == pipe);
    let rows = file.iter().filter(|&&byte| byte == b'\n').count() - 1;
    assert!(
        rows > 20_000 && said.starts_with(&format!("{rows} rows, ")),
        "{said}"
    );
}

#[test]
fn a_pipe_gives_the_figures_of_the_file() {
    let bench = bench();
    let arguments = "evaluate set.csv log.csv --against set.csv --json";
    let [of_file, of_pipe] = of_file_and_pipe(&bench, arguments);
    assert_eq!(of_file.replace("log.csv", "stdin"), of_pipe);
    assert!(of_file.contains("\"hysteresis\"") && of_file.contains("\"deviations\""));
}

/// Rows of the shorter and of the longer log.
#[cfg(target_os = "linux")]
const ROWS: [usize; 2] = [1_000_000, 4_000_000];

/// Writes a log of about so many rows, 20 ms apart: one log after the other.
#[cfg(target_os = "linux")]
fn write_log(bench: &Bench, name: &str, count: usize) {
    let text = fs::read_to_string(bench.path("log.csv")).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let rows: Vec<&str> = rows
        .lines()
        .map(|row| row.split_once(',').unwrap().1)
        .collect();
    let file = fs::File::create(bench.path(name)).unwrap();
    let mut file = std::io::BufWriter::new(file);
    writeln!(file, "{header}").unwrap();
    for number in 0..count {
        let time_s = number as f64 / 50.0;
        writeln!(file, "{time_s:.2},{}", rows[number % rows.len()]).unwrap();
    }
}

/// The most memory that commands need, of a log and of one four times as long \[KiB\].
#[test]
#[cfg(target_os = "linux")]
fn memory_does_not_grow_with_the_log() {
    let bench = bench();
    let names = ["short.csv", "long.csv"];
    for (name, rows) in names.into_iter().zip(ROWS) {
        write_log(&bench, name, rows);
    }
    for arguments in [
        "apply set.csv LOG --out out.csv",
        "evaluate set.csv LOG",
        "summarise LOG --out log.summary",
        "fit LOG --serial S --out s --model composite --no-report",
    ] {
        let peaks = names.map(|name| {
            let child = tempco()
                .current_dir(bench.path(""))
                .args(arguments.replace("LOG", name).split(' '))
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            peak_kib(child)
        });
        println!("{arguments}: {peaks:?} KiB");
        let [short, long] = peaks;
        assert!(long < short + 8 * 1024, "{arguments}: {peaks:?} KiB");
    }
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
    // 1: the log is of no unit, so a set may be rejected.
    let code = child.wait().unwrap().code();
    assert!(matches!(code, Some(0 | 1)) && peak > 0, "{code:?}");
    peak
}
