//! The application on the host: boot, tables, faults, link.

mod common;

use std::sync::atomic::{AtomicBool, Ordering};

use common::{Bench, SCHEDULE, image, image_of};
use tempco::{Status, Stream, Terms, Validity};
use tempco_firmware::board::mps2_an386::nor::{Nor, REGIONS};
use tempco_firmware::unit::devices::ResetCause;
use tempco_firmware::unit::{AXES, CHANNELS, Next, SERIAL};
use tempco_image::{Axis, CRC, Unit as AxisUnit};
use tempco_link::{
    Axes, Bank, BlockCrc, Channels, Fault, FaultSet, Refusal, Request, Response, Sample,
    SampleBlock,
};
use tempco_replay::{Replay, Sample as ReplayedSample};
use tempco_sensors::SensorFault;
use tempco_store::Offsets;

/// Time after which a unit has no more flags \[s\].
const SETTLED_S: f32 = 200.0;

fn only(fault: Fault) -> FaultSet {
    fault.into()
}

fn status(telemetry: &tempco_link::Telemetry) -> Status {
    Status::from_bits(telemetry.outcome.channels[0].status)
}

#[test]
fn a_unit_without_a_table_runs_uncompensated_and_says_so() {
    let mut bench = Bench::new();
    bench.counts.set(3);
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, 1.0);
        let telemetry = bench.telemetry(unit);
        assert_eq!(telemetry.faults, only(Fault::NoTable));
        assert!(telemetry.faults.is_invalidating());
        assert_eq!(status(&telemetry).validity(), Validity::Invalid);
        assert_eq!(telemetry.raw, [300.0; AXES], "counts at 100 Hz");
        assert_eq!(telemetry.outcome.compensated, telemetry.raw);
        let bank = bench.ask(unit, &Request::Identify, |response| match response {
            Response::Identity { bank, serial, .. } => (*bank, serial.to_string()),
            other => panic!("{other:?}"),
        });
        assert_eq!(bank, (None, SERIAL.to_string()));
        assert_eq!(
            bench.done(
                unit,
                &Request::ReZero {
                    averaging_s: 1,
                    expected: Axes::new()
                }
            ),
            Err(Refusal::Busy),
            "nothing to be zeroed"
        );
    });
}

#[test]
fn a_table_is_used_from_the_next_boot_on() {
    let mut bench = Bench::new();
    bench.boot(|bench, unit| {
        bench.connect(unit);
        assert_eq!(bench.upload(unit, &image("OTHER", 7)), Err(Refusal::Image));
        bench.upload(unit, &image(SERIAL, 7)).unwrap();
        bench.wait(unit, 0.2);
        assert!(bench.faults(unit).contains(Fault::NoTable), "not yet");
    });
    // It is stored, and not selected.
    bench.boot(|bench, unit| {
        bench.connect(unit);
        assert_eq!(in_use(bench, unit), (None, 0));
        bench.wait(unit, 0.2);
        assert_eq!(bench.faults(unit), only(Fault::NoTable));
        // The bank without a table is no choice, and then there is no reset.
        let empty = bench.done(unit, &Request::Activate(Bank::B));
        assert_eq!(empty, Err(Refusal::Store));
        bench.wait(unit, 0.2);
        // A unit resets once it has said that it will.
        let next = bench.ask_next(unit, &Request::Activate(Bank::A));
        assert_eq!(next, Next::Reset);
    });
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        let telemetry = bench.telemetry(unit);
        assert_eq!(telemetry.faults, FaultSet::NONE);
        assert_eq!(status(&telemetry), Status::OK);
        assert!(telemetry.outcome.bias.iter().all(|bias| *bias != 0.0));
        assert_eq!(telemetry.overruns, 0);
        // 10,000 of 12,500 counts are spent asleep in each pass.
        assert_eq!(telemetry.load_permille, 200);
        assert_eq!(telemetry.latency_ns, 17 * 40);
    });
}

/// Each fault of a sensor, what comes of it, and that it heals.
#[test]
fn faults_of_a_sensor_are_named_and_heal() {
    let script = [
        (Err(SensorFault::Open), Fault::SensorOpen),
        (Err(SensorFault::Short), Fault::SensorShort),
        (Err(SensorFault::Rail), Fault::SensorRail),
        (Err(SensorFault::Bus), Fault::SensorBus),
        // No news for long.
        (Err(SensorFault::NotReady), Fault::SensorBus),
        // A constant code; see the sensors of the bench.
        (Ok(1025.0), Fault::SensorStuck),
    ];
    let mut bench = Bench::with_tables();
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        for (count, (reading, fault)) in script.into_iter().enumerate() {
            bench.readings.borrow_mut()[0] = reading;
            bench.wait(unit, 7.0);
            let telemetry = bench.telemetry(unit);
            let expected = FaultSet::from(fault) | Fault::TemperatureRejected.into();
            assert_eq!(telemetry.faults, expected, "{fault:?}");
            assert_eq!(
                status(&telemetry).validity(),
                Validity::Degraded,
                "{fault:?}"
            );
            assert!(telemetry.temps_c[0].is_nan(), "{fault:?}");
            bench.wait(unit, 60.0);
            let telemetry = bench.telemetry(unit);
            assert!(
                telemetry.faults.contains(Fault::TemperatureLost),
                "{fault:?}"
            );
            assert_eq!(
                status(&telemetry).validity(),
                Validity::Invalid,
                "{fault:?}"
            );

            bench.readings.borrow_mut()[0] = Ok(25.0);
            bench.wait(unit, SETTLED_S);
            let telemetry = bench.telemetry(unit);
            assert_eq!(telemetry.faults, FaultSet::NONE, "{fault:?}");
            assert_eq!(status(&telemetry), Status::OK, "{fault:?}");
            let log = bench.log(unit);
            let logged = log.iter().find(|(logged, _)| *logged == fault).unwrap();
            // A bus that fails and a sensor without news are one fault.
            let times = if count == 4 { 2 } else { 1 };
            assert_eq!((logged.1.count, logged.1.boot), (times, 3), "{fault:?}");
        }
    });
}

