//! What the images take of a processor: bytes, instructions, stack. The figures are committed;
//! `TEMPCO_BLESS=1` writes them again.
#![cfg(unix)]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use tempco_hil::flash_set;
use tempco_link::{Channels, FaultSet, Request, SampleBlock, Telemetry};
use tempco_qemu::{
    Board, Layout, MachineTime, TARGET, Variant, Workspace, build_variant, ensure_target,
};
use tempco_tests::rig::{ICOUNT_SHIFT, Rig, image, quick_table};
use tempco_tests::root;

/// The application without logs.
const SILENT: Variant = Variant {
    name: "silent",
    features: &["application"],
    config: &[],
};

/// The same with an ICM-42688-P in place of the counters.
const ICM42688: Variant = Variant {
    name: "icm42688",
    features: &["application", "gyro-icm42688"],
    config: &[],
};

const FIFO_2_KHZ: Variant = Variant {
    name: "fifo",
    features: &["application", "gyro-simulated"],
    config: &[],
};

const FIFO_8_KHZ: Variant = Variant {
    name: "fifo-8khz",
    features: &["application", "gyro-simulated", "rate-8khz"],
    config: &[],
};

/// Word that the start-up code paints the stack with.
const PAINT: [u8; 4] = 0xcccc_cccc_u32.to_le_bytes();

fn build(bin: &str, board: Board, variant: &Variant) -> PathBuf {
    let workspace = Workspace::find().unwrap();
    ensure_target(&workspace).unwrap();
    assert_eq!(board.target(), TARGET);
    build_variant(&workspace, board, bin, None, variant).unwrap()
}

/// Compares a table of figures with the one that is committed: words must be the same, and numbers
/// within `share` and `least` of it.
fn compare(name: &str, found: &str, share: f64, least: f64) {
    let path = root().join("firmware/tests").join(name);
    if std::env::var_os("TEMPCO_BLESS").is_some() {
        fs::write(&path, found).unwrap();
    }
    let expected = fs::read_to_string(&path).unwrap();
    let (found_words, expected_words) = (found.split_whitespace(), expected.split_whitespace());
    assert_eq!(
        found_words.clone().count(),
        expected_words.clone().count(),
        "{name}:\n{found}"
    );
    for (found_word, expected_word) in found_words.zip(expected_words) {
        match (found_word.parse::<f64>(), expected_word.parse::<f64>()) {
            (Ok(a), Ok(b)) => {
                let within = (a - b).abs() <= least.max(share * b.abs());
                assert!(within, "{name}: {a}, committed {b}:\n{found}");
            }
            _ => assert_eq!(found_word, expected_word, "{name}:\n{found}"),
        }
    }
}

#[test]
fn sizes_of_images_are_those_committed() {
    let mut table = String::from("image board text rodata data bss\n");
    for (bin, board, variant) in [
        ("replay", Board::Mps2An386, Variant::USUAL),
        ("unit", Board::Mps2An386, Variant::APPLICATION),
        ("unit", Board::Mps2An386, SILENT),
        ("unit", Board::Stm32F405, Variant::APPLICATION),
        ("unit", Board::Stm32F405, SILENT),
        ("unit", Board::Stm32F405, ICM42688),
    ] {
        let sizes = Layout::of(&build(bin, board, &variant)).unwrap().sizes;
        let name = match variant {
            SILENT => "unit-without-logs",
            ICM42688 => "unit-icm42688-without-logs",
            _ => bin,
        };
        let (text, rodata) = (sizes.text, sizes.rodata);
        let (data, bss) = (sizes.data, sizes.bss);
        writeln!(table, "{name} {board} {text} {rodata} {data} {bss}").unwrap();
    }
    // Compilers of the same version make the same image; the tolerance is for small changes.
    compare("sizes.txt", &table, 0.02, 64.0);
}

