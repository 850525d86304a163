//! The image `unit` in the emulator: faults of sensors, line, flash and supply, and what it says
//! of each.
#![cfg(unix)]

use std::io::Write;
use std::thread;
use std::time::{Duration, Instant};

use tempco::{Status, Validity};
use tempco_hil::{Error, Unit, flash_set};
use tempco_image::Unit as AxisUnit;
use tempco_link::{Bank, Fault, FaultEntry, FaultSet, Refusal, Request, Telemetry};
use tempco_tests::rig::{Rig, SLOT_B, quick_table, table_in};

fn validity(state: &Telemetry) -> Validity {
    Status::from_bits(state.outcome.channels[0].status).validity()
}

/// A unit with the same table in both slots, settled.
fn ready() -> Rig {
    let mut rig = Rig::start();
    for crc in [1, 2] {
        flash_set(&mut rig.unit, &quick_table(crc), |_| {}).unwrap();
    }
    rig.temperature(25.0);
    rig
}

/// A fault is noted at the reading and in the status at the next update.
fn wait_for(rig: &mut Rig, fault: Fault, class: Validity) -> Telemetry {
    rig.wait(6.0, fault.name(), |state| {
        state.faults.contains(fault) && validity(state) == class
    })
}

#[test]
fn faults_of_a_sensor_have_their_status_and_heal() {
    let mut rig = ready();
    // A constant code, for ten seconds.
    rig.wait_until_well(12.0);
    rig.stuck(25.0);
    rig.wait_for(Fault::SensorStuck, 20.0);
    for (code, fault) in [
        (1, Fault::SensorOpen),
        (2, Fault::SensorShort),
        (3, Fault::SensorRail),
        (0, Fault::SensorBus),
        (4, Fault::SensorBus),
    ] {
        rig.temperature(25.0 + code as f32 / 100.0);
        rig.wait_until_well(12.0);
        rig.sensor_fault(code);
        let state = wait_for(&mut rig, fault, Validity::Degraded);
        assert!(state.temps_c[0].is_nan(), "{fault:?}");
    }
    // Nothing for longer than the table's hold time.
    let state = wait_for(&mut rig, Fault::TemperatureLost, Validity::Invalid);
    assert!(state.faults.is_invalidating());

    rig.temperature(25.2);
    rig.wait_until_well(12.0);
    rig.temperature(f32::NAN);
    wait_for(&mut rig, Fault::TemperatureRejected, Validity::Degraded);
    rig.temperature(25.3);
    rig.wait_until_well(12.0);
    // A spike: a few readings among good ones, 100 ms of the unit's time apart. Each is rejected,
    // and no good one is.
    let before = rig.telemetry();
    rig.temperature(60.0);
    let spike = rig.wait(5.0, "a spike", |state| state.rejected > before.rejected);
    assert!(spike.faults.contains(Fault::TemperatureRejected));
    assert_eq!(validity(&spike), Validity::Degraded);
    rig.temperature(25.4);
    let after = rig.telemetry();
    let readings = (after.uptime_ms - before.uptime_ms) / 100 + 2;
    let state = rig.wait_until_well(12.0);
    let rejected = state.rejected - before.rejected;
    assert!(
        (1..=readings).contains(&rejected),
        "{rejected} of {readings}"
    );

    // Everything is in the log, and still is after a reset.
    let log = rig.unit.faults().unwrap();
    rig.machine.reset().unwrap();
    rig.unit.reconnect().unwrap();
    assert_eq!(rig.unit.faults().unwrap().len(), log.len());
    for fault in [
        Fault::SensorStuck,
        Fault::SensorOpen,
        Fault::SensorShort,
        Fault::SensorRail,
        Fault::SensorBus,
        Fault::TemperatureLost,
        Fault::TemperatureRejected,
    ] {
        assert!(
            log.iter().any(|entry| entry.code == fault.code()),
            "{fault:?}"
        );
    }
}

