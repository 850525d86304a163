//! Gaps, duplicates and clocks that go back; gyro samples that are not numbers; temperatures
//! and rates beyond what was calibrated.

mod common;

use common::*;
use tempco::{Compensator, Interval, Status, Table, ThermalSettings, Validity};

const INTERVAL: Status = Status::INTERVAL_INVALID;
const RAW: [f32; 2] = [1.0, -2.0];

#[test]
fn a_gap_restarts_the_estimator_and_moves_no_further_than_the_limit_allows() {
    let limit_s = THERMAL.longest_interval_s();
    let on_ramp = on_ramp(30.0, 3.0);
    for &gap_s in first(&[limit_s + 0.01, f32::INFINITY, 300.0, 1e9], 2) {
        let gap = Interval::new(&THERMAL, gap_s);
        let mut unit = on_ramp.clone();
        let out = unit.step(&gap, 46.5, RAW);
        assert_eq!(out.status, INTERVAL | Status::SETTLING, "{gap_s} s");
        assert_eq!(out.point.rate_c_per_min, 0.0);
        let moved = out.point.effective_c - 30.0;
        assert!((moved - SLEW_C * limit_s).abs() < 1e-3, "{moved}");
        assert_eq!(unit.thermal_state().restarts(), 2);
        let after = feed(&mut unit, [46.5; SETTLE_S]);
        let (settling, last) = after.split_at(SETTLE_S - 1);
        assert!(settling.iter().all(|o| o.status == Status::SETTLING));
        assert_eq!(last[0].status, Status::OK);
    }
}

#[test]
fn the_longest_interval_is_used_as_it_is() {
    let interval = Interval::new(&THERMAL, THERMAL.longest_interval_s());
    let mut unit = settled(30.0);
    let out = unit.step(&interval, 40.0, RAW);
    assert_eq!(out.status, Status::OK);
    // 1 - exp(-1/2) of the lag, per half a minute.
    assert!((out.point.rate_c_per_min / 7.869_387 - 1.0).abs() < 1e-4);
    assert_eq!(unit.thermal_state().restarts(), 1);
}

/// A temperature without time is not used: a dead clock must not look like a ramp.
#[test]
fn without_time_nothing_moves_and_nothing_heals() {
    let settled = settled(40.0);
    for dt_s in [0.0, -0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
        let none = Interval::new(&THERMAL, dt_s);
        let mut unit = settled.clone();
        let mut twin = unit.clone();
        for step in 0..fewer(10_000, 50) {
            let temp = [40.0 + step as f32 * 1e-3, f32::NAN][step % 2];
            let out = unit.step(&none, temp, RAW);
            assert!(out.status.contains(INTERVAL | Status::SETTLING), "{dt_s} s");
            assert!(!out.status.contains(Status::TEMPERATURE_LOST));
            assert_eq!(out.point.effective_c, 40.0);
            assert_eq!(out.point.rate_c_per_min, 0.0);
        }
        let after = feed(&mut unit, [40.1; HEAL_S]);
        assert_eq!(bits(&after[0]), bits(&feed(&mut twin, [40.1])[0]));
        assert_eq!(after[HEAL_S - 2].status, Status::SETTLING);
        assert_eq!(after[HEAL_S - 1].status, Status::OK);
    }
}

#[test]
fn a_duplicate_on_a_ramp_leaves_the_rate_where_it_was() {
    let on_ramp = on_ramp(30.0, 3.0);
    for dt_s in [0.0, -1.0] {
        let mut unit = on_ramp.clone();
        let out = unit.step(&Interval::new(&THERMAL, dt_s), 30.0, RAW);
        assert_eq!(out.status, INTERVAL | Status::SETTLING);
        assert!((out.point.rate_c_per_min / 3.0 - 1.0).abs() < 0.01);
        let out = feed(&mut unit, [30.05])[0];
        assert!((out.point.rate_c_per_min / 3.0 - 1.0).abs() < 1e-3);
    }
}

/// The gap is remembered until there is a temperature to begin again with.
#[test]
fn a_gap_that_begins_with_a_bad_temperature_restarts_all_the_same() {
    let mut unit = on_ramp(30.0, 2.0);
    let out = unit.step(&Interval::new(&THERMAL, 40.0), f32::NAN, RAW);
    assert!(out.status.contains(INTERVAL | Status::TEMPERATURE_INVALID));
    let out = feed(&mut unit, [31.0])[0];
    assert_eq!(
        (out.point.rate_c_per_min, out.status),
        (0.0, Status::SETTLING)
    );
    assert_eq!(unit.thermal_state().restarts(), 2);
}