#[test]
fn a_first_conversion_that_is_under_way_at_the_start_is_no_fault() {
    let mut bench = Bench::with_tables();
    bench.readings.borrow_mut()[0] = Err(SensorFault::NotReady);
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, 0.3);
        bench.readings.borrow_mut()[0] = Ok(25.0);
        bench.wait(unit, 10.0);
        let log = bench.log(unit);
        assert!(log.is_empty(), "{log:?}");
    });
}

/// Four of the ten samples of a period, at every phase of it.
#[test]
fn a_main_loop_that_is_late_by_less_than_half_a_period_loses_no_temperature() {
    let mut bench = Bench::with_tables();
    bench.boot(|bench, unit| {
        bench.connect(unit);
        for _ in 0..100 {
            bench.late.set(4);
            bench.wait(unit, 0.07);
        }
        assert_eq!(bench.telemetry(unit).rejected, 0);
        let log = bench.log(unit);
        assert!(log.is_empty(), "{log:?}");
    });
}

/// Ten seconds, in which the temperature moves further than it could in one update.
#[test]
fn a_main_loop_that_stalls_is_flagged_and_its_time_counts() {
    let mut bench = Bench::with_tables();
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        // One pass, which ends with the stall.
        bench.late.set(1000);
        bench.wait(unit, 0.01);
        bench.readings.borrow_mut()[0] = Ok(29.0);
        bench.wait(unit, 0.3);
        let telemetry = bench.telemetry(unit);
        assert!(telemetry.faults.contains(Fault::Starved));
        assert_eq!(telemetry.rejected, 0, "time has passed");
        bench.wait(unit, SETTLED_S);
        let telemetry = bench.telemetry(unit);
        assert_eq!(telemetry.faults, FaultSet::NONE);
        assert_eq!(status(&telemetry), Status::OK);
        // As much, but at once.
        bench.readings.borrow_mut()[0] = Ok(25.0);
        bench.wait(unit, 0.3);
        assert!(bench.telemetry(unit).rejected > 0);
    });
}

#[test]
fn temperatures_that_cannot_be_are_rejected() {
    let mut bench = Bench::with_tables();
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        for bad_c in [f32::NAN, f32::INFINITY, -200.0, 40.0] {
            bench.readings.borrow_mut()[0] = Ok(bad_c);
            bench.wait(unit, 0.2);
            bench.readings.borrow_mut()[0] = Ok(25.0);
            let telemetry = bench.telemetry(unit);
            assert_eq!(
                telemetry.faults,
                only(Fault::TemperatureRejected),
                "{bad_c}"
            );
            assert_eq!(status(&telemetry).validity(), Validity::Degraded, "{bad_c}");
            bench.wait(unit, SETTLED_S);
            assert_eq!(bench.faults(unit), FaultSet::NONE, "{bad_c}");
        }
        let telemetry = bench.telemetry(unit);
        assert!(telemetry.rejected >= 4);
        // Beyond the calibrated range, reached as a temperature can.
        for step in 0..80 {
            bench.readings.borrow_mut()[0] = Ok(25.0 + step as f32);
            bench.wait(unit, 2.5);
        }
        assert!(bench.faults(unit).contains(Fault::OutOfRange));
    });
}

#[test]
fn a_damaged_table_is_found_while_running_and_the_other_is_used_after() {
    let mut bench = Bench::with_tables();
    let damage = |bench: &Bench, place: usize| {
        bench.flash[place / 4].fetch_xor(0x10, Ordering::Relaxed);
    };
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, 5.0);
        assert!(!bench.faults(unit).contains(Fault::SpareTable));
    });
    damage(&bench, 0x8000 + 900);
    let active = |bench: &mut Bench| {
        bench.boot(|bench, unit| {
            bench.connect(unit);
            let faults = bench.ask(unit, &Request::Bit, |response| match response {
                Response::Bit { faults } => *faults,
                other => panic!("{other:?}"),
            });
            let identity = bench.ask(unit, &Request::Identify, |response| match response {
                Response::Identity {
                    bank, table_crc, ..
                } => (*bank, *table_crc),
                other => panic!("{other:?}"),
            });
            (faults, identity)
        })
    };
    assert_eq!(
        active(&mut bench),
        (only(Fault::SpareTable), (Some(Bank::A), 0xa))
    );
    damage(&bench, 900);
    let expected = only(Fault::SpareTable) | only(Fault::NoTable);
    assert_eq!(active(&mut bench), (expected, (None, 0)));
    // Anything at all in the flash: it boots.
    for cell in bench.flash.iter() {
        cell.store(0x5a5a_5a5a, Ordering::Relaxed);
    }
    assert_eq!(active(&mut bench), (only(Fault::NoTable), (None, 0)));
}