/// Without logs nothing of them is left: neither strings nor code.
#[test]
fn logs_that_are_off_cost_nothing() {
    let image = fs::read(build("unit", Board::Mps2An386, &SILENT)).unwrap();
    let has = |image: &[u8], word: &str| image.windows(word.len()).any(|w| w == word.as_bytes());
    for word in ["_defmt_acquire", "defmt_timestamp", "defmt_semihosting"] {
        assert!(!has(&image, word), "{word}");
    }
    let image = fs::read(tempco_tests::rig::image()).unwrap();
    assert!(
        has(&image, "_defmt_acquire"),
        "the words above would be found"
    );
}

/// What a unit takes of its processor. The load is that of a unit that nobody talks to, latency and
/// stack are the worst with telemetry, a replay through the sampling interrupt, updates and
/// built-in tests.
#[test]
fn load_latency_and_stack_are_those_committed() {
    let mut table = String::from("image load latency stack\n");
    for (name, path) in [
        ("unit", image()),
        (
            "unit-without-logs",
            build("unit", Board::Mps2An386, &SILENT),
        ),
    ] {
        let figures = figures(&path);
        writeln!(table, "{name} {figures}").unwrap();
    }
    compare("load.txt", &table, 0.02, 12.0);
}

/// A gyro with a clock and a FIFO of its own: a simulated ICM-42688-P behind its driver, 2 % fast at
/// 2 kHz, and 2 % slow at 8 kHz in blocks of four. No sample is lost, and nothing is flagged. What
/// the model of the chip takes is no part of the figures.
#[test]
fn a_fifo_gyro_loses_nothing_and_costs_what_is_committed() {
    let mut table = String::from("rate instructions\n");
    for (variant, rate_hz, share) in [(FIFO_2_KHZ, 2000.0, 1.02), (FIFO_8_KHZ, 8000.0, 0.98)] {
        let time = MachineTime::Unbound {
            shift: ICOUNT_SHIFT,
        };
        let mut rig = Rig::with(&build("unit", Board::Mps2An386, &variant), time);
        rig.temperature(25.0);
        flash_set(&mut rig.unit, &quick_table(1), |_| {}).unwrap();
        let (before, chip_before) = (rig.wait_until_well(60.0), rig.simulated_chip());
        let (after, chip_after) = (undisturbed(&mut rig), rig.simulated_chip());
        for state in [&before, &after] {
            assert_eq!((state.faults, state.overruns), (FaultSet::NONE, 0));
            assert_eq!(state.outcome.channels[0].status, 0);
        }
        // The mean of x depends on where it begins.
        assert!((after.raw[0] - 100.5).abs() < 0.01, "{:?}", after.raw);
        assert_eq!(after.raw[1..], [-200.0, 300.0]);
        let samples = f64::from(after.samples - before.samples);
        let time_s = f64::from(after.uptime_ms - before.uptime_ms) / 1000.0;
        let expected = time_s * rate_hz * share;
        // A millisecond at either end, a block, and the chip's period in whole counts.
        let tolerance = 0.003 * rate_hz + 5.0 + 2e-4 * expected;
        assert!(
            (samples - expected).abs() < tolerance,
            "{samples} {expected}"
        );

        let per_second = 1e9 / f64::from(1 << ICOUNT_SHIFT);
        let all = f64::from(after.load_permille) / 1000.0 * per_second / (rate_hz * share);
        let [measured, counts] =
            [0, 1].map(|word| f64::from(chip_after[word].wrapping_sub(chip_before[word])));
        let of_chip = counts * 40.0 / f64::from(1 << ICOUNT_SHIFT) / measured;
        // The longest block is a matter of chance.
        let latency = f64::from(after.latency_ns) / f64::from(1 << ICOUNT_SHIFT);
        assert!(latency < 1200.0, "8 samples at once: {latency:.0}");
        println!("{rate_hz} Hz: {all:.0} per sample, {of_chip:.0} of them the chip's model");
        println!("{latency:.0} from the interrupt to the end of its longest block");
        writeln!(table, "{rate_hz} {:.0}", all - of_chip).unwrap();
    }
    compare("fifo.txt", &table, 0.03, 12.0);
}

