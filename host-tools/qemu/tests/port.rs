//! What `docs/port-in-an-hour.md` shows is what is built and run here.
#![cfg(unix)]

mod support;

use std::fs;

use support::{WORKSPACE, example, example_image};
use tempco_hil::replay::{by_block, by_row};
use tempco_hil::{Patience, Unit, flash_set, open};
use tempco_image::{AlignedBytes, Image};
use tempco_link::{Fault, FaultSet};
use tempco_qemu::{Board, Machine, MachineOptions, MachineTime, Variant, build_variant};
use tempco_replay::Sample;

fn text(path: &str) -> String {
    fs::read_to_string(WORKSPACE.root().join(path)).unwrap()
}

#[test]
fn the_page_shows_the_smallest_board() {
    let file = text("firmware/src/board/mps2_an500/application.rs");
    let page = text("docs/port-in-an-hour.md");
    let shown = format!("```rust\n{file}```\n");
    assert!(page.contains(&shown), "the page shows another file");
}

/// On the board of the page, a table goes into the flash, and samples through the main loop and
/// through the sampling interrupt, bit for bit.
#[test]
fn the_smallest_board_runs_the_application() {
    const BOARD: Board = Board::Mps2An500;
    const SILENT: Variant = Variant {
        name: "silent",
        features: &["application"],
        config: &[],
    };
    let image = build_variant(&WORKSPACE, BOARD, "unit", None, &SILENT).unwrap();
    let options = MachineOptions {
        time: MachineTime::Unbound { shift: 5 },
        ..MachineOptions::default()
    };
    let machine = Machine::start(&image, BOARD, &options).unwrap();
    let port = open(&machine.link(), 0).unwrap();
    let mut unit = Unit::connect(port, Patience::default()).unwrap();
    assert!(unit.built_in_test().unwrap().contains(Fault::NoTable));

    let mut place = AlignedBytes([0; 16 * 1024]);
    let bytes = example_image();
    place.0[..bytes.len()].copy_from_slice(&bytes);
    let table = Image::read(&place.0).unwrap();
    let tables = &table.tables::<1, 3>().unwrap();
    let identity = flash_set(&mut unit, table.bytes(), |_| {}).unwrap();
    assert_eq!(identity.table_crc, example::CRC);
    let samples = |count: u16| {
        (0..count).map(|number| Sample {
            update_s: Some(1.0),
            temps_c: [20.0 + 0.02 * f32::from(number)],
            raw: [[f32::from(number), -0.5, f32::NAN]],
        })
    };
    let schedule = &identity.schedule;
    let found = by_row(&mut unit, tables, samples(100), |_| {}).unwrap();
    assert_eq!((found.samples, found.different), (100, 0));
    // A hello that the reset cut in two may have been dropped before, nothing since.
    let dropped_frames = found.before.dropped_frames;
    let found = by_block(&mut unit, tables, schedule, true, samples(500), |_| {}).unwrap();
    assert_eq!((found.samples, found.different), (500, 0));

    let state = unit.telemetry(0).unwrap();
    assert_eq!(state.faults, FaultSet::NONE);
    assert_eq!((state.overruns, state.dropped_frames), (0, dropped_frames));
    assert!(state.raw.iter().all(|raw| *raw > 1e7), "{:?}", state.raw);
}