#[test]
fn the_periodic_check_finds_damage_in_the_table_in_use() {
    let mut bench = Bench::with_tables();
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, 1.0);
        bench.flash[(0x8000 + 900) / 4].fetch_xor(4, Ordering::Relaxed);
        bench.wait(unit, 5.0);
        let telemetry = bench.telemetry(unit);
        assert!(telemetry.faults.contains(Fault::SpareTable));
        let log = bench.log(unit);
        let logged = log.iter().find(|(fault, _)| *fault == Fault::SpareTable);
        assert_eq!(logged.unwrap().1.detail, 1, "slot B");
        // What was loaded and validated at boot is what runs.
        assert!(!telemetry.faults.is_invalidating());
    });
}

#[test]
fn roll_back_is_a_selection_and_a_boot() {
    let mut bench = Bench::with_tables();
    let bank = |bench: &mut Bench| {
        bench.boot(|bench, unit| {
            bench.connect(unit);
            let bank = bench.ask(unit, &Request::Identify, |response| match response {
                Response::Identity { bank, .. } => *bank,
                other => panic!("{other:?}"),
            });
            let whole = image(SERIAL, 0xa);
            let mut found = Vec::new();
            while found.len() < whole.len() {
                let request = Request::Download {
                    bank: Bank::A,
                    offset: found.len() as u32,
                    len: 200,
                };
                let more = bench.ask(unit, &request, |response| match response {
                    Response::Chunk { bytes, .. } => bytes.to_vec(),
                    other => panic!("{other:?}"),
                });
                found.extend(more);
            }
            assert_eq!(found, whole);
            bench.done(unit, &Request::Activate(Bank::A)).unwrap();
            bank
        })
    };
    assert_eq!(bank(&mut bench), Some(Bank::B));
    assert_eq!(bank(&mut bench), Some(Bank::A));
}

#[test]
fn re_zero_takes_out_what_is_left_at_rest_and_is_kept() {
    let mut bench = Bench::with_tables();
    bench.counts.set(1);
    let expected = Axes::from_slice(&[10.0; AXES]).unwrap();
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        let request = Request::ReZero {
            averaging_s: 20,
            expected: expected.clone(),
        };
        bench.done(unit, &request).unwrap();
        assert_eq!(bench.done(unit, &request), Err(Refusal::Busy));
        bench.wait(unit, 21.0);
        // Again, of what is left now: next to nothing.
        bench.done(unit, &request).unwrap();
        bench.wait(unit, 21.0);
    });
    // Kept over a reset, and never on top of itself.
    for _ in 0..2 {
        bench.boot(|bench, unit| {
            bench.connect(unit);
            bench.wait(unit, SETTLED_S);
            bench.telemetry(unit);
            bench.wait(unit, 1.0);
            let telemetry = bench.telemetry(unit);
            for (compensated, offset) in telemetry.outcome.compensated.iter().zip(&telemetry.offset)
            {
                assert!((compensated - 10.0).abs() < 1e-3, "{compensated}");
                assert!((offset - 90.0).abs() < 1.0, "{offset}");
            }
        });
    }
    // Another table leaves another bias: its offsets are its own.
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.update(unit, &image(SERIAL, 0xc)).unwrap();
    });
    bench.boot(|bench, unit| {
        bench.connect(unit);
        assert_eq!(bench.telemetry(unit).offset, [0.0; AXES]);
    });
}

/// The fault log's entry of the last re-zero that was given up.
fn given_up(bench: &mut Bench, unit: &mut dyn common::Running) -> Option<(u32, u32)> {
    let log = bench.log(unit);
    let entry = log.into_iter().find(|(fault, _)| *fault == Fault::ReZero);
    entry.map(|(_, entry)| (entry.count, entry.detail))
}

