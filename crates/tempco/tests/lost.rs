//! A temperature that is lost for longer than the hold time: the constant bias alone while it is,
//! the history as it was afterwards, and what the status says until it may be trusted again.

mod common;

use common::*;
use tempco::{
    Compensator, Interval, Output, PLAYS, Status, Thermal, ThermalPoint, ThermalSettings,
    ThermalState, Validity,
};

const LOST: Status = Status::TEMPERATURE_LOST;
const SPIKE: Status = Status::TEMPERATURE_SPIKE;
const SETTLING: Status = Status::SETTLING;
const UNKNOWN: Status = Status::HISTORY_UNKNOWN;

/// Plays alone, dragged by the temperature itself.
const PLAYS_ONLY: ThermalSettings = ThermalSettings {
    lag2_min_c: 0.0,
    lag2_max_c: 0.0,
    kappa2: 0.0,
    play_kappa: 0.0,
    play_kappa2: 0.0,
    ..RICH
};
/// A second lag alone.
const LAG_ONLY: ThermalSettings = ThermalSettings {
    half_width1_c: 0.0,
    half_width2_c: 0.0,
    ..RICH
};

type Unit = Compensator<'static, 2>;

fn rich(unit: &mut Unit, temps: impl IntoIterator<Item = f32>) -> Vec<Output<2>> {
    let step = |temp| unit.step(&RICH_SECOND, temp, [0.0; 2]);
    temps.into_iter().map(step).collect()
}

/// Up to 50 degC and back to 35, where it rests for so long.
fn cycled(unit: &mut Unit, rest_s: usize) {
    unit.start(20.0);
    let up = (0..600).map(|s| 20.0 + 0.05 * s as f32);
    let down = (0..300).map(|s| 50.0 - 0.05 * s as f32);
    rich(
        unit,
        up.chain(down).chain(std::iter::repeat_n(35.0, rest_s)),
    );
}

fn state(thermal: &Thermal, temp_c: f32) -> ThermalState {
    let mut state = ThermalState::new(thermal);
    state.start(thermal, temp_c);
    state
}

fn missing(seconds: usize) -> impl Iterator<Item = f32> {
    std::iter::repeat_n(f32::NAN, seconds)
}

/// Rate, lag and plays are gone after a minute, to the last bit.
#[test]
fn while_it_is_lost_the_constant_bias_alone_is_applied() {
    let mut never = Compensator::new(&RICH_TABLE);
    let constant = rich(&mut never, [f32::NAN])[0].bias;
    for rest_s in [0, 30, 2000] {
        let mut unit = Compensator::new(&RICH_TABLE);
        cycled(&mut unit, rest_s);
        let held = rich(&mut unit, missing(HOLD_S));
        assert!(held.iter().all(|out| out.point.plays_c[0] != 0.0));
        let outs = rich(&mut unit, missing(600));
        for (second, out) in (1..).zip(&outs) {
            assert!(out.status.contains(LOST | UNKNOWN | SETTLING), "{second} s");
            assert_eq!(out.status.validity(), Validity::Invalid);
            let ThermalPoint {
                rate_c_per_min,
                lag2_c,
                plays_c,
                ..
            } = out.point;
            let left = [rate_c_per_min, lag2_c, plays_c[0], plays_c[1]];
            let gone = left.iter().all(|&left| left == 0.0);
            assert_eq!(gone, second > 60, "{second} s: {left:?}");
            assert!(second <= 61 || out.bias == constant);
        }
    }
}

/// The part has stayed where it was: nothing of the loss is left, where in the first edition it
/// was the whole loop.
#[test]
fn after_the_return_no_error_stands() {
    for settings in [PLAYS_ONLY, RICH] {
        let table = rich_table(thermal(settings));
        let table: &'static _ = Box::leak(Box::new(table));
        let (mut unit, mut twin) = (Compensator::new(table), Compensator::new(table));
        let rest_s = 9000;
        cycled(&mut unit, rest_s);
        cycled(&mut twin, rest_s);
        let before = rich(&mut unit, [35.0])[0];
        rich(&mut unit, missing(300));
        assert_ne!(rich(&mut unit, [35.0])[0].bias, before.bias);
        let back = *rich(&mut unit, [35.0; 200]).last().unwrap();
        let expected = *rich(&mut twin, [35.0; 502]).last().unwrap();
        for axis in 0..2 {
            let error = (back.bias[axis] - expected.bias[axis]).abs();
            assert!(error < 2e-6, "{error}");
        }
        for (back, expected) in back.point.plays_c.into_iter().zip(expected.point.plays_c) {
            let allowed = if settings == RICH { 1e-4 } else { 0.0 };
            assert!((back - expected).abs() <= allowed, "{back} {expected}");
        }
        assert!(back.point.plays_c[0] < -4.9 && back.point.plays_c[1] < -1.9);
        assert_eq!(back.status, UNKNOWN);
    }
}

