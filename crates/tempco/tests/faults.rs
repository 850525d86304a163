//! A broken, noisy or reconnected temperature sensor: what is applied, what the status says,
//! and how long it takes to heal.

mod common;

use common::*;
use tempco::{Compensator, Interval, Status, ThermalSettings, ThermalState, Validity};

const BAD: Status = Status::TEMPERATURE_INVALID;
const SPIKE: Status = Status::TEMPERATURE_SPIKE;
const LOST: Status = Status::TEMPERATURE_LOST;
const SETTLING: Status = Status::SETTLING;
const JUMPED: Status = Status::TEMPERATURE_JUMPED;

/// Codes at a rail of the sensor, and their quotients with a dead reference.
const BROKEN: [f32; 9] = [
    f32::NAN,
    -f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    -60.00001,
    150.00002,
    -273.15,
];

/// Good samples after a bad one: marked as settling for the heal time, and not a sample longer.
fn assert_heals(unit: &mut Compensator<'static, 2>, temp_c: f32) {
    for (second, out) in (1..).zip(feed(unit, [temp_c; HEAL_S + 5])) {
        let expected = if second < HEAL_S {
            SETTLING
        } else {
            Status::OK
        };
        assert_eq!(out.status, expected, "{second} s after");
    }
}

#[test]
fn an_unusable_temperature_holds_the_last_good_one_and_heals() {
    let settled = settled(40.0);
    for &broken in first(&BROKEN, 3) {
        let mut unit = settled.clone();
        let before = feed(&mut unit, [40.0])[0];
        let out = feed(&mut unit, [broken])[0];
        assert_eq!(bits(&out), bits(&before), "{broken}");
        assert_eq!(out.status, BAD | SETTLING, "{broken}");
        assert_eq!(out.status.validity(), Validity::Degraded);
        assert_eq!(unit.thermal_state().rejected(), 1);
        assert_heals(&mut unit, 40.0);
        assert_eq!(unit.thermal_state().restarts(), 1);
    }
}

#[test]
fn temperatures_at_the_rails_of_the_sensor_are_good() {
    for rail in [SETTINGS.sensor_min_c, SETTINGS.sensor_max_c] {
        let mut unit = Compensator::new(&TABLE);
        unit.start(rail);
        let out = feed(&mut unit, [rail; SETTLE_S]);
        assert_eq!(out[SETTLE_S - 1].status, Status::TEMPERATURE_CLAMPED);
    }
}

#[test]
fn the_rate_decays_with_the_time_constant_while_the_temperature_is_missing() {
    for &rate in first(&[-3.0, 0.5, 12.0], 1) {
        let outs = feed(&mut on_ramp(30.0, rate), [f32::NAN; HOLD_S]);
        for (second, out) in (1..).zip(outs) {
            let expected = rate * (-(second as f32) / SETTINGS.tau_s).exp();
            let error = out.point.rate_c_per_min / expected - 1.0;
            assert!(error.abs() < 2e-3, "{error} after {second} s of {rate}");
            assert_eq!(out.status, BAD | SETTLING);
            assert!((out.point.effective_c - 30.0).abs() < 1e-4);
        }
    }
}

