//! Tables in use that are not any more what they were when they were accepted: they are found in the
//! time that is stated, and heal. Memory that changes by itself is for the emulator to show; here a
//! unit is given other tables than it has accepted.

mod common;

use std::sync::atomic::Ordering;

use common::{Bench, Running, image, image_of};
use tempco::{PLAYS, Status, Table, Terms, Thermal, ThermalSettings};
use tempco_firmware::board::mps2_an386::nor::{Nor, REGIONS};
use tempco_firmware::table;
use tempco_firmware::unit::in_use::{Accepted, InUse, PLACES, RESET_AFTER_S, Room, STEP_MS};
use tempco_firmware::unit::storage::Storage;
use tempco_firmware::unit::sums::Sums;
use tempco_firmware::unit::{AXES, CHANNELS, IMAGE_LEN, Next, SERIAL};
use tempco_image::{AlignedBytes, Axis, Fit, Unit as AxisUnit};
use tempco_link::{Fault, FaultSet, Request, Response, Telemetry};

/// Time after which a unit has no more flags \[s\].
const SETTLED_S: f32 = 200.0;
/// Steps until a table of one block is checked.
const STEPS: u32 = 2;
/// Time between two self-tests, and from damage that was found to right samples \[ms\].
const TEST_MS: u32 = 100;
const HEALING_MS: u32 = 200;

/// What any table of these tests fits.
const FIT: Fit = Fit {
    unit: AxisUnit::PulsesPerS,
    scale_factor_arcsec: 0.5,
    max_bias: 1e6,
};

/// The numbers of a table.
#[derive(Clone)]
struct Numbers {
    cells: Vec<[f32; Terms::COUNT]>,
    settings: [f32; ThermalSettings::NAMES.len()],
    /// Edges, and the calibrated range \[degC\].
    range: [f32; 4],
    gains: [[f32; AXES]; PLAYS],
}

impl Numbers {
    fn new(cells: usize) -> Self {
        let settings = ThermalSettings {
            rate_start: 1.0,
            half_width1_c: 2.0,
            kappa: 0.25,
            ..ThermalSettings::DEFAULT
        };
        Self {
            cells: vec![[0.5, 0.25, -0.125, 0.0625, 0.03125, 0.0, 0.01]; AXES * cells],
            settings: settings.to_array(),
            range: [-40.0, 80.0, -30.0, 70.0],
            gains: [[0.25; AXES], [-0.125; AXES]],
        }
    }