#[test]
fn a_damaged_flash_falls_back_to_the_other_table_and_then_to_none() {
    let mut rig = ready();
    rig.damage(SLOT_B + 200);
    // Found while it runs, and the running table is the one that was validated at boot.
    let state = rig.wait_for(Fault::SpareTable, 5.0);
    assert!(!state.faults.contains(Fault::NoTable));
    for (place, bank, crc) in [(None, Some(Bank::A), 1), (Some(200), None, 0)] {
        if let Some(place) = place {
            rig.damage(place);
        }
        rig.machine.reset().unwrap();
        rig.unit.reconnect().unwrap();
        let identity = rig.unit.identify().unwrap();
        assert_eq!((identity.bank, identity.table_crc), (bank, crc));
        let faults = rig.unit.built_in_test().unwrap();
        assert!(faults.contains(Fault::SpareTable));
        assert_eq!(faults.contains(Fault::NoTable), bank.is_none());
    }
    // Uncompensated, and saying so.
    rig.counts(3);
    let state = rig.wait(2.0, "counts", |state| state.raw[0] == 6000.0);
    assert_eq!(state.outcome.compensated, state.raw);
    assert_eq!(validity(&state), Validity::Invalid);
    // A table brings it back.
    flash_set(&mut rig.unit, &quick_table(7), |_| {}).unwrap();
    assert_eq!(rig.unit.identify().unwrap().table_crc, 7);
}

#[test]
fn a_main_loop_that_hangs_is_reset_by_the_watchdog() {
    let mut rig = ready();
    rig.wait(3.0, "running", |state| state.samples > 200);
    rig.stop();
    thread::sleep(Duration::from_millis(500));
    rig.unit.reconnect().unwrap();
    let state = rig.telemetry();
    assert!(
        state.faults.contains(Fault::WatchdogReset),
        "{:?}",
        state.faults
    );
    assert_eq!(rig.unit.identify().unwrap().table_crc, 2);
    let log = rig.unit.faults().unwrap();
    let entry = log
        .iter()
        .find(|entry| entry.code == Fault::WatchdogReset.code());
    assert_eq!(entry.unwrap().count, 1);
}

/// Upsets of the table in use: of a cell in its image, and of a number that follows from a setting.
#[test]
fn a_bit_that_flips_in_the_table_in_use_is_found_and_heals() {
    let mut rig = ready();
    let right = rig.wait_until_well(12.0).outcome.bias;
    // The fault lasts for a second of the unit's time, its entry in the log for ever.
    let heals = |rig: &mut Rig, expected: (u32, u32)| {
        let start = Instant::now();
        let upset = |entry: &&FaultEntry| entry.code == Fault::TableUpset.code();
        loop {
            let log = rig.unit.faults().unwrap();
            let found = log.iter().find(upset);
            let found = found.map(|entry| (entry.count, entry.detail));
            if found == Some(expected) {
                break;
            }
            assert!(start.elapsed().as_secs() < 30, "{found:?}");
            thread::sleep(Duration::from_millis(20));
        }
        let state = rig.wait_until_well(12.0);
        for (bias, right) in state.outcome.bias.iter().zip(&right) {
            assert!((bias - right).abs() < 0.01, "{bias} {right}");
        }
    };
    let cell = [0.5_f32, 0.25, 0.125, 0.0625, 0.0, 0.0, 0.0].map(f32::to_le_bytes);
    let cell = cell.as_flattened();
    // Cells of three axes; this is the second one, that of 25 degC.
    let at = rig.find_in_memory(&cell.repeat(6));
    assert_eq!(at.len(), 1, "{at:?}");
    rig.upset(at[0] + 3 * cell.len() as u32 + 2, 7);
    heals(&mut rig, (1, 0));
    // The tables of boot and the ones that were loaded again. The last step finds it.
    let minutes = 2.0_f32 / 60.0;
    let at = rig.find_in_memory(&minutes.to_le_bytes());
    assert!(at.len() >= 2, "{at:?}");
    for address in at {
        rig.upset(address, 0);
    }
    heals(&mut rig, (2, 1));
}

/// `TEMPCO_GARBAGE` says how many megabytes; the usual run takes a small share of one.
#[test]
fn garbage_on_the_line_does_no_harm() {
    let bytes = match std::env::var("TEMPCO_GARBAGE") {
        Ok(megabytes) => megabytes.parse::<usize>().unwrap() << 20,
        Err(_) => 20_000,
    };
    let mut rig = ready();
    let log = rig.unit.faults().unwrap();
    let mut state = 1_u64;
    let mut left = bytes;
    while left > 0 {
        let block: Vec<u8> = (0..left.min(4096))
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                // Every eighth byte ends a frame.
                if state >> 61 == 0 {
                    0
                } else {
                    (state >> 33) as u8
                }
            })
            .collect();
        rig.line.write_all(&block).unwrap();
        left -= block.len();
    }
    let state = rig.telemetry();
    assert!(
        state.dropped_frames as usize > bytes / 20,
        "{}",
        state.dropped_frames
    );
    assert_eq!(rig.unit.faults().unwrap(), log, "nothing new");
    assert_eq!(rig.unit.identify().unwrap().table_crc, 2);
    assert_eq!(
        rig.unit
            .built_in_test()
            .unwrap()
            .without(Fault::Overrun.into()),
        FaultSet::NONE
    );
}