#[test]
fn past_the_hold_time_only_the_constant_bias_is_applied() {
    let expected = constant_bias();
    let per_rate = [0, 1].map(|axis| lipschitz(&TABLE, axis).per_rate);
    let per_rate = per_rate[0].max(per_rate[1]);
    for &start in first(&[-20.0, 0.0, 80.0], 1) {
        let mut unit = on_ramp(start, 3.0);
        feed(&mut unit, [f32::NAN; HOLD_S]);
        let to_reference = (start - SETTINGS.reference_c).abs();
        let arrived = (to_reference / SLEW_C) as usize + 1;
        let mut effective = start;
        for (second, out) in (1..).zip(feed(&mut unit, vec![f32::NAN; fewer(3000, 200)])) {
            assert!(out.status.contains(BAD | LOST | SETTLING), "{second} s");
            assert_eq!(out.status.validity(), Validity::Invalid);
            // The rate decays on and fades out within a minute; it does not drop in a step.
            let fading = f32::max(1.0 - second as f32 / 60.0, 0.0);
            let rate = 3.0 * (-((HOLD_S + second) as f32) / SETTINGS.tau_s).exp() * fading;
            assert!((out.point.rate_c_per_min - rate).abs() < 1e-3);
            assert!(second <= 60 || out.point.rate_c_per_min == 0.0);
            assert!((out.point.effective_c - effective).abs() <= SLEW_C + 1e-4);
            effective = out.point.effective_c;
            for (bias, constant) in out.bias.iter().zip(expected) {
                let left = rate * per_rate;
                assert!(second < arrived || (bias - constant).abs() <= left + 1e-6);
            }
            assert!(second <= arrived.max(60) || out.bias == expected);
        }
    }
}

#[test]
fn a_unit_that_never_saw_a_temperature_applies_the_constant_bias() {
    let mut unit = Compensator::new(&TABLE);
    unit.start(f32::NAN);
    for out in feed(&mut unit, [f32::NAN; 100]) {
        assert_eq!(out.bias, constant_bias());
        assert_eq!(out.status, BAD | LOST | SETTLING);
    }
    let reference = settled(SETTINGS.reference_c);
    assert_eq!(
        feed(&mut reference.clone(), [25.0])[0].bias,
        constant_bias()
    );
}

#[test]
fn a_temperature_that_returns_is_believed_once_confirmed_and_ramps_in() {
    let mut unit = settled(70.0);
    feed(&mut unit, [f32::NAN; 400]);
    // One reading may be the first of a broken sensor: the second one decides.
    let first = feed(&mut unit, [-20.0])[0];
    assert_eq!(first.status, SPIKE | LOST | SETTLING);
    let mut effective = SETTINGS.reference_c;
    for (second, out) in (0..).zip(feed(&mut unit, [-20.0; SETTLE_S + 5])) {
        effective = (effective - SLEW_C).max(-20.0);
        assert_eq!(out.point.effective_c, effective);
        assert!(out.point.rate_c_per_min.abs() < 1e-4);
        let settled = second >= SETTLE_S;
        assert_eq!(out.status, if settled { Status::OK } else { SETTLING });
    }
    assert_eq!(unit.thermal_state().restarts(), 2);
    assert_eq!(unit.thermal_state().rejected(), 401);
}

#[test]
fn garbage_after_a_loss_is_not_believed() {
    let mut unit = settled(20.0);
    feed(&mut unit, [f32::NAN; 300]);
    let outs = feed(&mut unit, [140.0, 20.0, 20.0, 20.0]);
    assert!(
        outs[..2]
            .iter()
            .all(|o| o.status == SPIKE | LOST | SETTLING)
    );
    assert!(outs[2..].iter().all(|o| o.status == SETTLING));
    assert!(
        outs.iter()
            .all(|o| o.point.effective_c <= SETTINGS.reference_c)
    );
}

/// Close to where it was lost the first reading is confirmed by the last one before the loss. How
/// it got there is not known, so the rate goes on fading as if nothing had come.
#[test]
fn the_return_after_a_loss_makes_no_rate() {
    let mut unit = on_ramp(30.0, 3.0);
    feed(&mut unit, [f32::NAN; HOLD_S + 1]);
    for (second, out) in (HOLD_S + 2..).zip(feed(&mut unit, [31.5; SETTLE_S])) {
        let expected = 3.0 * (-(second as f32) / SETTINGS.tau_s).exp();
        assert!(
            (out.point.rate_c_per_min - expected).abs() < 2e-2,
            "{out:?}"
        );
        assert_eq!(out.status, SETTLING);
    }
    assert_eq!(unit.thermal_state().restarts(), 2);
}