/// Whatever happens while a re-zero averages, at any time of it: the offsets stay as they were.
#[test]
fn re_zero_is_given_up_unless_the_unit_is_valid_and_at_rest() {
    let mut bench = Bench::with_tables();
    bench.counts.set(1);
    let at_rest = Axes::from_slice(&[10.0; AXES]).unwrap();
    let request = |expected: &Axes| Request::ReZero {
        averaging_s: 10,
        expected: expected.clone(),
    };
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        bench.done(unit, &request(&at_rest)).unwrap();
        bench.wait(unit, 11.0);
        let before = bench.telemetry(unit).offset.clone();
        assert!(before.iter().all(|offset| (offset - 90.0).abs() < 1.0));
        assert_eq!(given_up(bench, unit), None);

        let absurd = |value: f32| Axes::from_slice(&[value, 10.0, 10.0]).unwrap();
        let mut times = 0;
        for (expected, spoil, reason) in [
            (absurd(1e30), None, 3),
            (absurd(-1e30), None, 3),
            (absurd(-200.0), None, 3),
            // Two hundred counts a sample, from the beginning on or for the last second.
            (at_rest.clone(), Some((0.0, 200)), 3),
            (at_rest.clone(), Some((9.0, 200)), 2),
            (at_rest.clone(), Some((9.0, 3)), 2),
        ] {
            let (from_s, counts) = spoil.unwrap_or((0.0, 1));
            if from_s == 0.0 {
                bench.counts.set(counts);
            }
            bench.done(unit, &request(&expected)).unwrap();
            bench.wait(unit, from_s);
            bench.counts.set(counts);
            bench.wait(unit, 11.0 - from_s);
            bench.counts.set(1);
            let telemetry = bench.telemetry(unit);
            assert_eq!(telemetry.offset, before, "{expected:?} {spoil:?}");
            assert!(telemetry.faults.contains(Fault::ReZero), "{spoil:?}");
            times += 1;
            assert_eq!(given_up(bench, unit), Some((times, reason << 16)));
        }

        // A sensor that opens for a moment, at the beginning, in the middle, at the end.
        for open_s in [0.1, 5.0, 9.8] {
            bench.done(unit, &request(&at_rest)).unwrap();
            bench.wait(unit, open_s);
            bench.readings.borrow_mut()[0] = Err(SensorFault::Open);
            bench.wait(unit, 0.2);
            bench.readings.borrow_mut()[0] = Ok(25.0);
            bench.wait(unit, 11.0);
            let telemetry = bench.telemetry(unit);
            assert_eq!(telemetry.offset, before, "{open_s}");
            times += 1;
            let (count, detail) = given_up(bench, unit).unwrap();
            assert_eq!((count, detail >> 16), (times, 1), "{open_s}");
            bench.wait(unit, SETTLED_S);
        }

        // One that goes well takes the fault away.
        assert!(bench.faults(unit).contains(Fault::ReZero));
        bench.done(unit, &request(&at_rest)).unwrap();
        bench.wait(unit, 11.0);
        assert_eq!(bench.faults(unit), FaultSet::NONE);
    });
}

#[test]
fn offsets_can_be_cleared() {
    let mut bench = Bench::with_tables();
    bench.counts.set(1);
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        let request = Request::ReZero {
            averaging_s: 2,
            expected: Axes::new(),
        };
        bench.done(unit, &request).unwrap();
        let clear = Request::ClearOffsets;
        assert_eq!(bench.done(unit, &clear), Err(Refusal::Busy));
        bench.wait(unit, 3.0);
        assert!(bench.telemetry(unit).offset[0] > 50.0);
        bench.done(unit, &clear).unwrap();
        bench.wait(unit, 1.0);
        bench.telemetry(unit);
        bench.wait(unit, 1.0);
        let telemetry = bench.telemetry(unit);
        assert_eq!(telemetry.offset, [0.0; AXES]);
        let outcome = &telemetry.outcome;
        assert!((telemetry.raw[0] - outcome.bias[0] - outcome.compensated[0]).abs() < 1e-3);
    });
    bench.boot(|bench, unit| {
        bench.connect(unit);
        assert_eq!(bench.telemetry(unit).offset, [0.0; AXES], "for good");
    });
}

/// As an older version may have stored them.
#[test]
fn stored_offsets_beyond_the_limit_are_not_used() {
    let mut bench = Bench::with_tables();
    for stored in [1e30, -201.0] {
        let mut flash = Nor(&bench.flash);
        let mut offsets = Offsets::open(&mut flash, REGIONS.offsets).unwrap();
        let all = [0.0, stored, 0.0, 0.0, 0.0, 0.0];
        offsets.set(&mut flash, 0xb, all).unwrap();
        bench.boot(|bench, unit| {
            bench.connect(unit);
            let telemetry = bench.telemetry(unit);
            assert_eq!(telemetry.offset, [0.0; AXES]);
            assert!(telemetry.faults.contains(Fault::ReZero));
            assert_eq!(given_up(bench, unit).unwrap().1, 3 << 16 | 1);
        });
    }
}

#[test]
fn a_wrong_known_answer_stays_until_a_commanded_test_finds_the_right_one() {
    static IS_RIGHT: AtomicBool = AtomicBool::new(false);
    let mut bench = Bench::with_tables();
    bench.knows_the_answer = || IS_RIGHT.load(Ordering::Relaxed);
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        let telemetry = bench.telemetry(unit);
        assert_eq!(telemetry.faults, only(Fault::KnownAnswer));
        assert!(telemetry.faults.is_invalidating());
        let test = |bench: &mut Bench, unit: &mut dyn common::Running| {
            bench.ask(unit, &Request::Bit, |response| match response {
                Response::Bit { faults } => *faults,
                other => panic!("{other:?}"),
            })
        };
        assert_eq!(test(bench, unit), only(Fault::KnownAnswer));
        bench.wait(unit, 10.0);
        assert_eq!(bench.faults(unit), only(Fault::KnownAnswer));
        IS_RIGHT.store(true, Ordering::Relaxed);
        bench.wait(unit, 10.0);
        assert_eq!(bench.faults(unit), only(Fault::KnownAnswer));
        assert_eq!(test(bench, unit), FaultSet::NONE);
    });
}

