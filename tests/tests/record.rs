//! `tempco record`, `rezero`, `bit` and `bank` where something goes wrong; `docs/first-table.md` walks
//! them where all is well.
#![cfg(unix)]

#[path = "../../host-tools/hil/tests/common/mod.rs"]
mod simulated;

use std::fs;
use std::io::{Read, Write};
use std::net::Shutdown;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use simulated::{Flash, Wire, image_of, serve};
use tempco_qemu::{Board, Machine, MachineOptions, MachineTime};
use tempco_tests::Bench;
use tempco_tests::rig::image;

/// A line that can be cut, between a program and a unit.
struct Line {
    path: PathBuf,
    client: Arc<Mutex<Option<UnixStream>>>,
}

impl Line {
    fn to(unit: PathBuf, path: PathBuf) -> Self {
        let listener = UnixListener::bind(&path).unwrap();
        let client: Arc<Mutex<Option<UnixStream>>> = Arc::default();
        let kept = client.clone();
        thread::spawn(move || {
            for client in listener.incoming() {
                let client = client.unwrap();
                *kept.lock().unwrap() = Some(client.try_clone().unwrap());
                let unit = UnixStream::connect(&unit).unwrap();
                let back = (unit.try_clone().unwrap(), client.try_clone().unwrap());
                let back = thread::spawn(move || pass(back.0, back.1));
                pass(client, unit);
                back.join().unwrap();
            }
        });
        Self { path, client }
    }

    fn cut(&self) {
        let client = self.client.lock().unwrap();
        client.as_ref().unwrap().shutdown(Shutdown::Both).unwrap();
    }
}

fn pass(mut from: UnixStream, mut to: UnixStream) {
    let mut block = [0; 4096];
    while let Ok(count @ 1..) = from.read(&mut block) {
        if to.write_all(&block[..count]).is_err() {
            break;
        }
    }
    for side in [from, to] {
        _ = side.shutdown(Shutdown::Both);
    }
}

/// The rows of a log that is being written.
fn rows(log: &Path) -> Vec<String> {
    let text = fs::read_to_string(log).unwrap_or_default();
    text.lines().skip(1).map(str::to_owned).collect()
}

