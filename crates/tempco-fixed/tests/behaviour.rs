//! The behaviours that the f32 core's tests name, of the integer core.

mod common;

use common::*;
use tempco::{Status, Validity};
use tempco_fixed::{FixedInterval, FixedThermalState, FixedTwoRate, INVALID, from_f32};

const BAD: Status = Status::TEMPERATURE_INVALID;
const SPIKE: Status = Status::TEMPERATURE_SPIKE;
const LOST: Status = Status::TEMPERATURE_LOST;
const SETTLING: Status = Status::SETTLING;

#[test]
fn an_unusable_temperature_holds_the_last_good_one_and_heals() {
    let below = from_f32(SETTINGS.sensor_min_c) - 1;
    let above = from_f32(SETTINGS.sensor_max_c) + 1;
    for broken in [INVALID, i32::MAX, i32::MIN + 1, below, above] {
        let mut unit = settled(40.0);
        let before = feed(&mut unit, [40.0])[0];
        let out = unit.step(&SECOND, broken, RAW);
        assert_eq!(
            (out.bias, out.compensated),
            (before.bias, before.compensated)
        );
        assert_eq!(out.status, BAD | SETTLING, "{broken}");
        assert_eq!(out.status.validity(), Validity::Degraded);
        for (second, out) in (1..).zip(feed(&mut unit, [40.0; HEAL_S + 5])) {
            let expected = if second < HEAL_S {
                SETTLING
            } else {
                Status::OK
            };
            assert_eq!(out.status, expected, "{second} s after");
        }
        let state = unit.thermal_state();
        assert_eq!((state.rejected(), state.restarts()), (1, 1));
    }
}

#[test]
fn past_the_hold_time_only_the_constant_bias_is_applied() {
    let mut unit = on_ramp(-20.0, 3.0);
    for (second, out) in (1..).zip(feed(&mut unit, [f32::NAN; HOLD_S])) {
        let expected = 3.0 * (-(second as f32) / SETTINGS.tau_s).exp();
        assert!((rate(&out) / expected - 1.0).abs() < 2e-3);
        assert_eq!(out.status, BAD | SETTLING);
    }
    let outs = feed(&mut unit, [f32::NAN; 3000]);
    for pair in outs.windows(2) {
        assert!(pair[1].status.contains(BAD | LOST | SETTLING));
        let step = pair[1].point.effective - pair[0].point.effective;
        assert!((0..=SLEW).contains(&step));
    }
    let last = outs[outs.len() - 1];
    assert_eq!((last.bias, last.point.rate), (constant_bias(), 0));
}

#[test]
fn a_temperature_that_returns_is_believed_once_confirmed_and_ramps_in() {
    let mut unit = settled(70.0);
    feed(&mut unit, [f32::NAN; 400]);
    assert_eq!(feed(&mut unit, [-20.0])[0].status, SPIKE | LOST | SETTLING);
    let mut effective = 25 << 20;
    for (second, out) in (0..).zip(feed(&mut unit, [-20.0; SETTLE_S + 5])) {
        effective = (effective - SLEW).max(-20 << 20);
        assert_eq!(out.point.effective, effective);
        assert!(rate(&out).abs() < 1e-4);
        let expected = if second >= SETTLE_S {
            Status::OK
        } else {
            SETTLING
        };
        assert_eq!(out.status, expected);
    }
    assert_eq!(unit.thermal_state().restarts(), 2);
    assert_eq!(unit.thermal_state().rejected(), 401);
}

#[test]
fn a_step_is_believed_when_the_part_can_have_reached_it_and_makes_no_rate() {
    for step in [20.0, -20.0, 31.0] {
        let mut unit = settled(10.0);
        let needed = ((f32::abs(step) - SETTINGS.spike_gate_c) / 0.5) as usize;
        for out in feed(&mut unit, vec![10.0 + step; needed - 1]) {
            assert_eq!(
                (out.status, out.point.effective),
                (SPIKE | SETTLING, 10 << 20)
            );
        }
        let outs = feed(&mut unit, [10.0 + step; SETTLE_S + 1]);
        assert!(outs.iter().all(|out| out.point.rate == 0));
        assert!(outs[..SETTLE_S].iter().all(|out| out.status == SETTLING));
        assert_eq!(outs[SETTLE_S].status, Status::OK);
        assert_eq!(outs[SETTLE_S].point.effective, from_f32(10.0 + step));
    }
}