#[test]
fn telemetry_is_of_samples_and_its_time_increases() {
    let mut bench = Bench::with_tables();
    bench.counts.set(2);
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        let request = Request::Telemetry { period_ms: 100 };
        let mut times = Vec::new();
        let mut all = Vec::new();
        // Questions at every phase of the period, several in a row too.
        for number in 0..40_u8 {
            for _ in 0..=number % 3 {
                all.extend(bench.ask(unit, &request, |response| match response {
                    Response::Telemetry(telemetry) => Some(telemetry.clone()),
                    _ => None,
                }));
            }
            all.extend(bench.unasked(unit, 0.01 * f32::from(number)));
        }
        assert!(all.len() > 100);
        for telemetry in all {
            times.push((telemetry.index, telemetry.uptime_ms));
            assert_eq!(telemetry.raw, [200.0; AXES]);
            assert!(telemetry.outcome.bias.iter().all(|bias| *bias != 0.0));
        }
        for pair in times.windows(2) {
            assert!(pair[0].0 < pair[1].0 && pair[0].1 < pair[1].1, "{pair:?}");
        }
    });
}

/// Whole counts that come now and then: a message of a sample more or less would show.
#[test]
fn telemetry_is_of_as_many_samples_as_its_period_has() {
    let mut bench = Bench::with_tables();
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        let request = Request::Telemetry { period_ms: 100 };
        bench.ask(unit, &request, |_| Some(()));
        let mut all = Vec::new();
        for step in 0..500 {
            bench.counts.set((step % 10 == 0).into());
            all.extend(bench.unasked(unit, 1.0 / SCHEDULE.sample_rate_hz));
        }
        assert!(all.len() >= 20, "{}", all.len());
        for telemetry in all {
            assert_eq!(telemetry.raw, [0.1 * SCHEDULE.sample_rate_hz; AXES]);
        }
    });
}

#[test]
fn periods_without_an_interrupt_are_counted_and_time_goes_on() {
    let mut bench = Bench::with_tables();
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        let before = bench.telemetry(unit);
        let mut missed = 0;
        for held in [1, 2, 5, 100, 400, 1] {
            bench.held.set(held);
            missed += held;
            bench.wait(unit, 1.0);
        }
        let after = bench.telemetry(unit);
        let samples = after.samples - before.samples;
        let periods = (after.uptime_ms - before.uptime_ms) / 10;
        assert_eq!(periods, samples + missed);
        assert_eq!(after.overruns, missed);
        assert!(after.faults.contains(Fault::Overrun));
        let losses = bench.ask(unit, &Request::Losses, |response| match response {
            Response::Losses(losses) => *losses,
            other => panic!("{other:?}"),
        });
        assert_eq!((losses.missed_samples, losses.moments), (missed, 0));
        // More moments than can wait are lost to telemetry, not to the output.
        bench.late.set(199);
        bench.wait(unit, 1.0);
        let losses = bench.ask(unit, &Request::Losses, |response| match response {
            Response::Losses(losses) => *losses,
            other => panic!("{other:?}"),
        });
        assert_eq!((losses.missed_samples, losses.moments), (missed, 200 - 127));
    });
}

/// Images of cells with a bias and axes in a unit, with a scale factor.
fn image_with(unit: AxisUnit, scale_factor_arcsec: f32, bias: f32, table_crc: u32) -> Vec<u8> {
    let axis = Axis {
        scale_factor_arcsec,
        ..Axis::new(unit)
    };
    let flat = Terms::new([], []);
    let cells = [flat, flat, Terms::new([bias], [])];
    image_of(SERIAL, table_crc, &[axis; AXES], &cells)
}

#[test]
fn the_unit_states_which_tables_fit_it() {
    use AxisUnit::{Dph, Dps, PulsesPerS, Radps};
    for (unit, max_bias) in [
        (PulsesPerS, 50.0),
        (Dph, 25.0),
        (Dps, 25.0 / 3600.0),
        (Radps, 25.0 * std::f32::consts::PI / 648_000.0),
    ] {
        let mut bench = Bench::new();
        bench.units = [[unit; AXES]; CHANNELS];
        bench.boot(|bench, running| {
            bench.connect(running);
            bench.ask(running, &Request::Identify, |response| match response {
                Response::Identity {
                    scale_factor_arcsec,
                    units,
                    max_bias: found,
                    ..
                } => {
                    assert_eq!(*scale_factor_arcsec, 0.5);
                    assert_eq!(units[..], [unit.code(); AXES]);
                    let near = |found: &f32| (found - max_bias).abs() < 1e-6 * max_bias;
                    assert!(found.len() == AXES && found.iter().all(near), "{found:?}");
                }
                other => panic!("{other:?}"),
            });
        });
    }
}