/// The hold time and what the part can have reached count the whole gap.
#[test]
fn an_hour_is_an_hour() {
    let hour = Interval::new(&THERMAL, 3600.0);
    let lost = settled(30.0).step(&hour, f32::NAN, RAW);
    assert!(lost.status.contains(Status::TEMPERATURE_LOST));
    let warmer = settled(30.0).step(&hour, 50.0, RAW);
    assert_eq!(warmer.status, INTERVAL | Status::SETTLING);
}

#[test]
fn an_invalid_gyro_sample_is_passed_through_and_touches_no_state() {
    let on_ramp = on_ramp(30.0, 3.0);
    let bads = [f32::NAN, f32::NEG_INFINITY, -f32::NAN, f32::INFINITY];
    for &bad in first(&bads, 2) {
        for axis in 0..2 {
            let mut unit = on_ramp.clone();
            let mut twin = on_ramp.clone();
            let mut raw = RAW;
            raw[axis] = bad;
            let out = unit.step(&SECOND, 30.05, raw);
            let good = twin.step(&SECOND, 30.05, RAW);
            assert_eq!(out.status, Status::RAW_INVALID);
            assert_eq!(out.status.validity(), Validity::Invalid);
            assert_eq!((out.bias, out.point), (good.bias, good.point));
            assert!(!out.compensated[axis].is_finite());
            assert_eq!(out.compensated[axis].is_nan(), bad.is_nan());
            assert_eq!(out.compensated[1 - axis], good.compensated[1 - axis]);
            for (out, good) in feed(&mut unit, [30.1; 50])
                .iter()
                .zip(feed(&mut twin, [30.1; 50]))
            {
                assert_eq!((bits(out), out.status), (bits(&good), Status::OK));
            }
        }
    }
}

#[test]
fn the_largest_and_smallest_gyro_samples_are_valid() {
    let mut unit = settled(30.0);
    for raw in [f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-45, -0.0] {
        let out = unit.step(&SECOND, 30.0, [raw; 2]);
        assert_eq!(out.status, Status::OK, "{raw}");
    }
}

#[test]
fn beyond_the_calibrated_range_the_bias_at_its_end_is_applied() {
    for (end, outside) in [
        (T_MAX, [80.1, 100.0, 150.0]),
        (T_MIN, [-40.1, -50.0, -60.0]),
    ] {
        let at_end = feed(&mut settled(end), [end])[0];
        assert_eq!(at_end.status, Status::OK);
        for &temp in first(&outside, 1) {
            let mut unit = Compensator::new(&TABLE);
            unit.start(temp);
            let out = *feed(&mut unit, [temp; SETTLE_S]).last().unwrap();
            assert_eq!(out.bias, at_end.bias, "{temp} degC");
            assert_eq!(out.status, Status::TEMPERATURE_CLAMPED);
            assert_eq!(out.status.validity(), Validity::Degraded);
        }
    }
}

#[test]
fn beyond_the_calibrated_rates_the_nearest_rate_is_applied() {
    let slow = thermal(ThermalSettings {
        rate_min_c_per_min: -0.5,
        rate_max_c_per_min: 0.25,
        ..SETTINGS
    });
    let table = table(slow);
    let rates = [(1.0, 0.25), (-0.4, -0.4), (-1.0, -0.5), (0.2, 0.2)];
    for &(rate, applied) in first(&rates, 2) {
        let mut unit = Compensator::new(&table);
        unit.start(20.0);
        let mut last = None;
        for s in 1..=900 {
            last = Some(unit.step(&SECOND, 20.0 + rate / 60.0 * s as f32, RAW));
        }
        let out = last.unwrap();
        let clamped = rate != applied;
        assert!((out.point.rate_c_per_min / applied - 1.0).abs() < 1e-3);
        assert!(!clamped || out.point.rate_c_per_min == applied);
        assert_eq!(
            out.status,
            [Status::OK, Status::RATE_CLAMPED][clamped as usize]
        );
    }
}

#[test]
fn a_narrower_calibrated_range_is_flagged_and_held() {
    let table: Table<'_, 2> = TABLE.calibrated(-12.0, 71.0).unwrap();
    for (temp, end) in [(-30.0, -12.0), (75.0, 71.0)] {
        let run = |temp| {
            let mut unit = Compensator::new(&table);
            unit.start(temp);
            (0..SETTLE_S).map(|_| unit.step(&SECOND, temp, RAW)).last()
        };
        let (out, at_end) = (run(temp).unwrap(), run(end).unwrap());
        assert_eq!(out.bias, at_end.bias);
        assert_eq!(at_end.status, Status::OK);
        assert_eq!(out.status, Status::TEMPERATURE_CLAMPED);
    }
}
