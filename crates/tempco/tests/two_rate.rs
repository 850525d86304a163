//! The two-rate pair: the bias between two updates of the temperature.

mod common;

use common::*;
use proptest::prelude::*;
use tempco::{Interval, Output, Status, TwoRateCompensator};

/// Gyro samples per update; fewer under Miri, which is slow.
const SAMPLES: u16 = if cfg!(miri) { 10 } else { 100 };
const RAW: [f32; 2] = [1.0, -2.0];

type Unit = TwoRateCompensator<'static, 2>;

fn started(samples_per_update: u16, temp_c: f32) -> Unit {
    let mut unit = TwoRateCompensator::new(&TABLE, samples_per_update);
    unit.start(temp_c);
    unit
}

fn take(unit: &mut Unit, count: usize) -> Vec<Output<2>> {
    (0..count).map(|_| compensate(unit, RAW)).collect()
}

/// A sample with all that can be asked about it.
fn compensate(unit: &mut Unit, raw: [f32; 2]) -> Output<2> {
    Output {
        compensated: unit.compensate(raw),
        bias: unit.bias(),
        point: unit.point(),
        status: unit.status() | Status::of_raw(&raw),
    }
}

/// A place where the table is steep, far from its reference, on a strong ramp.
fn temp(second: i32) -> f32 {
    52.0 + 0.4 * second as f32
}

#[test]
fn the_bias_ramps_linearly_to_that_of_the_single_rate() {
    let mut single = tempco::Compensator::new(&TABLE);
    let mut unit = started(SAMPLES, temp(0));
    single.start(temp(0));
    let mut before = compensate(&mut unit, RAW).bias;
    for second in 1..fewer(60, 10) as i32 {
        let point = unit.update(&SECOND, temp(second));
        let end = single.step(&SECOND, temp(second), RAW);
        assert_eq!(point, end.point);
        for (sample, out) in (1..).zip(take(&mut unit, SAMPLES.into())) {
            let part = sample as f32 / f32::from(SAMPLES);
            for axis in 0..2 {
                let line = before[axis] + part * (end.bias[axis] - before[axis]);
                assert!((out.bias[axis] - line).abs() < 2e-6, "{second}.{sample}");
                assert_eq!(out.compensated[axis], RAW[axis] - out.bias[axis]);
            }
            assert_eq!((out.point, out.status), (end.point, end.status));
            assert!(sample < SAMPLES || bits(&out) == bits(&end));
        }
        before = end.bias;
    }
}

#[test]
fn at_one_sample_per_update_it_is_the_single_rate() {
    for samples_per_update in [0, 1] {
        let mut single = tempco::Compensator::new(&TABLE);
        let mut unit = started(samples_per_update, 0.0);
        single.start(0.0);
        for second in 1..fewer(500, 50) as i32 {
            let temp = [temp(second % 90), f32::NAN][usize::from(second % 7 == 0)];
            unit.update(&SECOND, temp);
            let (out, end) = (compensate(&mut unit, RAW), single.step(&SECOND, temp, RAW));
            assert_eq!(bits(&out), bits(&end));
            assert_eq!(out.status, end.status);
        }
        assert_eq!(unit.thermal_state(), single.thermal_state());
    }
}

#[test]
fn where_the_update_is_late_the_bias_stays() {
    let mut unit = started(SAMPLES, temp(0));
    unit.update(&SECOND, temp(1));
    let end = *take(&mut unit, SAMPLES.into()).last().unwrap();
    for out in take(&mut unit, fewer(100_000, 100)) {
        assert_eq!(bits(&out), bits(&end));
    }
    unit.update(&SECOND, temp(2));
    let next = compensate(&mut unit, RAW);
    assert!((next.bias[0] - end.bias[0]).abs() < 0.1 / f32::from(SAMPLES));
}

#[test]
fn the_longest_ramp_is_as_straight_and_as_exact_as_a_short_one() {
    let samples = if cfg!(miri) { 301 } else { u16::MAX };
    let count = usize::from(samples);
    let mut unit = started(samples, 30.0);
    let start = compensate(&mut unit, RAW).bias;
    let end = TABLE.bias(&unit.update(&SECOND, 30.5)).0;
    let outs = take(&mut unit, count);
    for axis in 0..2 {
        let part = (end[axis] - start[axis]).abs() / count as f32;
        // The middle sample of an odd number lies half a part late.
        for (sample, expected) in [
            (0, start[axis]),
            (count / 2, 0.5 * (start[axis] + end[axis])),
            (count - 2, end[axis]),
        ] {
            let bias = outs[sample].bias[axis];
            let error = (bias - expected).abs();
            assert!(error < part + 1e-6, "{bias} for {expected} at {sample}");
        }
    }
    assert_eq!(outs[count - 1].bias, end);
}