/// An update up to its activation, in small chunks.
fn upload(unit: &mut Unit, image: &[u8]) -> Result<(), Error> {
    let len = image.len() as u32;
    unit.ask(&Request::UploadBegin { len }, |_| Some(()))?;
    for (part, bytes) in image.chunks(64).enumerate() {
        let offset = part as u32 * 64;
        unit.ask(&Request::UploadChunk { offset, bytes }, |_| Some(()))?;
    }
    let crc = tempco_image::CRC.checksum(image);
    unit.command(&Request::UploadCommit { len, crc })?;
    let spare = unit.identify()?.spare;
    unit.command(&Request::Activate(spare))
}

#[test]
fn a_table_that_does_not_fit_the_board_is_refused_by_host_and_unit() {
    let mut rig = ready();
    let image = table_in(AxisUnit::Dph, 9);
    let error = flash_set(&mut rig.unit, &image, |_| panic!("written")).unwrap_err();
    let words = "is in deg/h, but the firmware of the unit was built for pulses/s";
    assert!(error.to_string().contains(words), "{error}");
    // The unit does not rely on its host.
    let error = upload(&mut rig.unit, &image).unwrap_err();
    let Error::Refused { refusal, .. } = error else {
        panic!("{error}")
    };
    assert_eq!(refusal, Refusal::Unit { axis: 0 });
    rig.machine.reset().unwrap();
    rig.unit.reconnect().unwrap();
    let identity = rig.unit.identify().unwrap();
    assert_eq!((identity.bank, identity.table_crc), (Some(Bank::B), 2));
}

/// `TEMPCO_BROWN_OUTS` says how many; the usual run makes a few.
#[test]
fn a_brown_out_at_any_instant_leaves_a_table() {
    let times = match std::env::var("TEMPCO_BROWN_OUTS") {
        Ok(times) => times.parse().unwrap(),
        Err(_) => 30,
    };
    let mut rig = ready();
    // How long an update takes on this host, which decides when to cut.
    let start = Instant::now();
    upload(&mut rig.unit, &quick_table(3)).unwrap();
    let mut whole_us = start.elapsed().as_micros() as u64;
    rig.machine.reset().unwrap();
    rig.unit.reconnect().unwrap();

    let mut newest = 3;
    let (mut old, mut new, mut idle) = (0, 0, 0);
    let mut state = 7_u64;
    for number in 0..times {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        let next = 4 + number;
        let image = quick_table(next);
        // From before the first request to behind the activation.
        let cut = Duration::from_micros((state >> 33) % (2 * whole_us));
        let uploaded = rig.cut_during(cut, |unit| upload(unit, &image));
        let identity = rig.unit.identify();
        let identity = identity.unwrap_or_else(|error| panic!("brown-out {number}: {error}"));
        assert!(
            identity.bank.is_some(),
            "after {number} brown-outs: no table"
        );
        if identity.table_crc == newest {
            old += 1;
        } else {
            assert_eq!(
                identity.table_crc, next,
                "neither the old table nor the new one"
            );
            new += 1;
        }
        idle += usize::from(uploaded.is_ok());
        // The host may be more or less busy than it was: half of the cuts are to come too late.
        if uploaded.is_ok() {
            whole_us -= whole_us / 8;
        } else {
            whole_us += whole_us / 8;
        }
        newest = identity.table_crc;
        if number % 500 == 499 {
            println!("{} brown-outs", number + 1);
        }
    }
    println!("{times} brown-outs: {old} old table, {new} new table, {idle} behind the activation");
    assert!(
        times < 30 || (old > 0 && new > 0),
        "{old} {new}: cut elsewhere"
    );
    let faults = rig.unit.built_in_test().unwrap();
    assert!(!faults.contains(Fault::NoTable) && !faults.contains(Fault::KnownAnswer));
}
