//! The STM32F405 as far as QEMU has one: set-up without clock control, the link with its receive
//! interrupt, the sampling interrupt, the counters, and where the store lies in the flash.
#![cfg(unix)]

mod support;

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::thread;
use std::time::{Duration, Instant};
use std::{fs, str};

use support::image;
use tempco_qemu::{Board, Machine, MachineOptions};

const BOARD: Board = Board::Stm32F405;
const LIMIT: Duration = Duration::from_secs(20);

/// Words that a loader puts where fault log and offsets begin: sectors 8 and 10.
const FAULTS: (u32, u32) = (0x0808_0000, 0x1234_5678);
const OFFSETS: (u32, u32) = (0x080c_0000, 0x9abc_def0);

fn wait_for(machine: &Machine, part: &str) -> Vec<String> {
    let start = Instant::now();
    loop {
        let log = machine.log();
        if log.iter().any(|line| line.contains(part)) {
            return log;
        }
        assert!(start.elapsed() < LIMIT, "no `{part}` in {log:#?}");
        thread::sleep(Duration::from_millis(5));
    }
}

/// The numbers of a line.
fn numbers(line: &str) -> Vec<i64> {
    line.split(|c: char| !c.is_ascii_digit() && c != '-')
        .filter_map(|word| word.parse().ok())
        .collect()
}

#[test]
fn the_board_comes_up_and_its_devices_answer() {
    let folder = tempfile::tempdir().unwrap();
    let mut extra = Vec::new();
    for (address, word) in [FAULTS, OFFSETS] {
        let path = folder.path().join(format!("{word:x}"));
        fs::write(&path, word.to_le_bytes()).unwrap();
        let loader = format!(
            "loader,file={},addr={address:#x},force-raw=on",
            path.display()
        );
        extra.extend(["-device".to_owned(), loader]);
    }
    let options = MachineOptions {
        extra,
        ..MachineOptions::default()
    };
    let machine = Machine::start(&image(BOARD, "bringup", None), BOARD, &options).unwrap();

    let log = wait_for(&machine, "info echo");
    assert!(log[1].contains("clock Fixed, reset by PowerOn"), "{log:#?}");
    for (line, (_, word)) in [(&log[4], FAULTS), (&log[5], OFFSETS)] {
        assert!(line.ends_with(&format!("true {word:08x}")), "{log:#?}");
    }
    // There is no chip on the bus, before and after the time of a conversion.
    let missing = log.iter().filter(|line| line.ends_with("Err(Bus)")).count();
    assert_eq!(missing, 6, "{log:#?}");

    // More than the queue of the interrupt holds.
    let mut link = UnixStream::connect(machine.link()).unwrap();
    link.set_read_timeout(Some(LIMIT)).unwrap();
    let mut sent: Vec<u8> = (0..5000_u32).map(|i| (i % 255) as u8 + 1).collect();
    sent.push(0);
    link.write_all(&sent).unwrap();
    let mut echo = vec![0; sent.len()];
    link.read_exact(&mut echo).unwrap();
    assert_eq!(echo, sent);

    let log = wait_for(&machine, "info link");
    let [.., counts, link] = log.as_slice() else {
        panic!("{log:#?}")
    };
    assert_eq!(numbers(link), [0, 0, 0], "bytes were lost: {link}");
    let [x, y, _, samples] = numbers(counts)[..] else {
        panic!("{counts}")
    };
    println!("{counts}");
    assert!(samples > 200, "{counts}");
    // The timers count time, and the same one.
    assert!(x > 0 && (x - y).abs() < x / 10, "{counts}");
}