/// The longer nothing was accepted, the longer the estimate needs; past half a time constant it
/// begins again.
#[test]
fn the_rate_is_right_again_when_the_status_says_so() {
    let on_ramp = on_ramp(30.0, 2.0);
    for &outage_s in first(&[10, 31, 1, 29, 59], 2) {
        let temp = |s: usize| 30.0 + 2.0 / 60.0 * s as f32;
        let mut unit = on_ramp.clone();
        feed(&mut unit, vec![f32::NAN; outage_s]);
        let outs = feed(&mut unit, (outage_s + 1..outage_s + 300).map(temp));
        let good = outs.iter().find(|out| out.status == Status::OK).unwrap();
        let error = (good.point.rate_c_per_min - 2.0).abs();
        assert!(error < 0.12, "{error} after {outage_s} s");
    }
}

#[test]
fn the_status_is_settling_while_the_effective_temperature_ramps() {
    let slow = thermal(ThermalSettings {
        tau_s: 10.0,
        max_slew_c_per_min: 5.0,
        ..SETTINGS
    });
    for (settings, start, back) in [(slow, -40.0, -40.0), (THERMAL, f32::NAN, 140.0)] {
        let mut state = ThermalState::new(&settings);
        state.start(&settings, start);
        let second = Interval::new(&settings, 1.0);
        for _ in 0..fewer(2000, 850) {
            state.update(&settings, &second, f32::NAN);
        }
        let mut points = (0..3000).map(|_| state.update(&settings, &second, back));
        let arrived = points.find(|point| point.status == Status::OK).unwrap();
        let left_c = (arrived.effective_c - back).abs();
        assert!(left_c <= SETTINGS.spike_gate_c, "{left_c}");
    }
}

/// A ramp faster than the settings allow is followed in jumps, and not in silence.
#[test]
fn a_ramp_beyond_the_slew_is_flagged() {
    let settings = thermal(ThermalSettings {
        max_slew_c_per_min: 1.0,
        ..SETTINGS
    });
    let mut state = ThermalState::new(&settings);
    state.start(&settings, 0.0);
    let second = Interval::new(&settings, 1.0);
    let ramp = (0..1800).map(|s| state.update(&settings, &second, s as f32 / 30.0));
    assert!(
        ramp.skip(200)
            .all(|point| point.status.contains(SETTLING | JUMPED))
    );
}

/// Times are counted exactly at any rate of updates, however wide the gate and slow the slew.
#[test]
#[cfg_attr(miri, ignore = "needs its many samples")]
fn hold_and_settling_times_are_kept_at_kilohertz() {
    let settings = thermal(ThermalSettings {
        max_slew_c_per_min: 0.5,
        spike_gate_c: 1000.0,
        tau_s: 600.0,
        ..SETTINGS
    });
    let quarter_ms = Interval::new(&settings, 2.5e-4);
    let mut state = ThermalState::new(&settings);
    state.start(&settings, 30.0);
    let mut until = |wanted: fn(Status) -> bool, temp_c: f32| {
        let mut updates = 0..10_000_000;
        updates.position(|_| wanted(state.update(&settings, &quarter_ms, temp_c).status))
    };
    assert_eq!(
        until(|status| status == Status::OK, 30.0),
        Some(1800 * 4000 - 1)
    );
    assert_eq!(
        until(|status| status.contains(LOST), f32::NAN),
        Some(60 * 4000)
    );
}

#[test]
fn a_second_start_forgets_the_first() {
    let mut unit = on_ramp(30.0, 3.0);
    feed(&mut unit, [f32::NAN; 50]);
    unit.start(-20.0);
    let mut fresh = Compensator::new(&TABLE);
    fresh.start(-20.0);
    assert_eq!(unit.thermal_state(), fresh.thermal_state());
    let out = feed(&mut unit, [-20.0])[0];
    assert_eq!((out.point.effective_c, out.status), (-20.0, SETTLING));
}