fn figures(image: &Path) -> String {
    let time = MachineTime::Unbound {
        shift: ICOUNT_SHIFT,
    };
    let mut rig = Rig::with(image, time);
    rig.counts(3);
    rig.temperature(25.0);
    flash_set(&mut rig.unit, &quick_table(1), |_| {}).unwrap();
    let idle = undisturbed(&mut rig);
    for number in 0..40_u8 {
        let raw = [0x3f; 960];
        let block = SampleBlock {
            temps_c: Channels::from_slice(&[20.0 + f32::from(number)]).unwrap(),
            real_time: true,
            scale: None,
            raw: &raw,
        };
        rig.unit.ask(&Request::Block(block), |_| Some(())).unwrap();
    }
    flash_set(&mut rig.unit, &quick_table(2), |_| {}).unwrap();
    rig.unit.built_in_test().unwrap();
    let state = rig.telemetry();
    assert_eq!(state.overruns, 0);
    assert_eq!(state.faults, FaultSet::NONE);

    // Instructions per second and sample of a processor that executes one in 64 ns.
    let per_sample = 1e9 / f64::from(1 << ICOUNT_SHIFT) / 2000.0;
    let load = |permille: u16| (f64::from(permille) * per_sample / 1000.0).round();
    let latency = |ns: u32| (f64::from(ns) / f64::from(1 << ICOUNT_SHIFT)).round();
    let (bottom, top) = Layout::of(image).unwrap().stack.unwrap();
    // The stack has hundreds of kilobytes here; only its upper end is looked at.
    let bottom = bottom.max(top - 0x1_0000);
    let stack = rig
        .machine
        .read_memory(bottom, (top - bottom) as usize)
        .unwrap();
    let unused = stack
        .chunks_exact(4)
        .take_while(|word| **word == PAINT)
        .count()
        * 4;
    format!(
        "{} {} {}",
        load(idle.load_permille),
        latency(state.latency_ns),
        stack.len() - unused
    )
}

/// The compiler has ruled out every panic.
#[test]
fn no_panic_is_left_in_the_application() {
    for variant in [SILENT, FIFO_2_KHZ] {
        let image = tempco_elf::Image::read(&build("unit", Board::Mps2An386, &variant)).unwrap();
        let panics: Vec<&str> = image
            .symbols()
            .iter()
            .map(String::as_str)
            .filter(|name| is_panic(name))
            .collect();
        assert_eq!(panics, [""; 0], "{}", variant.name);
    }
    let application = tempco_elf::Image::read(&build("replay", Board::Mps2An386, &Variant::USUAL));
    let application = application.unwrap();
    let others = application.symbols().iter().filter(|name| is_panic(name));
    assert!(others.count() > 1, "an image that formats has more");
}

/// The state after two seconds of the unit's time in which nobody asked for anything.
fn undisturbed(rig: &mut Rig) -> Telemetry {
    let mut last_ms = rig.telemetry().uptime_ms;
    let mut pause = Duration::from_millis(100);
    loop {
        thread::sleep(pause);
        // How far its time goes meanwhile is the host's matter.
        pause *= 2;
        let state = rig.telemetry();
        if state.uptime_ms - last_ms > 2000 {
            return state;
        }
        last_ms = state.uptime_ms;
    }
}

/// Functions that panic, not the one that all of them end in.
fn is_panic(name: &str) -> bool {
    let is_end = name.ends_with("panic_fmt") || name.ends_with("begin_unwind");
    let words = [
        "panicking::",
        "panic_already",
        "unwrap_failed",
        "expect_failed",
        "_fail",
    ];
    !is_end && words.iter().any(|word| name.contains(word))
}