    /// Looks at the tables that they make; none where they are refused.
    fn with_table<R>(&self, look: impl FnOnce(&[Table<'_, AXES>; CHANNELS]) -> R) -> Option<R> {
        let cells: Vec<Terms> = self.cells.iter().copied().map(Terms::from_array).collect();
        let thermal = Thermal::new(ThermalSettings::from_array(self.settings)).ok()?;
        let [first_edge_c, last_edge_c, t_min_c, t_max_c] = self.range;
        let (cells, _) = cells.as_chunks();
        let table = Table::new(thermal, first_edge_c, last_edge_c, cells).ok()?;
        let table = table.calibrated(t_min_c, t_max_c).ok()?;
        Some(look(&[table.with_plays(self.gains).ok()?]))
    }

    fn sums(&self) -> Sums {
        let sums = self.with_table(|tables| Sums::of(tables).unwrap());
        sums.unwrap()
    }
}

/// Flips every bit of some numbers, one at a time; how many of the tables with such a flip are
/// accepted. A step must find each of them, and no step but this and the last one may.
fn flips_found(cells: usize, step: usize, numbers: fn(&mut Numbers) -> &mut [f32]) -> usize {
    let good = Numbers::new(cells);
    let sums = good.sums();
    let bits = 32 * numbers(&mut good.clone()).len();
    let found = |at: &usize| {
        let mut damaged = good.clone();
        let number = &mut numbers(&mut damaged)[at / 32];
        *number = f32::from_bits(number.to_bits() ^ 1 << (at % 32));
        let held = damaged.with_table(|tables| {
            (0..sums.steps())
                .map(|step| sums.hold(tables, step))
                .collect::<Vec<_>>()
        });
        if let Some(held) = &held {
            assert!(!held[step], "bit {at}");
            let others = held[..held.len() - 1].iter().enumerate();
            let others = others.filter(|(other, held)| *other != step && !**held);
            assert_eq!(others.count(), 0, "bit {at}");
        }
        held.is_some()
    };
    (0..bits).filter(found).count()
}

/// Of a block of cells and of the next one, all of a cell.
#[test]
fn every_bit_of_cells_is_in_the_sum_of_its_block() {
    let found = flips_found(2, 0, |numbers| numbers.cells.as_flattened_mut());
    assert!(found > 1200, "{found}");
    // 146 rows of seven numbers are a block: the last one of the first block, the first of the second.
    let found = flips_found(60, 0, |numbers| &mut numbers.cells[145]);
    assert!(found > 200, "{found}");
    let found = flips_found(60, 1, |numbers| &mut numbers.cells[146]);
    assert!(found > 200, "{found}");
}

#[test]
fn every_bit_of_settings_range_and_gains_is_in_the_last_sum() {
    for (numbers, least) in [
        (
            (|numbers: &mut Numbers| &mut numbers.settings[..]) as fn(&mut Numbers) -> &mut [f32],
            500,
        ),
        (|numbers| &mut numbers.range, 80),
        (|numbers| numbers.gains.as_flattened_mut(), 180),
    ] {
        let found = flips_found(2, 1, numbers);
        assert!(found > least, "{found}");
    }
}

/// The answers alone: a cell in the middle of the range is part of the last sum too.
#[test]
fn the_answers_of_a_table_are_in_the_last_sum() {
    let good = Numbers::new(2);
    let mut other = good.clone();
    other.cells[0][0] = 0.75;
    let held = other.with_table(|tables| good.sums().hold(tables, 1));
    assert_eq!(held, Some(false));
}

/// Damage is found by the step of its place, and again in the next round.
#[test]
fn the_check_goes_round() {
    let (good, mut other) = (Numbers::new(60), Numbers::new(60));
    other.gains[0][0] = 0.5;
    let sums = good.sums();
    other.with_table(|tables| {
        let accepted = Accepted {
            tables: *tables,
            crc: 7,
            sums,
        };
        let mut in_use = InUse::new(&accepted);
        let found: Vec<_> = (0..6).map(|_| in_use.check()).collect();
        assert_eq!(found, [Ok(()), Ok(()), Err(2), Ok(()), Ok(()), Err(2)]);
        let due: Vec<_> = [3999, 4000, 4100, 7999, 8000]
            .map(|ms| in_use.is_due(ms))
            .into();
        assert_eq!(due, [false, true, false, false, true]);
    });
}

/// As often as there are places, and as long as images fit.
#[test]
fn a_table_is_loaded_again_while_there_is_room() {
    for (room_len, places, loads) in [
        (IMAGE_LEN, PLACES, PLACES),
        (IMAGE_LEN, 2, 2),
        (8000, PLACES, 2),
    ] {
        let cells = Bench::with_tables().flash;
        let (mut buffer, mut scratch) =
            (AlignedBytes([0; IMAGE_LEN]), AlignedBytes([0; IMAGE_LEN]));
        let mut tables = [const { None }; PLACES];
        let mut room = Room::new(&mut buffer.0[..room_len], &mut tables[..places]);
        let len = image(SERIAL, 0xb).len();
        assert!((2 * len..3 * len).contains(&8000), "{len}");
        let booted = Storage::boot(
            Nor(&cells),
            REGIONS,
            &[[FIT; AXES]; CHANNELS],
            &mut room,
            &mut scratch.0,
        );
        let (mut storage, first) = booted.unwrap();
        let first = first.unwrap();
        let mut count = 1;
        while let Some(next) = storage.reload(&mut room) {
            assert_eq!(next.crc(), 0xb);
            assert_eq!(next.tables(), first.tables());
            assert_eq!(next.sums(), first.sums());
            count += 1;
        }
        assert_eq!((count, storage.active()), (loads, None));
    }
}

/// Means over the last tenth of a second.
fn of_now(bench: &mut Bench, unit: &mut dyn Running) -> Telemetry {
    bench.telemetry(unit);
    bench.wait(unit, 0.1);
    bench.telemetry(unit)
}

fn biases(telemetry: &Telemetry) -> [f32; AXES] {
    core::array::from_fn(|axis| telemetry.outcome.bias[axis])
}

fn is_near(found: [f32; AXES], right: [f32; AXES]) -> bool {
    found.iter().zip(right).all(|(a, b)| (a - b).abs() < 1e-4)
}

/// The image in use with an exponent of the cell of 25 degC changed.
fn damaged() -> Vec<u8> {
    let [table] = &table::TABLES;
    let mut cells = table.cells().to_vec();
    let mut terms = cells[table.place(25.0).cell][0].to_array();
    terms[0] = f32::from_bits(terms[0].to_bits() ^ 1 << 23);
    cells[table.place(25.0).cell][0] = Terms::from_array(terms);
    let axes = [Axis::new(AxisUnit::PulsesPerS); AXES];
    image_of(SERIAL, 0xb, &axes, cells.as_flattened())
}

#[test]
fn a_damaged_table_is_loaded_again_and_the_output_heals() {
    let mut bench = Bench::with_tables();
    let right = bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        biases(&bench.telemetry(unit))
    });
    bench.upset = Some(damaged());
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, 1.0);
        let wrong = of_now(bench, unit);
        assert!(!is_near(biases(&wrong), right), "it has an effect");
        while !bench.faults(unit).contains(Fault::TableUpset) {
            bench.wait(unit, 0.01);
        }
        let found_ms = bench.telemetry(unit).uptime_ms;
        assert!(found_ms <= STEPS * (STEP_MS + TEST_MS), "{found_ms}");
        bench.wait(unit, HEALING_MS as f32 / 1000.0);
        let healed = of_now(bench, unit);
        assert!(is_near(biases(&healed), right));
        assert_eq!(healed.faults, FaultSet::from(Fault::TableUpset));
        assert!(!healed.faults.is_invalidating());
        bench.wait(unit, 1.2);
        assert_eq!(bench.faults(unit), FaultSet::NONE);
        let log = bench.log(unit);
        let entry = log.iter().find(|(fault, _)| *fault == Fault::TableUpset);
        let entry = entry.unwrap().1;
        assert_eq!((entry.count, entry.detail), (1, 0), "block 0");
        // The state has gone on: the unit settles when it would have.
        bench.wait(unit, SETTLED_S);
        let status = Status::from_bits(bench.telemetry(unit).outcome.channels[0].status);
        assert_eq!(status, Status::OK);
    });
}