/// What fades the terms does not drag the plays: their temperature mixes rate and lag in full.
#[test]
fn fading_in_does_not_drag_the_plays() {
    let thermal = thermal(ThermalSettings {
        tau2_s: 60_000.0,
        play_kappa: 0.0,
        ..RICH
    });
    let second = Interval::new(&thermal, 1.0);
    let mut state = state(&thermal, 20.0);
    let down = ramp(40.0, 37.0).chain(std::iter::repeat_n(37.0, 60));
    let readings = ramp(20.0, 40.0).chain(down);
    let before = readings.map(|t| state.update(&thermal, &second, t)).last();
    let before = before.unwrap();
    assert!(before.lag2_c > 16.0, "{before:?}");
    for temp in missing(300).chain([37.0; 300]) {
        state.update(&thermal, &second, temp);
    }
    let after = state.update(&thermal, &second, 37.0);
    for (before, after) in before.plays_c.into_iter().zip(after.plays_c) {
        assert!((before - after).abs() < 0.1, "{before} {after}");
    }
}

/// The part has moved: within the widths the plays are not known; once it has moved through the
/// wider one they are, and the status says so just then.
#[test]
fn the_plays_are_known_again_when_the_temperature_has_moved_through_them() {
    let thermal = thermal(PLAYS_ONLY);
    let second = Interval::new(&thermal, 1.0);
    for (up_c, down_c, back_c) in [(10.0, 0.0, 35.0), (0.0, 10.0, 28.0), (6.0, 10.0, 39.0)] {
        let (mut lost, mut twin) = (state(&thermal, 35.0), state(&thermal, 35.0));
        for temp in ramp(35.0, 50.0).chain(ramp(50.0, 35.0)) {
            lost.update(&thermal, &second, temp);
            twin.update(&thermal, &second, temp);
        }
        for (temp, seen) in ramp(35.0, 20.0)
            .chain(ramp(20.0, back_c))
            .map(|t| (t, f32::NAN))
        {
            twin.update(&thermal, &second, temp);
            lost.update(&thermal, &second, seen);
        }
        // The return, and the way of `v` to the new temperature.
        for _ in 0..200 {
            let point = lost.update(&thermal, &second, back_c);
            twin.update(&thermal, &second, back_c);
            assert!(point.status.contains(UNKNOWN), "{point:?}");
        }
        let way = ramp(back_c, back_c + up_c).chain(ramp(back_c + up_c, back_c + up_c - down_c));
        let (mut low, mut high) = (back_c, back_c);
        for temp in way {
            let point = lost.update(&thermal, &second, temp);
            let expected = twin.update(&thermal, &second, temp);
            (low, high) = (low.min(temp), high.max(temp));
            let known = high - low >= 10.0;
            assert_eq!(!point.status.contains(UNKNOWN), known, "{low} to {high}");
            assert!(!known || point.plays_c == expected.plays_c);
        }
        assert!(high - low >= 10.0, "{low} to {high}");
        assert!(
            !lost
                .update(&thermal, &second, back_c)
                .status
                .contains(UNKNOWN)
        );
    }
}

/// In steps of an eighth of a degree a second, which f32 represents.
fn ramp(from: f32, to: f32) -> impl Iterator<Item = f32> {
    let steps = ((to - from).abs() * 8.0) as usize;
    (1..=steps).map(move |i| from + 0.125 * i as f32 * (to - from).signum())
}

/// Three time constants after the return, to the tick, but no more than what is counted.
#[test]
fn the_second_lag_is_known_again_after_three_time_constants() {
    for &(tau2_s, known_s) in first(&[(900.0, 2700.0), (7000.0, 2e4), (60_000.0, 2e4)], 1) {
        let thermal = thermal(ThermalSettings { tau2_s, ..LAG_ONLY });
        let second = Interval::new(&thermal, 1.0);
        let tick = Interval::new(&thermal, 1e-5);
        let mut state = state(&thermal, 20.0);
        for temp in missing(100).chain([20.0]) {
            state.update(&thermal, &second, temp);
        }
        let mut unknown = |interval: &Interval| {
            let point = state.update(&thermal, interval, 20.0);
            point.status.contains(UNKNOWN)
        };
        for s in 1..known_s as usize {
            assert!(unknown(&second), "{s} s");
        }
        for _ in 0..99_999 {
            assert!(unknown(&tick));
        }
        assert!(!unknown(&tick));
        assert!(!unknown(&second));
    }
}