/// What of a table does not fit, as the unit refuses it, and as the fault log says at a boot.
#[test]
fn a_table_that_does_not_fit_the_board_is_not_taken() {
    use AxisUnit::{Dph, Dps, G, Mps2, PulsesPerS, Radps};
    for (board, of_image, scale_factor, bias, refused) in [
        (
            PulsesPerS,
            Dph,
            0.5,
            1.0,
            Some((Refusal::Unit { axis: 0 }, 1)),
        ),
        (
            Dph,
            PulsesPerS,
            0.0,
            1.0,
            Some((Refusal::Unit { axis: 0 }, 1)),
        ),
        (Mps2, Mps2, 0.0, 1.0, Some((Refusal::Unit { axis: 0 }, 1))),
        (G, G, 0.0, 1.0, Some((Refusal::Unit { axis: 0 }, 1))),
        (
            Dph,
            Dph,
            0.0,
            1.0,
            Some((Refusal::ScaleFactor { axis: 0 }, 2)),
        ),
        (
            Dps,
            Dps,
            0.25,
            1e-3,
            Some((Refusal::ScaleFactor { axis: 0 }, 2)),
        ),
        (
            Dph,
            Dph,
            0.500_001,
            1.0,
            Some((Refusal::ScaleFactor { axis: 0 }, 2)),
        ),
        (
            PulsesPerS,
            PulsesPerS,
            0.0,
            50.1,
            Some((Refusal::Bias { axis: 2 }, 3)),
        ),
        (
            PulsesPerS,
            PulsesPerS,
            0.0,
            -50.1,
            Some((Refusal::Bias { axis: 2 }, 3)),
        ),
        (Dph, Dph, 0.5, 25.1, Some((Refusal::Bias { axis: 2 }, 3))),
        (PulsesPerS, PulsesPerS, 3.0, 50.0, None),
        (Dph, Dph, 0.500_000_06, -25.0, None),
        (Dps, Dps, 0.5, 6e-3, None),
        (Radps, Radps, 0.5, 1e-4, None),
    ] {
        let image = image_with(of_image, scale_factor, bias, 7);
        let mut bench = Bench::new();
        bench.units = [[board; AXES]; CHANNELS];
        let found = bench.boot(|bench, unit| {
            bench.connect(unit);
            bench.upload(unit, &image)
        });
        let expected = refused.map_or(Ok(()), |(refusal, _)| Err(refusal));
        assert_eq!(found, expected, "{of_image:?} {scale_factor} {bias}");

        // Accelerations fit no board, so there is no good table beside it.
        let Some((_, reason)) = refused.filter(|_| !matches!(board, Mps2 | G)) else {
            continue;
        };
        // A good one in A, and the same table in B, where another firmware has left it.
        let good = |table_crc| image_with(board, 0.5, 1e-4, table_crc);
        bench.boot(|bench, unit| {
            bench.connect(unit);
            bench.update(unit, &good(0xa)).unwrap();
        });
        bench.load(&image);
        bench.boot(|bench, unit| {
            bench.connect(unit);
            assert_eq!(in_use(bench, unit), (Some(Bank::A), 0xa));
            // No check of its CRCs finds it good.
            bench.wait(unit, SETTLED_S);
            assert_eq!(bench.faults(unit), only(Fault::SpareTable));
            let log = bench.log(unit);
            let entry = log.iter().find(|(fault, _)| *fault == Fault::SpareTable);
            let axis = if reason == 3 { 2 } else { 0 };
            assert_eq!(entry.unwrap().1.detail, reason << 16 | axis << 8 | 1);
            // Nor is it taken on command.
            let select = bench.done(unit, &Request::Activate(Bank::B));
            assert_eq!(select, Err(refused.unwrap().0));
            bench.upload(unit, &good(0xb)).unwrap();
            bench.wait(unit, 5.0);
            assert_eq!(bench.faults(unit), FaultSet::NONE);
            bench.done(unit, &Request::Activate(Bank::B)).unwrap();
        });
        bench.boot(|bench, unit| {
            bench.connect(unit);
            assert_eq!(in_use(bench, unit), (Some(Bank::B), 0xb));
        });
    }
}

/// With no other table, the unit runs uncompensated.
#[test]
fn two_tables_that_do_not_fit_are_none() {
    let mut bench = Bench::with_tables();
    bench.units = [[AxisUnit::Dph; AXES]; CHANNELS];
    bench.boot(|bench, unit| {
        bench.connect(unit);
        assert_eq!(in_use(bench, unit), (None, 0));
        bench.wait(unit, 5.0);
        let expected = only(Fault::NoTable) | only(Fault::SpareTable);
        assert_eq!(bench.faults(unit), expected);
    });
}

/// Bank and CRC of the table in use.
fn in_use(bench: &mut Bench, unit: &mut dyn common::Running) -> (Option<Bank>, u32) {
    bench.ask(unit, &Request::Identify, |response| match response {
        Response::Identity {
            bank, table_crc, ..
        } => (*bank, *table_crc),
        other => panic!("{other:?}"),
    })
}