/// On command it is found at once.
#[test]
fn a_test_on_command_heals_a_damaged_table() {
    let mut bench = Bench::with_tables();
    bench.upset = Some(damaged());
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, 0.5);
        let found = bench.ask(unit, &Request::Bit, |response| match response {
            Response::Bit { faults } => *faults,
            other => panic!("{other:?}"),
        });
        assert_eq!(found, FaultSet::from(Fault::TableUpset));
        bench.wait(unit, 10.0);
        assert_eq!(bench.faults(unit), FaultSet::NONE);
    });
}

/// The slot that it would be loaded from is damaged too, or there is no more room.
#[test]
fn a_table_that_cannot_be_loaded_again_is_used_no_more() {
    for has_room in [false, true] {
        let mut bench = Bench::with_tables();
        bench.upset = Some(damaged());
        bench.places = if has_room { PLACES } else { 1 };
        bench.boot(|bench, unit| {
            bench.connect(unit);
            bench.wait(unit, 1.0);
            if has_room {
                bench.flash[(0x8000 + 900) / 4].fetch_xor(4, Ordering::Relaxed);
            }
            bench.wait(unit, (STEPS * (STEP_MS + TEST_MS)) as f32 / 1000.0);
            let telemetry = of_now(bench, unit);
            assert!(telemetry.faults.contains(Fault::NoTable));
            assert!(telemetry.faults.is_invalidating());
            assert_eq!(telemetry.outcome.bias, [0.0; AXES]);
            let log = bench.log(unit);
            assert!(log.iter().any(|(fault, _)| *fault == Fault::TableUpset));
            // It resets itself, once it has run for long enough.
            let mut uptime_ms = bench.telemetry(unit).uptime_ms;
            while unit.pass() == Next::GoOn {
                uptime_ms += 10;
            }
            let from_ms = 1000 * RESET_AFTER_S;
            let expected = from_ms..from_ms + 2 * TEST_MS;
            assert!(expected.contains(&uptime_ms), "{uptime_ms}");
        });
        bench.places = PLACES;
        bench.boot(|bench, unit| {
            bench.connect(unit);
            bench.wait(unit, SETTLED_S);
            let faults = bench.faults(unit);
            assert!(!faults.contains(Fault::NoTable));
            assert_eq!(faults.contains(Fault::SpareTable), has_room);
        });
    }
}