/// The way of the plays to a temperature far away is no movement of the part, however long it takes.
#[test]
fn the_way_to_the_new_temperature_does_not_make_the_plays_known() {
    let thermal = thermal(ThermalSettings {
        max_slew_c_per_min: 2.0,
        ..PLAYS_ONLY
    });
    let second = Interval::new(&thermal, 1.0);
    for back_c in [15.0, 65.0] {
        let mut state = state(&thermal, 40.0);
        for temp in missing(1000).chain([back_c; 1500]) {
            let point = state.update(&thermal, &second, temp);
            let is_lost = point.status.contains(LOST);
            assert!(!is_lost || point.status.contains(UNKNOWN));
        }
        let point = state.update(&thermal, &second, back_c);
        assert_eq!(point.status, UNKNOWN, "{back_c}");
    }
}

/// The second lag stands still with the temperature, whatever is read meanwhile.
#[test]
fn the_second_lag_stands_still_while_the_temperature_is_lost() {
    let thermal = thermal(LAG_ONLY);
    let second = Interval::new(&thermal, 1.0);
    let (mut lost, mut twin) = (state(&thermal, 20.0), state(&thermal, 20.0));
    for temp in ramp(20.0, 40.0) {
        lost.update(&thermal, &second, temp);
        twin.update(&thermal, &second, temp);
    }
    // Held for the hold time, then lost to readings that never agree.
    for temp in [140.0, 100.0].into_iter().cycle().take(HOLD_S + 300) {
        lost.update(&thermal, &second, temp);
    }
    lost.update(&thermal, &second, 40.0);
    for _ in 0..100 {
        lost.update(&thermal, &second, 40.0);
    }
    for _ in 0..HOLD_S + 100 {
        twin.update(&thermal, &second, 40.0);
    }
    let [lost, twin] = [lost, twin].map(|mut state| state.update(&thermal, &second, 40.0));
    assert!(twin.lag2_c > 12.0, "{twin:?}");
    assert!(
        (lost.lag2_c - twin.lag2_c).abs() < 0.03,
        "{lost:?} {twin:?}"
    );
}

/// Both must hold, the time and the way.
#[test]
fn a_history_of_both_kinds_needs_both() {
    for (seconds, moves, known) in [
        (2699, true, false),
        (2700, true, true),
        (9000, false, false),
    ] {
        let mut state = state(&RICH_THERMAL, 20.0);
        for temp in missing(100) {
            state.update(&RICH_THERMAL, &RICH_SECOND, temp);
        }
        let mut last = None;
        for s in 0..=seconds {
            let temp = 20.0
                + if moves {
                    12.0 * (s as f32 * 0.01).sin()
                } else {
                    0.0
                };
            last = Some(state.update(&RICH_THERMAL, &RICH_SECOND, temp));
        }
        assert_eq!(!last.unwrap().status.contains(UNKNOWN), known);
    }
}

/// A gap is a loss of what the temperature did, also where a good reading ends it.
#[test]
fn a_gap_longer_than_the_hold_time_leaves_the_history_unknown() {
    for (gap_s, unknown) in [(60.0, false), (60.000_01, true), (1e9, true)] {
        let mut state = state(&RICH_THERMAL, 20.0);
        let gap = Interval::new(&RICH_THERMAL, gap_s);
        let point = state.update(&RICH_THERMAL, &gap, 20.0);
        assert_eq!(point.status.contains(UNKNOWN), unknown, "{gap_s} s");
        assert!(!point.status.contains(LOST));
        state.start(&RICH_THERMAL, 20.0);
        let point = state.update(&RICH_THERMAL, &RICH_SECOND, 20.0);
        assert_eq!(point.status, SETTLING);
    }
}

/// The last good temperature is held up to the hold time, to the tick of 10 us.
#[test]
fn the_hold_time_is_kept_to_the_tick() {
    for hold_s in [0.0_f32, 1e-5, 1.0, 60.0, 20_000.0] {
        let thermal = thermal(ThermalSettings { hold_s, ..RICH });
        let tick = Interval::new(&thermal, 1e-5);
        let after = |ticks: i32, temps: &[f32]| {
            let mut state = state(&thermal, 20.0);
            // Sums of times that f32 represents.
            let mut left = (f64::from(hold_s) * 1e5).round() as i32 + ticks;
            while left > 0 {
                let part = left.min(1 << 17);
                let interval = Interval::new(&thermal, part as f32 / 1e5);
                state.update(&thermal, &interval, f32::NAN);
                left -= part;
            }
            let update = |&temp: &f32| state.update(&thermal, &tick, temp).status;
            temps.iter().map(update).collect::<Vec<_>>()
        };
        for (ticks, lost) in [(-1, false), (0, true), (1, true)] {
            if hold_s == 0.0 && ticks < 0 {
                continue;
            }
            let status = after(ticks, &[f32::NAN])[0];
            assert_eq!(
                status.contains(LOST),
                lost,
                "{hold_s} s {ticks}: {status:?}"
            );
            assert_eq!(status.contains(UNKNOWN), lost, "{hold_s} s {ticks}");
        }
        // Accepted at once where it was not lost yet; the second time, where it was.
        for (ticks, at_once) in [(-1, true), (0, true), (1, false)] {
            if hold_s == 0.0 && ticks < 0 {
                continue;
            }
            let back = 20.0 + f32::min(2.1, 2.0 + 0.5 * hold_s);
            if back < 22.1 {
                continue;
            }
            let found = after(ticks, &[back, back]);
            assert_eq!(
                found[0].contains(SPIKE | LOST),
                !at_once,
                "{hold_s} s {ticks}: {found:?}"
            );
            assert!(!found[1].intersects(SPIKE | LOST));
        }
    }
}

