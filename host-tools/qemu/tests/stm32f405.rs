//! The STM32F405 as far as QEMU has one: set-up without clock control, the link with its receive
//! interrupt, the sampling interrupt, the counters, and where the store lies in the flash; and the
//! application on top of it, with a table out of that flash.
#![cfg(unix)]

mod support;

use std::fs;
use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use support::{WORKSPACE, example, example_image_in, image};
use tempco_firmware::board::mps2_an386::nor::Nor;
use tempco_firmware::board::stm32f405::store::{REGIONS, SECTOR, SECTORS};
use tempco_hil::{Patience, open};
use tempco_image::{AlignedBytes, Image, Unit};
use tempco_link::{Bank, Fault, Request, Telemetry};
use tempco_qemu::{Board, Machine, MachineOptions, Variant, build_variant};
use tempco_store::Store;

const BOARD: Board = Board::Stm32F405;
const LIMIT: Duration = Duration::from_secs(20);

/// Sector 6, where the memory file has the store.
const STORE: u32 = 0x0804_0000;

/// Words that a loader puts where fault log and offsets begin: sectors 8 and 10.
const FAULTS: (u32, u32) = (0x0808_0000, 0x1234_5678);
const OFFSETS: (u32, u32) = (0x080c_0000, 0x9abc_def0);

/// The timers of the axes x, y, z.
const TIM2: u32 = 0x4000_0000;
const TIM5: u32 = 0x4000_0c00;
const TIM4: u32 = 0x4000_0800;

/// QEMU's flash cannot be programmed by the image, but may hold anything at first.
fn loader(path: &Path, address: u32) -> [String; 2] {
    let path = path.display();
    [
        "-device".to_owned(),
        format!("loader,file={path},addr={address:#x},force-raw=on"),
    ]
}

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

/// The timers count nanoseconds. Interrupts are whole periods apart, more than one where the emulator
/// was late, and the first comes soon after the timers were started.
fn check_counts(line: &str) {
    const PERIOD: i64 = 500_000;
    println!("{line}");
    let [x, y, _, samples] = numbers(line)[..] else {
        panic!("{line}")
    };
    assert!(samples >= 200, "{line}");
    for counted in [x, y] {
        assert!(
            (samples..4 * samples).contains(&(counted / PERIOD)),
            "{line}"
        );
        assert!(counted % PERIOD < PERIOD / 5, "{line}");
    }
}

/// QEMU has the registers of encoder mode without the mode: both inputs are captured, both count, and
/// the counters wrap at their full width.
fn check_encoders(machine: &mut Machine) {
    for (timer, width) in [(TIM2, u32::MAX), (TIM5, u32::MAX), (TIM4, 0xffff)] {
        let mut register = |offset| {
            let bytes = machine.read_memory(timer + offset, 4).unwrap();
            u32::from_le_bytes(bytes.try_into().unwrap())
        };
        let [cr1, smcr, ccmr1, ccer, arr] = [0x00, 0x08, 0x18, 0x20, 0x2c].map(&mut register);
        assert_eq!(cr1 & 1, 1, "{timer:#x} is off");
        assert_eq!(
            (smcr & 7, ccmr1, ccer & 0x33),
            (3, 0x0101, 0x11),
            "{timer:#x}"
        );
        assert_eq!(arr, width, "{timer:#x}");
    }
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
    // Time by instructions, so that interrupts come on time.
    extra.extend(["-icount".to_owned(), "shift=3,sleep=off".to_owned()]);
    let options = MachineOptions {
        extra,
        ..MachineOptions::default()
    };
    let mut machine = Machine::start(&image(BOARD, "bringup", None), BOARD, &options).unwrap();

    let log = wait_for(&machine, "info echo");
    assert!(log[1].contains("clock Fixed, reset by PowerOn"), "{log:#?}");
    for (line, (_, word)) in [(&log[4], FAULTS), (&log[5], OFFSETS)] {
        assert!(line.ends_with(&format!("true {word:08x}")), "{log:#?}");
    }
    // There is no chip on the bus, whenever it is looked for.
    let missing = log.iter().filter(|line| line.ends_with("Err(Bus)")).count();
    assert_eq!(missing, 9, "{log:#?}");
    check_counts(&log[15]);
    check_encoders(&mut machine);

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
    println!("{log:#?}");
    let lost = numbers(&log[log.len() - 1]);
    assert_eq!(lost, [0, 0, 0], "bytes were lost: {log:#?}");

    let page = fs::read_to_string(WORKSPACE.root().join("docs/board-stm32f405.md")).unwrap();
    let shown = page.split("<!-- bringup -->\n```text\n").nth(1).unwrap();
    let shown = shown.split("```").next().unwrap();
    let log: Vec<String> = log.iter().map(|line| constant(line)).collect();
    let expected: Vec<String> = shown.lines().map(constant).collect();
    assert_eq!(log, expected, "{log:#?}");
}

/// A line of the log, without what differs from run to run: level, counts, first words of the flash.
fn constant(line: &str) -> String {
    let message = line.strip_prefix("info ").unwrap_or(line);
    if message.starts_with("counts") {
        message.replace(|c: char| c.is_ascii_digit() || c == '-', "")
    } else if message.starts_with("flash") {
        message.rsplit_once(' ').unwrap().0.to_owned()
    } else {
        message.to_owned()
    }
}