fn wait_for_rows(log: &Path, count: usize) {
    let start = Instant::now();
    while rows(log).len() < count {
        assert!(start.elapsed().as_secs() < 60, "{:?}", rows(log).last());
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_recording_goes_on_after_a_reset_and_a_lost_line() {
    let bench = Bench::new();
    // Built before any time is taken.
    bench.ok("--version");
    let options = MachineOptions {
        time: MachineTime::Unbound { shift: 8 },
        ..MachineOptions::default()
    };
    let mut machine = Machine::start(&image(), Board::Mps2An386, &options).unwrap();
    let line = Line::to(machine.link(), bench.path("line"));
    let log = bench.path("log.csv");
    let args = format!(
        "record --port {} --out log.csv --duration 100",
        line.path.display()
    );
    let ran = thread::scope(|scope| {
        let recorder = scope.spawn(|| bench.run(&args));
        wait_for_rows(&log, 50);
        machine.reset().unwrap();
        wait_for_rows(&log, rows(&log).len() + 50);
        line.cut();
        recorder.join().unwrap()
    });
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert!(ran.err.contains("waiting for the unit"), "{}", ran.err);
    assert!(ran.err.contains("unit EXAMPLE is back"), "{}", ran.err);

    let rows = rows(&log);
    let cells: Vec<Vec<&str>> = rows.iter().map(|row| row.split(',').collect()).collect();
    let times: Vec<f64> = cells
        .iter()
        .map(|cells| cells[0].parse().unwrap())
        .collect();
    assert!(times.is_sorted_by(|a, b| a < b));
    assert!(times[times.len() - 1] - times[0] >= 100.0);
    let gaps: Vec<(usize, &str)> = cells
        .iter()
        .enumerate()
        .map(|(row, cells)| (row, cells[6]))
        .filter(|(_, gap)| !gap.is_empty())
        .collect();
    // On a busy machine a message may be lost besides, which is said too.
    let causes: Vec<&str> = gaps.iter().map(|(_, cause)| *cause).collect();
    let known = causes.iter().filter(|cause| **cause != "lost");
    assert_eq!(
        known.collect::<Vec<_>>(),
        [&"reset", &"line"],
        "{}",
        ran.err
    );
    let count = format!("{} gaps; wrote log.csv", gaps.len());
    assert!(ran.out.contains(&count), "{}", ran.out);
    // Elsewhere no row is missing, though the emulator may have to wait for the line.
    let intervals_s = (1..rows.len())
        .filter(|row| cells[*row][6].is_empty())
        .map(|row| times[row] - times[row - 1]);
    let intervals_s: Vec<f64> = intervals_s.collect();
    let mean_s = intervals_s.iter().sum::<f64>() / intervals_s.len() as f64;
    assert!((mean_s - 0.1).abs() < 0.002, "{mean_s}");
    for cells in &cells {
        assert_eq!(cells.len(), 7, "{cells:?}");
        assert!(cells[1].starts_with("25"), "{cells:?}");
        assert_eq!(cells[2..6], ["0", "0", "0", "no_table"], "{cells:?}");
    }
    // It can be read as a log.
    bench.ok("columns log.csv");

    let again = bench.run(&args);
    assert_eq!(again.code, 2);
    assert!(
        again
            .err
            .contains("--out log.csv: it exists: expected the name of a new file"),
        "{}",
        again.err
    );
    assert_eq!(self::rows(&log).len(), rows.len());
}

/// A unit in this process behind a socket, which has another serial number at its second session.
fn exchanged(bench: &Bench) -> PathBuf {
    let path = bench.path("unit");
    let listener = UnixListener::bind(&path).unwrap();
    thread::spawn(move || {
        for (number, port) in listener.incoming().enumerate() {
            let flash = Flash {
                serial: format!("S{}", number + 1),
                ..Flash::default()
            };
            let port = port.unwrap();
            if number == 0 {
                let port = port.try_clone().unwrap();
                thread::spawn(move || {
                    thread::sleep(Duration::from_millis(300));
                    port.shutdown(Shutdown::Both).unwrap();
                });
            }
            let wires = [Wire::GOOD, Wire::GOOD];
            thread::spawn(move || serve(port, Arc::new(Mutex::new(flash)), wires));
        }
    });
    path
}

#[test]
fn another_unit_at_the_same_port_is_not_recorded() {
    let bench = Bench::new();
    let port = exchanged(&bench);
    let ran = bench.run(&format!(
        "record --port {} --out log.csv --period 20",
        port.display()
    ));
    assert_eq!(ran.code, 2, "{}", ran.out);
    assert!(
        ran.err
            .contains("unit S2 in place of unit S1: expected the same one"),
        "{}",
        ran.err
    );
    assert!(bench.path("log.csv").exists(), "what has come is kept");
}

#[test]
fn a_line_that_stays_away_ends_the_recording_in_time_and_is_said() {
    let bench = Bench::new();
    let path = bench.path("unit");
    let listener = UnixListener::bind(&path).unwrap();
    thread::spawn(move || {
        let (port, _) = listener.accept().unwrap();
        let end = port.try_clone().unwrap();
        thread::spawn(move || {
            thread::sleep(Duration::from_millis(300));
            end.shutdown(Shutdown::Both).unwrap();
        });
        let flash = Flash {
            serial: "S1".to_owned(),
            ..Flash::default()
        };
        let wires = [Wire::GOOD, Wire::GOOD];
        serve(port, Arc::new(Mutex::new(flash)), wires);
    });
    let ran = bench.run("record --port unit --out log.csv --period 20 --duration 1");
    assert_eq!(ran.code, 1, "{}", ran.err);
    assert!(ran.err.contains("the log is short"), "{}", ran.err);
    assert!(ran.out.contains("wrote log.csv"), "{}", ran.out);
}

#[test]
fn banks_and_their_faults_are_shown() {
    let bench = Bench::new();
    let path = bench.path("unit");
    let listener = UnixListener::bind(&path).unwrap();
    let mut damaged = image_of("S1", 5, 0.0);
    damaged[40] ^= 1;
    let flash = Arc::new(Mutex::new(Flash {
        serial: "S1".to_owned(),
        banks: [image_of("S1", 4, 0.0), damaged],
        chosen: Some(0),
        ..Flash::default()
    }));
    thread::spawn(move || {
        for port in listener.incoming() {
            serve(port.unwrap(), flash.clone(), [Wire::GOOD, Wire::GOOD]);
        }
    });
    let ran = bench.run("bank --port unit");
    assert_eq!(ran.code, 1, "{}", ran.err);
    let line = |name: &str| {
        let start = format!("| {name} ");
        let line = ran.out.lines().find(|line| line.starts_with(&start));
        line.unwrap().to_owned()
    };
    assert!(
        line("A").contains("yes") && line("A").contains("00000004"),
        "{}",
        ran.out
    );
    assert!(
        line("A").contains("good") && !line("B").contains("good"),
        "{}",
        ran.out
    );
    let used = bench.ok("bank --port unit --use A");
    assert!(used.contains("runs on table 00000004 in bank A"), "{used}");
}