#[test]
fn start_jumps_also_in_the_middle_of_a_ramp() {
    let mut unit = started(SAMPLES, temp(0));
    unit.update(&SECOND, temp(1));
    take(&mut unit, usize::from(SAMPLES / 3));
    unit.start(-20.0);
    let expected = compensate(&mut started(SAMPLES, -20.0), RAW);
    for out in take(&mut unit, usize::from(SAMPLES)) {
        assert_eq!(bits(&out), bits(&expected));
        assert_eq!(out.status, Status::SETTLING);
    }
}

/// A thermal task that died must not go unseen.
#[test]
fn an_update_that_is_overdue_by_a_period_is_flagged() {
    let mut unit = started(SAMPLES, 30.0);
    unit.update(&SECOND, 30.0);
    let period = usize::from(SAMPLES);
    let overdue = |out: &tempco::Output<2>| out.status.contains(Status::INTERVAL_INVALID);
    assert!(!take(&mut unit, 2 * period).iter().any(overdue));
    assert!(take(&mut unit, 20 * period).iter().all(overdue));
    unit.update(&SECOND, 30.0);
    assert!(!take(&mut unit, 2 * period).iter().any(overdue));
    assert_eq!(unit.thermal_state().rejected(), 0);
}

#[test]
fn before_any_temperature_the_constant_bias_is_applied() {
    let mut unit = TwoRateCompensator::new(&TABLE, SAMPLES);
    for out in take(&mut unit, 300) {
        assert_eq!(out.bias, constant_bias());
        assert!(out.status.contains(Status::TEMPERATURE_LOST));
    }
}

#[test]
fn an_invalid_gyro_sample_marks_only_itself() {
    let mut unit = started(SAMPLES, temp(0));
    unit.update(&SECOND, temp(1));
    let mut twin = unit.clone();
    let out = compensate(&mut unit, [f32::NAN, 5.0]);
    let good = compensate(&mut twin, [1.0, 5.0]);
    assert_eq!(out.bias, good.bias);
    assert!(out.compensated[0].is_nan());
    assert_eq!(out.compensated[1], good.compensated[1]);
    assert_eq!(out.status, good.status | Status::RAW_INVALID);
    for (one, two) in take(&mut unit, 250).iter().zip(take(&mut twin, 250)) {
        assert_eq!((bits(one), one.status), (bits(&two), two.status));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(300), failure_persistence: None, ..Default::default() })]

    /// Early, late or missing updates, good or bad temperatures: between two samples the bias
    /// moves by one part of what it has to move in the whole period.
    #[test]
    fn no_step_is_larger_than_the_change_over_the_samples(
        samples_per_update in prop_oneof![1_u16..50, Just(0), Just(u16::MAX)],
        updates in prop::collection::vec((0_usize..120, -70.0_f32..160.0, 0.0_f32..40.0), 1..30),
    ) {
        let mut unit = started(samples_per_update, 20.0);
        let mut before = compensate(&mut unit, RAW).bias;
        for (samples, temp, dt_s) in updates {
            let point = unit.update(&Interval::new(&THERMAL, dt_s), temp);
            let end = TABLE.bias(&point).0;
            let from = before;
            let period = f32::from(samples_per_update.max(1));
            for (sample, out) in (1..).zip(take(&mut unit, samples)) {
                for axis in 0..2 {
                    let change = (end[axis] - from[axis]).abs();
                    let scale = end[axis].abs().max(from[axis].abs());
                    let allowed = change / period + 4.0 * scale * f32::EPSILON;
                    let step = (out.bias[axis] - before[axis]).abs();
                    prop_assert!(step <= allowed, "{} of {}", step, allowed);
                    prop_assert!(sample as f32 != period || out.bias[axis] == end[axis]);
                }
                before = out.bias;
            }
        }
    }
}