/// The flash of a unit that was given the example table, and then one that does not fit its board,
/// byte by byte.
fn store_with_example() -> Vec<u8> {
    // A model of flash with smaller sectors and longer words, which the layout does not depend on.
    let cells: Vec<AtomicU32> = (0..SECTORS * SECTOR as usize / 4)
        .map(|_| AtomicU32::new(u32::MAX))
        .collect();
    let flash = &mut Nor(&cells);
    let [a, b] = REGIONS.slots;
    let mut store = Store::new(flash, a, b).unwrap();
    let mut buffer = AlignedBytes([0; 16 * 1024]);
    for image in [
        example_image_in(Unit::PulsesPerS),
        example_image_in(Unit::Dph),
    ] {
        let len = image.len() as u32;
        store.boot(flash, &mut buffer.0, |_| Ok(()));
        let slot = store.begin(flash, len).unwrap();
        store.write(flash, 0, &image).unwrap();
        let crc = Store::crc(&image);
        let all = |_: &Image| Ok(());
        store.commit(flash, len, crc, &mut buffer.0, all).unwrap();
        store.select(flash, slot, &mut buffer.0, all).unwrap();
    }
    let words = cells.iter().map(|cell| cell.load(Ordering::Relaxed));
    words.flat_map(u32::to_le_bytes).collect()
}

/// What cannot be: the flash keeps nothing, there are no sensors, and the counters count time.
#[test]
fn the_application_takes_its_table_from_the_flash_and_serves_the_link() {
    const APPLICATION: Variant = Variant {
        name: "",
        features: &["application"],
        config: &[],
    };
    let unit = build_variant(&WORKSPACE, BOARD, "unit", None, &APPLICATION).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("store");
    fs::write(&path, store_with_example()).unwrap();
    let options = MachineOptions {
        extra: loader(&path, STORE).to_vec(),
        ..MachineOptions::default()
    };
    let machine = Machine::start(&unit, BOARD, &options).unwrap();

    let mut unit = connect(&machine);
    let identity = unit.identify().unwrap();
    assert_eq!(identity.serial, example::SERIAL);
    assert_eq!(identity.table_crc, example::CRC);
    assert_eq!(
        identity.bank,
        Some(Bank::A),
        "that in B is later and does not fit"
    );

    let first = unit.telemetry(0).unwrap();
    thread::sleep(Duration::from_millis(200));
    let second = unit.telemetry(0).unwrap();
    println!("{second:?}");
    assert!(second.samples > first.samples, "{first:?} {second:?}");
    assert_eq!(second.dropped_frames, first.dropped_frames);
    assert!(second.raw.iter().all(|raw| raw.is_finite() && *raw != 0.0));
    wait_for_fault(&mut unit, Fault::SensorBus);
    let faults = unit.built_in_test().unwrap();
    println!("{faults:?}");
    assert!(faults.contains(Fault::SensorBus) && !faults.contains(Fault::NoTable));
    assert!(faults.contains(Fault::SpareTable));

    unit.command(&Request::Activate(Bank::A)).unwrap();
    unit.reconnect().unwrap();
    let third = unit.telemetry(0).unwrap();
    assert_eq!(third.index, first.index, "it did not start again");
    assert_eq!(unit.identify().unwrap().table_crc, example::CRC);
}

/// The unit with an ICM-42688-P, on a bus with no chip: it looks for it again and again, says that the
/// gyro is silent, and does all else.
#[test]
fn a_chip_that_does_not_answer_is_said_and_stops_nothing() {
    const WITH_CHIP: Variant = Variant {
        name: "icm42688",
        features: &["application", "gyro-icm42688"],
        config: &[],
    };
    let unit = build_variant(&WORKSPACE, BOARD, "unit", None, &WITH_CHIP).unwrap();
    let machine = Machine::start(&unit, BOARD, &MachineOptions::default()).unwrap();
    let mut unit = connect(&machine);
    wait_for_fault(&mut unit, Fault::GyroSilent);
    let state = wait_for_fault(&mut unit, Fault::SensorBus);
    assert!(state.raw.iter().all(|raw| raw.is_nan()), "{state:?}");
    assert_eq!((state.samples, state.overruns), (0, 0), "{state:?}");
}

/// The unit's time passes as the host lets it.
fn wait_for_fault(unit: &mut tempco_hil::Unit, fault: Fault) -> Telemetry {
    let start = Instant::now();
    loop {
        let state = unit.telemetry(0).unwrap();
        if state.faults.contains(fault) {
            return state;
        }
        assert!(start.elapsed() < LIMIT, "{fault:?}: {state:?}");
        thread::sleep(Duration::from_millis(20));
    }
}

fn connect(machine: &Machine) -> tempco_hil::Unit {
    let port = open(&machine.link(), 921_600).unwrap();
    let patience = Patience {
        answer: Duration::from_millis(200),
        tries: 100,
        ..Patience::default()
    };
    tempco_hil::Unit::connect(port, patience).unwrap()
}