#[test]
fn replays_are_those_of_the_host() {
    let mut bench = Bench::with_tables();
    bench.boot(|bench, unit| {
        bench.connect(unit);
        let whole = image(SERIAL, 0xb);
        let mut place = tempco_image::AlignedBytes([0; tempco_firmware::unit::IMAGE_LEN]);
        place.0[..whole.len()].copy_from_slice(&whole);
        let read = tempco_image::Image::read(&place.0).unwrap();
        let tables = read.tables::<CHANNELS, AXES>().unwrap();
        for _ in 0..2 {
            bench.done(unit, &Request::Restart).unwrap();
            let mut rows = Replay::new(&tables);
            let mut stream = Stream::new(&tables, &SCHEDULE);
            for number in 0..40_u8 {
                let temps_c = [20.0 + f32::from(number)];
                let raw = [[f32::from(number), 0.5, f32::NAN]];
                // Every third row is no thermal update.
                let update_s = (number % 3 != 1).then_some(1.0);
                let sample = ReplayedSample {
                    update_s,
                    temps_c,
                    raw,
                };
                let expected = rows.step(&sample).channels[0];
                let request = Request::Sample(Sample {
                    update_s,
                    temps_c: temps_c.into_iter().collect(),
                    raw: raw[0].into_iter().collect(),
                });
                bench.ask(unit, &request, |response| {
                    let Response::Outcome(outcome) = response else {
                        panic!("{response:?}")
                    };
                    assert_eq!(outcome.compensated[..2], expected.compensated[..2]);
                    assert_eq!(outcome.bias, expected.bias);
                });

                let block: Vec<[f32; 3]> = (0..80_u8).map(|i| [f32::from(i), -1.0, 2.0]).collect();
                let mut bytes: Vec<u8> = Vec::new();
                stream.temperatures(&temps_c);
                let mut last = None;
                let mut crc = BlockCrc::default();
                for raw in &block {
                    let outcome = stream.sample(&[*raw]);
                    crc.add(outcome[0].status.bits().into(), &outcome[0].bias);
                    bytes.extend(outcome[0].compensated.iter().flat_map(|v| v.to_le_bytes()));
                    last = Some(outcome);
                }
                let raw: Vec<u8> = block
                    .iter()
                    .flatten()
                    .flat_map(|v| v.to_le_bytes())
                    .collect();
                let counts: Vec<u8> = block.iter().flatten().map(|v| *v as i8 as u8).collect();
                let are_counts = number % 3 == 0;
                let request = Request::Block(SampleBlock {
                    temps_c: temps_c.into_iter().collect(),
                    real_time: number % 2 == 0,
                    scale: are_counts.then_some(1.0),
                    raw: if are_counts { &counts } else { &raw },
                });
                bench.ask(unit, &request, |response| {
                    let Response::Block(found) = response else {
                        panic!("{response:?}")
                    };
                    assert_eq!(found.compensated, bytes);
                    assert_eq!(found.bias, last.unwrap()[0].bias);
                    assert_eq!(found.crc, crc.finish());
                });
            }
        }
        // Bad blocks are refused whole.
        for (temps_c, raw) in [(2, 12), (0, 0), (0, 13), (1, 972)] {
            let request = SampleBlock {
                temps_c: Channels::from_slice(&[1.0, 2.0][..temps_c]).unwrap(),
                real_time: false,
                scale: None,
                raw: &[0; 972][..raw],
            };
            let refused = bench.ask(unit, &Request::Block(request), |response| {
                matches!(response, Response::Refused(Refusal::Unknown))
            });
            assert!(refused, "{temps_c} {raw}");
        }
        assert_eq!(bench.telemetry(unit).overruns, 0);
    });
}

#[test]
fn garbage_on_the_line_costs_itself() {
    let mut bench = Bench::with_tables();
    bench.boot(|bench, unit| {
        bench.connect(unit);
        bench.wait(unit, SETTLED_S);
        let mut state = 1_u32;
        for _ in 0..2000 {
            let garbage: Vec<u8> = (0..100)
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (state >> 24) as u8
                })
                .collect();
            bench.send(&garbage);
            bench.wait(unit, 0.03);
        }
        bench.send(&[0]);
        bench.wait(unit, 0.1);
        let telemetry = bench.telemetry(unit);
        assert!(
            telemetry.dropped_frames > 500,
            "{}",
            telemetry.dropped_frames
        );
        assert_eq!(telemetry.faults, FaultSet::NONE);
        assert_eq!(telemetry.overruns, 0);
    });
}

#[test]
fn why_the_unit_was_reset_is_in_the_log() {
    let mut bench = Bench::with_tables();
    for (cause, crash, fault, detail) in [
        (ResetCause::Watchdog, None, Fault::WatchdogReset, 0),
        (ResetCause::BrownOut, None, Fault::BrownOut, 0),
        (ResetCause::Commanded, Some(0x1234), Fault::Crash, 0x1234),
    ] {
        bench.boot_after(cause, crash, |bench, unit| {
            bench.connect(unit);
            bench.wait(unit, 3.0);
            assert!(
                bench.faults(unit).contains(fault),
                "it stays until the next reset"
            );
        });
        bench.boot(|bench, unit| {
            bench.connect(unit);
            bench.wait(unit, 1.0);
            assert!(!bench.faults(unit).contains(fault));
            let log = bench.log(unit);
            let logged = log.iter().find(|(logged, _)| *logged == fault).unwrap();
            assert_eq!((logged.1.count, logged.1.detail), (1, detail), "{fault:?}");
        });
    }
}