#[test]
fn a_spike_is_rejected_before_the_differentiator_and_heals() {
    let gate = SETTINGS.spike_gate_c + SLEW_C;
    let settled = settled(40.0);
    let spikes = [gate + 1e-3, -gate - 1e-3, 5.0, -5.0, 100.0, -90.0];
    for &spike in first(&spikes, 2) {
        let mut unit = settled.clone();
        let before = feed(&mut unit, [40.0])[0];
        let out = feed(&mut unit, [40.0 + spike])[0];
        assert_eq!(bits(&out), bits(&before), "{spike}");
        assert_eq!(out.status, SPIKE | SETTLING, "{spike}");
        assert_eq!(unit.thermal_state().rejected(), 1);
        assert_heals(&mut unit, 40.0);
    }
    // The widest jump that is accepted: no flag, no restart, but no more than the slew either.
    for jump in [gate, -gate] {
        let mut unit = settled.clone();
        let out = feed(&mut unit, [40.0 + jump])[0];
        assert_eq!(out.status, Status::OK);
        assert_eq!(out.point.effective_c, 40.0 + SLEW_C.copysign(jump));
        assert_eq!(unit.thermal_state().restarts(), 1);
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
fn alternating_good_and_bad_is_degraded_but_never_lost_nor_wrong() {
    let temp = |s: i32| 20.0 + s as f32 / 60.0;
    let mut unit = on_ramp(20.0, 1.0);
    let seconds = fewer(2000, 200);
    for s in 1..=seconds as i32 {
        let bad = [temp(s), [f32::NAN, 140.0][s as usize / 2 % 2]][s as usize % 2];
        let out = feed(&mut unit, [bad])[0];
        assert!(out.status.contains(SETTLING) && !out.status.contains(LOST));
        // Half of the temperatures are a second old: an error of 1/120 either way.
        assert!((out.point.rate_c_per_min - 1.0).abs() < 0.02, "{out:?}");
        assert!((out.point.effective_c - temp(s)).abs() < 0.02, "{out:?}");
    }
    assert_eq!(unit.thermal_state().rejected() as usize, seconds / 2);
    assert_eq!(unit.thermal_state().restarts(), 1);
}

/// A sensor that comes back at another temperature is accepted once the part can have got there.
#[test]
fn a_step_is_believed_when_the_part_can_have_reached_it() {
    for &step in first(&[20.0, -20.0, 31.0], 1) {
        let mut unit = settled(10.0);
        let needed = ((f32::abs(step) - SETTINGS.spike_gate_c) / SLEW_C) as usize;
        for out in feed(&mut unit, vec![10.0 + step; needed - 1]) {
            assert_eq!(out.status, SPIKE | SETTLING);
            assert_eq!(out.point.effective_c, 10.0);
        }
        let mut effective = 10.0;
        for (second, out) in (0..).zip(feed(&mut unit, [10.0 + step; SETTLE_S + 1])) {
            assert_eq!(out.point.rate_c_per_min, 0.0, "no rate from a step");
            assert!((out.point.effective_c - effective).abs() <= SLEW_C);
            effective = out.point.effective_c;
            let settled = second == SETTLE_S;
            let expected = if settled { Status::OK } else { SETTLING };
            assert_eq!(out.status, expected | JUMPED);
        }
        assert_eq!(effective, 10.0 + step);
        assert_eq!(unit.thermal_state().restarts(), 2);
    }
}

#[test]
fn a_step_too_large_for_the_hold_time_is_believed_after_the_loss() {
    let mut unit = settled(-30.0);
    let outs = feed(&mut unit, [60.0; HOLD_S + 2]);
    assert!(outs[..HOLD_S].iter().all(|o| o.status == SPIKE | SETTLING));
    assert_eq!(outs[HOLD_S].status, SPIKE | LOST | SETTLING);
    // It has been the same for a minute: the next one is accepted.
    assert_eq!(outs[HOLD_S + 1].status, SETTLING | JUMPED);
    assert_eq!(unit.thermal_state().rejected() as usize, HOLD_S + 1);
}