#[test]
fn the_gate_does_not_stay_wide_after_an_outage() {
    let mut unit = settled(40.0);
    feed(&mut unit, [f32::NAN; 20]);
    feed(&mut unit, [40.0]);
    assert!(feed(&mut unit, [43.0])[0].status.contains(SPIKE));
}

#[test]
fn a_gap_restarts_and_no_time_moves_nothing() {
    let thermal = TABLE.thermal();
    for gap_s in [30.01, 300.0, f32::INFINITY] {
        let mut unit = on_ramp(30.0, 3.0);
        let out = unit.step(&FixedInterval::new(thermal, gap_s), from_f32(46.5), RAW);
        assert_eq!(
            (out.status, out.point.rate),
            (Status::INTERVAL_INVALID | SETTLING, 0)
        );
        assert!(
            (out.point.effective - (45 << 20)).abs() < 100,
            "half a minute of slew"
        );
        assert_eq!(unit.thermal_state().restarts(), 2);
    }
    let mut unit = on_ramp(30.0, 3.0);
    let out = unit.step(&FixedInterval::new(thermal, 0.0), from_f32(30.0), RAW);
    assert_eq!(out.status, Status::INTERVAL_INVALID | SETTLING);
    assert!(
        (rate(&out) / 3.0 - 1.0).abs() < 0.01,
        "a duplicate leaves the rate"
    );
    assert!((rate(&feed(&mut unit, [30.05])[0]) / 3.0 - 1.0).abs() < 1e-3);
}

#[test]
fn before_any_temperature_the_constant_bias_is_applied() {
    let mut unit = FixedTwoRate::new(&TABLE, 100);
    for _ in 0..300 {
        let out = unit.compensate(RAW);
        assert_eq!(out.bias, constant_bias());
        assert!(out.status.contains(LOST));
    }
    let mut state = FixedThermalState::new(TABLE.thermal());
    assert_eq!(
        state.start(TABLE.thermal(), INVALID).status,
        BAD | LOST | SETTLING
    );
}

#[test]
fn the_two_rate_bias_ramps_in_a_line_and_arrives_exactly() {
    for samples in [1_u16, 2, 3, 100, 65_535] {
        let mut unit = FixedTwoRate::new(&TABLE, samples);
        unit.start(52 << 20);
        let mut before = unit.compensate(RAW).bias;
        for second in 1..4 {
            let point = unit.update(&SECOND, (52 << 20) + second * 400_000);
            let end = TABLE.bias(&point).0;
            for sample in 1..=i64::from(samples) + 3 {
                let out = unit.compensate(RAW);
                for axis in 0..2 {
                    let way = i64::from(end[axis]) - i64::from(before[axis]);
                    let part = sample.min(samples.into());
                    let line = i64::from(before[axis]) + way * part / i64::from(samples);
                    let error = i64::from(out.bias[axis]) - line;
                    assert!(error.abs() <= 2, "{error} at {sample} of {samples}");
                    assert!(sample < samples.into() || out.bias[axis] == end[axis]);
                    assert_eq!(out.compensated[axis], RAW[axis] - out.bias[axis]);
                }
            }
            before = end;
        }
    }
}

/// A thermal task that died must not go unseen, nor unsaid after any time.
#[test]
fn an_update_that_is_overdue_by_a_period_is_flagged() {
    let mut unit = FixedTwoRate::new(&TABLE, 100);
    unit.start(30 << 20);
    for _ in 0..2 {
        unit.update(&SECOND, 30 << 20);
        for sample in 1..100_000 {
            let overdue = unit
                .compensate(RAW)
                .status
                .contains(Status::INTERVAL_INVALID);
            assert_eq!(overdue, sample > 200, "{sample}");
        }
    }
}

/// The bias of an update that comes early goes on from where it is.
#[test]
fn an_early_update_makes_no_step() {
    let mut unit = FixedTwoRate::new(&TABLE, 100);
    unit.start(52 << 20);
    /// 0.5 degC/s of slew at 0.05 per degC, in 100 parts, and half of it again.
    const STEP: i32 = 1 << 20;
    let mut before = unit.compensate(RAW).bias[0];
    for second in 1..100 {
        unit.update(&SECOND, (52 << 20) + (second % 2) * 500_000);
        for _ in 0..37 {
            let bias = unit.compensate(RAW).bias[0];
            assert!((bias - before).abs() < STEP);
            before = bias;
        }
    }
}