/// A bad reading in the middle of a long settling does not end it early.
#[test]
fn a_rejection_does_not_shorten_a_settling_that_runs() {
    for bad in [f32::NAN, 60.0] {
        for at in [1, 50, 165, 171, 175] {
            let mut state = state(&THERMAL, 20.0);
            let read = |s| if s == at { bad } else { 20.0 };
            let settled = (1..1000).find(|&s| {
                let status = state.update(&THERMAL, &SECOND, read(s)).status;
                status == Status::OK
            });
            // It takes as long with the bad reading left out; one near its end has its own time.
            let expected = (SETTLE_S + 1).max(at + HEAL_S);
            assert_eq!(settled, Some(expected), "{bad} at {at} s");
        }
    }
}

/// With a fast estimator the rate is right long before it counts in full; the status waits.
#[test]
fn the_status_is_settling_until_rate_and_history_count_in_full_again() {
    let thermal = thermal(ThermalSettings {
        tau_s: 5.0,
        kappa: 0.0,
        play_kappa: 0.0,
        ..RICH
    });
    let second = Interval::new(&thermal, 1.0);
    for lost_s in [61, 75, 90, 120, 400] {
        let mut state = state(&thermal, 25.0);
        let ramp = |s: i32| 25.0 + 0.02 * s as f32;
        for s in 1..1000 {
            let temp = if s > 100 && s <= 100 + lost_s {
                f32::NAN
            } else {
                ramp(s)
            };
            let point = state.update(&thermal, &second, temp);
            if s > 100 && !point.status.contains(SETTLING) {
                // Three time constants after a restart a twentieth of the rate may be missing.
                assert!((point.rate_c_per_min - 1.2).abs() < 0.07, "{s}: {point:?}");
                assert!((point.plays_c[1] - 2.0).abs() < 1e-3, "{s}: {point:?}");
            }
            // After a long loss the second reading is the first to be accepted.
            let back = s - 101 - lost_s;
            if lost_s == 400 && (31..60).contains(&back) {
                let expected = 1.2 * back as f32 / 60.0;
                assert!(
                    (point.rate_c_per_min - expected).abs() < 2e-3,
                    "{back}: {point:?}"
                );
            }
        }
    }
}

/// A loss does not move the plays, whatever the reading after it; only what is accepted does.
#[test]
fn plays_stand_still_until_a_reading_is_accepted() {
    let thermal = thermal(PLAYS_ONLY);
    let second = Interval::new(&thermal, 1.0);
    let mut state = state(&thermal, 20.0);
    let readings = ramp(20.0, 30.0).chain(ramp(30.0, 26.0));
    let before = readings
        .map(|t| state.update(&thermal, &second, t))
        .last()
        .unwrap();
    // Lost to readings that never agree.
    for temp in [140.0, 100.0].into_iter().cycle().take(300) {
        state.update(&thermal, &second, temp);
    }
    for temp in [26.0; 200] {
        state.update(&thermal, &second, temp);
    }
    let after = state.update(&thermal, &second, 26.0);
    assert_eq!(after.plays_c, before.plays_c);
    assert!(after.plays_c != [0.0; PLAYS]);
}

/// Before the first temperature nothing counts, so nothing is left to fade out when it comes soon.
#[test]
fn the_rate_fades_in_after_a_late_first_temperature() {
    let thermal = thermal(ThermalSettings::DEFAULT);
    let second = Interval::new(&thermal, 1.0);
    let mut state = ThermalState::new(&thermal);
    state.update(&thermal, &second, f32::NAN);
    let readings = (0..12).map(|s| 20.0 + 0.1 * s as f32);
    let points = readings.map(|temp| state.update(&thermal, &second, temp));
    let rate = points.last().unwrap().rate_c_per_min;
    assert!(rate > 0.0 && rate < 0.06 * 6.0, "{rate}");
}