/// Whichever of the two records of the boot cannot be read, and however many sessions a boot has.
#[test]
fn numbers_of_sessions_and_boots_never_come_again() {
    let mut bench = Bench::with_tables();
    let mut last = (0, 0);
    for round in 0..12_usize {
        // Both are there after each boot, so that one of them may be lost before the next.
        let spoilt = match round % 3 {
            0 => None,
            1 => Some(REGIONS.faults),
            _ => Some(REGIONS.offsets),
        };
        if let Some(region) = spoilt {
            let words = region.start as usize / 4..(region.start + region.len) as usize / 4;
            for cell in &bench.flash[words] {
                cell.store(0x5a5a_5a5a, Ordering::Relaxed);
            }
        }
        last = bench.boot_after(ResetCause::Watchdog, None, |bench, unit| {
            let (mut session, boot) = last;
            for nonce in 0..if round % 2 == 0 { 600 } else { 1 } {
                let next = bench.open_session(unit, nonce);
                assert!(next > session, "{round}: {next} after {session}");
                session = next;
            }
            let log = bench.log(unit);
            let reset = log.iter().find(|(fault, _)| *fault == Fault::WatchdogReset);
            let found = reset.unwrap().1.boot;
            assert!(found > boot, "{round}: {found} after {boot}");
            (session, found)
        });
    }
    assert_eq!(last.1, 14, "twelve boots after two");
}

/// A fault log that has had its erasures: the unit says so, counts on, and erases no more.
#[test]
fn a_worn_fault_log_is_written_no_more() {
    let mut bench = Bench::with_tables();
    let first = REGIONS.faults.start as usize / 4;
    let words = REGIONS.faults.len as usize / 4;
    let log = &bench.flash[first..first + words];
    for cell in log {
        cell.store(u32::MAX, Ordering::Relaxed);
    }
    let mark = [u32::from_le_bytes(*b"TCF3"), u32::MAX, 19_999, 0, 0, 0, 0];
    let crc = CRC.checksum(&mark.map(u32::to_le_bytes).concat());
    for (cell, word) in log.iter().zip(mark.into_iter().chain([crc])) {
        cell.store(word, Ordering::Relaxed);
    }
    let used = |bench: &Bench| {
        let cells = bench.flash[first..first + words].iter();
        let cells = cells.map(|cell| cell.load(Ordering::Relaxed));
        cells.filter(|word| *word != u32::MAX).count()
    };
    let mut before = 0;
    let mut boots = 0;
    for _ in 0..200 {
        bench.boot(|bench, unit| {
            bench.connect(unit);
            bench.wait(unit, 0.2);
            assert_eq!(bench.faults(unit), FaultSet::from(Fault::LogWorn));
            let log = bench.log(unit);
            let (_, entry) = log
                .iter()
                .find(|(fault, _)| *fault == Fault::LogWorn)
                .unwrap();
            assert_eq!(entry.detail, 10_000);
            let wear = bench.ask(unit, &Request::Wear, |response| match response {
                Response::Wear(wear) => *wear,
                other => panic!("{other:?}"),
            });
            assert_eq!(wear.faults, 10_000);
            // A half has the entries of 100 boots.
            assert_eq!(wear.offsets, 1 + boots / 202);
            assert!(entry.boot > boots, "boots are counted elsewhere");
            boots = entry.boot;
        });
        assert!(used(&bench) >= before, "never erased");
        before = used(&bench);
    }
    assert!(before < words / 2, "nothing in the other half");
    assert_eq!(boots, 202);
}

/// Time since power-on at which the unit first answers, less the resolution \[s\].
fn answers_after_s(bench: &mut Bench, cause: ResetCause, runs_s: f32) -> u32 {
    bench.boot_after(cause, None, |bench, unit| {
        bench.connect(unit);
        let telemetry = bench.telemetry(unit);
        assert_eq!(telemetry.overruns, 0);
        bench.wait(unit, runs_s);
        telemetry.uptime_ms / 1000
    })
}

#[test]
fn a_boot_waits_longer_after_each_reset_that_nobody_wanted() {
    use ResetCause::{Commanded, Watchdog};
    let mut bench = Bench::with_tables();
    for expected_s in [0, 0, 1, 2, 4, 8, 16, 32, 64, 64] {
        let found_s = answers_after_s(&mut bench, Watchdog, 1.0);
        assert_eq!(found_s, expected_s);
    }
    // A boot that others have wanted ends it, and one that has run for ten minutes.
    assert_eq!(answers_after_s(&mut bench, Commanded, 1.0), 0);
    for runs_s in [1.0, 1.0, 601.0, 1.0, 1.0] {
        let found_s = answers_after_s(&mut bench, Watchdog, runs_s);
        assert_eq!(found_s, u32::from(runs_s > 600.0));
    }
}

#[test]
fn the_watchdog_is_fed_twice_a_second() {
    let mut bench = Bench::new();
    let fed = bench.fed.clone();
    bench.boot(|bench, unit| {
        bench.wait(unit, 10.0);
        assert!((18..=20).contains(&fed.get()), "{}", fed.get());
    });
}
