//! A machine in the background: what it starts with, and what outlives it.
#![cfg(unix)]

mod support;

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::os::unix::net::UnixStream;
use std::thread;
use std::time::{Duration, Instant};

use support::image;
use tempco_qemu::{Board, Error, Layout, Machine, MachineOptions};

/// Where the memory of [`MachineOptions::memory`] lies.
const MEMORY: u32 = 0x2100_0000;

/// The processor is halted, so that no image can end the machine.
fn halted() -> MachineOptions {
    MachineOptions {
        extra: vec!["-S".to_owned()],
        ..MachineOptions::default()
    }
}

fn start(options: &MachineOptions) -> Result<Machine, Error> {
    let image = image(Board::Mps2An386, "replay", None);
    Machine::start(&image, Board::Mps2An386, options)
}

#[test]
fn memory_of_a_machine_is_read_and_outlives_it() {
    let image = image(Board::Mps2An386, "replay", None);
    let layout = Layout::of(&image).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let options = MachineOptions {
        memory: Some(folder.path().join("a,b")),
        ..halted()
    };
    let mut machine = Machine::start(&image, Board::Mps2An386, &options).unwrap();
    let vectors = machine.read_memory(0, 4).unwrap();
    assert_eq!(vectors, layout.stack_top.to_le_bytes());
    assert_eq!(machine.read_memory(MEMORY, 8).unwrap(), [0; 8]);

    // Written while it runs, read by it and by the next one.
    let memory = File::options()
        .write(true)
        .open(folder.path().join("a,b"))
        .unwrap();
    memory.write_all_at(b"tempco", 1 << 20).unwrap();
    let place = MEMORY + (1 << 20);
    assert_eq!(machine.read_memory(place, 6).unwrap(), b"tempco");
    machine.reset().unwrap();
    assert_eq!(machine.read_memory(place, 6).unwrap(), b"tempco");
    drop(machine);
    let mut machine = Machine::start(&image, Board::Mps2An386, &options).unwrap();
    assert_eq!(machine.read_memory(place, 6).unwrap(), b"tempco");
}

#[test]
fn memory_of_a_machine_is_written() {
    const RAM: u32 = 0x2000_0000;
    let mut machine = start(&halted()).unwrap();
    for bytes in [&b"temp"[..], b"co"] {
        machine.write_memory(RAM + 5, bytes).unwrap();
        let read = machine.read_memory(RAM + 5, bytes.len());
        assert_eq!(read.unwrap(), bytes);
    }
    let status = machine.monitor("info status").unwrap();
    assert!(status.contains("paused"), "{status}");
}

#[test]
fn a_machine_takes_connections_and_commands_and_ends_when_dropped() {
    let mut machine = start(&halted()).unwrap();
    let link = machine.link();
    UnixStream::connect(&link).unwrap();
    let status = machine.monitor("info status").unwrap();
    assert!(status.contains("paused"), "{status}");
    assert!(machine.log().is_empty());
    drop(machine);
    assert!(UnixStream::connect(&link).is_err());
}

/// The image says how it is used, and exits.
#[test]
fn what_the_image_logs_is_collected() {
    let mut machine = start(&halted()).unwrap();
    // The image may have ended before QEMU answers.
    _ = machine.monitor("cont");
    let start = Instant::now();
    while machine.log().len() < 2 {
        assert!(
            start.elapsed() < Duration::from_secs(20),
            "{:?}",
            machine.log()
        );
        thread::sleep(Duration::from_millis(5));
    }
    let log = machine.log();
    assert!(log[1].contains("usage: replay"), "{log:?}");
}

#[test]
fn what_qemu_refuses_is_told_in_its_words() {
    let options = MachineOptions {
        extra: vec!["-no-such-option".to_owned()],
        ..MachineOptions::default()
    };
    let error = start(&options).err().unwrap();
    assert!(error.to_string().contains("-no-such-option"), "{error}");
}
