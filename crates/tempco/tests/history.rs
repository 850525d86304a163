//! The second lag and the plays: on their own, in the thermal path, and on top of a table.

mod common;

use common::*;
use proptest::prelude::*;
use tempco::{
    Compensator, Interval, PLAYS, Play, SecondLag, Status, Table, TableError, ThermalHalf,
    ThermalPoint, ThermalSettings, ThermalState,
};

/// How far the contact is behind at each temperature, from a first one on.
fn through_play(half_width_c: f32, start: f32, path: &[f32]) -> Vec<f32> {
    let mut play = Play::new(start);
    path.iter().map(|&v| play.follow(half_width_c, v)).collect()
}

/// From one temperature to another in so many equal steps, the latter included.
fn ramp(from: f32, to: f32, steps: usize) -> impl Iterator<Item = f32> {
    (1..=steps).map(move |i| {
        let share = i as f32 / steps as f32;
        if i == steps {
            to
        } else {
            from + (to - from) * share
        }
    })
}

/// The bias of a table without what the history adds.
fn without_history(table: &Table<'_, 2>, point: &ThermalPoint) -> [f32; 2] {
    let point = ThermalPoint {
        lag2_c: 0.0,
        plays_c: [0.0; PLAYS],
        ..*point
    };
    table.bias(&point).0
}

/// The temperature that drags the plays, from what the point says of the rest.
fn drag(settings: &ThermalSettings, temp_c: f32, point: &ThermalPoint) -> f32 {
    let shift_min = settings.play_kappa * settings.tau_s / 60.0;
    temp_c - shift_min * point.rate_c_per_min - settings.play_kappa2 * point.lag2_c
}

/// A slow walk within the sensor's range, and the time between two of its steps.
fn walk() -> impl Strategy<Value = Vec<(f32, f32)>> {
    prop::collection::vec((-0.3_f32..0.3, 0.5_f32..20.0), 1..300)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(300), failure_persistence: None, ..Default::default() })]

    #[test]
    fn the_contact_is_never_further_than_the_half_width_but_for_rounding(
        width in 0.0_f32..20.0,
        path in prop::collection::vec(-60.0_f32..150.0, 1..200),
    ) {
        for (v, distance) in path.iter().zip(through_play(width, path[0], &path)) {
            let rounding = f32::EPSILON * (v.abs() + width);
            prop_assert!(distance.abs() <= width + rounding, "{distance} of {width}");
        }
    }

    /// Only the turning points matter: not how fast, nor in how many samples.
    #[test]
    fn hysteresis_does_not_depend_on_the_rate(
        width in 0.0_f32..10.0,
        turns in prop::collection::vec((-60.0_f32..150.0, 1_usize..30), 1..30),
    ) {
        let start = 25.0;
        let turning: Vec<f32> = turns.iter().map(|&(turn, _)| turn).collect();
        let coarse = through_play(width, start, &turning);
        let (mut play, mut from) = (Play::new(start), start);
        for (&(turn, steps), coarse) in turns.iter().zip(coarse) {
            let fine = ramp(from, turn, steps).map(|v| play.follow(width, v)).last();
            prop_assert_eq!(fine, Some(coarse));
            from = turn;
        }
    }

    #[test]
    fn a_monotone_path_of_the_whole_width_drags_the_contact(
        width in 0.1_f32..10.0,
        path in prop::collection::vec(-60.0_f32..150.0, 1..50),
        up in any::<bool>(),
    ) {
        let direction = if up { 1.0 } else { -1.0 };
        let end = path[path.len() - 1] + direction * 2.001 * width;
        let full = [path.as_slice(), &[end]].concat();
        let distance = *through_play(width, path[0], &full).last().unwrap();
        prop_assert!((distance - direction * width).abs() < 1e-4, "{distance} of {width}");
    }

    /// In the thermal path the second lag follows the temperature, and each play is dragged by
    /// its own mix of temperature and lags.
    #[test]
    fn the_thermal_path_feeds_the_temperature_to_the_lag_and_the_mix_to_the_plays(walk in walk(),
    ) {
        let mut state = ThermalState::new(&RICH_THERMAL);
        let mut temp = 25.0;
        state.start(&RICH_THERMAL, temp);
        let (mut lag, mut plays) = (SecondLag::new(temp), [Play::new(temp); PLAYS]);
        let mut v = temp;
        for (rate_s, dt_s) in walk {
            temp = (temp + rate_s * dt_s).clamp(-55.0, 145.0);
            let interval = Interval::new(&RICH_THERMAL, dt_s);
            let point = state.update(&RICH_THERMAL, &interval, temp);
            let lag2 = lag.update(&interval, temp);
            let limited = lag2.clamp(RICH.lag2_min_c, RICH.lag2_max_c);
            prop_assert!((point.lag2_c - limited).abs() < 1e-4, "{} {}", point.lag2_c, limited);
            let clamped = point.status.contains(Status::LAG_CLAMPED);
            prop_assert!(clamped == (lag2 != limited) || (lag2 - limited).abs() < 1e-4);
            let slew = SLEW_C * dt_s;
            v += (drag(&RICH, temp, &point) - v).clamp(-slew, slew);
            for ((play, width), play_c) in plays.iter_mut().zip(HALF_WIDTHS).zip(point.plays_c) {
                let error = (play_c - play.follow(width, v)).abs();
                prop_assert!(error < 2e-4, "{} at {}", error, v);
            }
        }
    }

    /// With the same mix as the curve's the plays are dragged by its very temperature, bit for bit.
    #[test]
    fn with_the_mix_of_the_curve_the_plays_follow_its_temperature(
        kappa in 0.0_f32..2.0,
        kappa2 in -2.0_f32..2.0,
        jumps in prop::collection::vec((-40.0_f32..40.0, 0.01_f32..40.0), 1..100),
    ) {
        let thermal = thermal(ThermalSettings {
            kappa, kappa2, play_kappa: kappa, play_kappa2: kappa2, hold_s: 2e4, ..RICH
        });
        let mut state = ThermalState::new(&thermal);
        state.start(&thermal, 25.0);
        let mut plays = [Play::new(25.0); PLAYS];
        for (jump, dt_s) in jumps {
            let point = state.update(&thermal, &Interval::new(&thermal, dt_s), 25.0 + jump);
            for ((play, width), play_c) in plays.iter_mut().zip(HALF_WIDTHS).zip(point.plays_c) {
                let expected = play.follow(width, point.effective_c);
                prop_assert_eq!(play_c.to_bits(), expected.to_bits());
            }
        }
    }

    /// The bias is the table's, plus what the second lag and the gains of the plays make.
    #[test]
    fn terms_are_added_to_the_bias_of_the_table(walk in walk()) {
        let mut unit = Compensator::new(&RICH_TABLE);
        unit.start(25.0);
        let mut temp = 25.0;
        for (rate_s, dt_s) in walk {
            temp = (temp + rate_s * dt_s).clamp(-55.0, 145.0);
            let interval = Interval::new(&RICH_THERMAL, dt_s);
            let out = unit.step(&interval, temp, [0.0; 2]);
            let place = RICH_TABLE.place(out.point.effective_c);
            let plain = without_history(&RICH_TABLE, &out.point);
            for (axis, terms) in RICH_TABLE.cells()[place.cell].iter().enumerate() {
                let [s0, s1] = terms.s;
                let mut bias = plain[axis] + out.point.lag2_c * (s0 + place.z * s1);
                bias += GAINS[0][axis] * out.point.plays_c[0];
                bias += GAINS[1][axis] * out.point.plays_c[1];
                prop_assert_eq!(out.bias[axis], bias);
            }
        }
    }

    /// After power-on the bias is the table's, whatever was before.
    #[test]
    fn the_start_adds_nothing(
        before in prop::collection::vec(-60.0_f32..150.0, 0..20),
        temp in -39.0_f32..79.0,
    ) {
        let mut unit = Compensator::new(&RICH_TABLE);
        let mut half = ThermalHalf::new(&RICH_TABLE, 4);
        for before in before {
            unit.step(&RICH_SECOND, before, [0.0; 2]);
            half.update(&RICH_SECOND, before);
        }
        unit.start(temp);
        let ramp = half.start(temp);
        let out = unit.step(&RICH_SECOND, temp, [0.0; 2]);
        let table = without_history(&RICH_TABLE, &out.point);
        prop_assert_eq!(out.bias, table);
        prop_assert_eq!((ramp.end, ramp.slope), (table, [0.0; 2]));
        prop_assert_eq!(out.status, Status::SETTLING);
    }
}

#[test]
fn the_loop_is_closed_and_twice_the_half_width_wide() {
    let mut play = Play::new(20.0);
    let mut pass =
        |from, to| -> Vec<f32> { ramp(from, to, 60).map(|v| play.follow(3.0, v)).collect() };
    // The first way up begins at the middle of the slot and so belongs to no loop.
    pass(20.0, 50.0);
    let (down, up) = (pass(50.0, 20.0), pass(20.0, 50.0));
    assert_eq!(
        (pass(50.0, 20.0), pass(20.0, 50.0)),
        (down.clone(), up.clone())
    );
    // Half a degree a step: at 35 degC both branches are apart by the whole width.
    assert_eq!((up[29], down[29]), (3.0, -3.0));
    let enclosed = 0.5 * (up.iter().sum::<f32>() - down.iter().sum::<f32>());
    // A parallelogram of 6 degC by 30 degC less 6 degC.
    assert!((enclosed - 6.0 * 24.0).abs() < 4.0, "{enclosed}");
}

fn with_tau2(tau2_s: f32) -> tempco::Thermal {
    thermal(ThermalSettings {
        tau2_s,
        lag2_min_c: -1e3,
        lag2_max_c: 1e3,
        tau_s: 6000.0,
        ..SETTINGS
    })
}

/// The lag of the recursion in f64, with the exponential in place of the series.
fn reference(tau_s: f64, dt_s: f64, start: f64, path: &[f32]) -> Vec<f64> {
    let alpha = -(-dt_s / tau_s).exp_m1();
    let mut slow = start;
    let lag = |&temp: &f32| {
        let temp = f64::from(temp);
        slow += alpha * (temp - slow);
        temp - slow
    };
    path.iter().map(lag).collect()
}

/// On its own, and in the thermal path behind gate and slew.
#[test]
fn the_second_lag_follows_the_recursion_in_f64() {
    for &(tau2_s, dt_s) in first(
        &[(1800.0, 1.0), (60.0, 0.1), (60.0, 29.0), (60000.0, 20.0)],
        1,
    ) {
        let thermal = with_tau2(tau2_s);
        let interval = Interval::new(&thermal, dt_s);
        // Up, held, down and a wobble.
        let wave = |i: usize| match i % 3000 {
            i @ 0..1000 => 0.05 * i as f32,
            1000..2000 => 50.0,
            i => 50.0 - 0.05 * (i - 2000) as f32 + 0.04 * (i as f32 * 0.3).sin(),
        };
        let path: Vec<f32> = (0..fewer(9000, 300)).map(|i| 25.0 + wave(i)).collect();
        let mut lag2 = SecondLag::new(path[0]);
        let mut state = ThermalState::new(&thermal);
        state.start(&thermal, path[0]);
        let expected = reference(
            f64::from(tau2_s),
            f64::from(dt_s),
            f64::from(path[0]),
            &path,
        );
        let largest = expected
            .iter()
            .fold(0.0, |most, lag: &f64| lag.abs().max(most));
        // The documented error of alpha, at its limit and well below.
        let allowed = if dt_s > 0.1 * tau2_s { 1e-2 } else { 1e-4 } * largest + 1e-5;
        for (temp, expected) in path.iter().zip(expected) {
            let lag = f64::from(lag2.update(&interval, *temp));
            assert!(
                (lag - expected).abs() < allowed,
                "{lag}, {expected}, {tau2_s} s"
            );
            // Where an update is short the slew holds the temperature back for a while.
            let point = state.update(&thermal, &interval, *temp);
            let lag = f64::from(point.lag2_c);
            assert!(
                dt_s < 1.0 || (lag - expected).abs() < allowed,
                "{lag}, {expected}"
            );
        }
    }
}

/// At 1 kHz an increment of the slowest part is a tenth of a last place.
#[test]
fn the_slowest_part_does_not_stand_still() {
    let interval = Interval::new(&with_tau2(60_000.0), 1e-3);
    let steps = fewer(1_000_000, 2000);
    let mut slow = SecondLag::new(60.0);
    let lag = (0..steps).fold(0.0, |_, _| slow.update(&interval, 70.0));
    let expected = 10.0 * (-(steps as f64) * 1e-3 / 60_000.0).exp();
    let gone = (10.0 - f64::from(lag)) / (10.0 - expected);
    let rounding = 1e-6 / (10.0 - expected);
    assert!(
        (gone - 1.0).abs() < 1e-3 + rounding,
        "{gone} of what there is to go"
    );
}

#[test]
fn a_lag_begins_anew_after_half_its_time_constant_and_not_before() {
    let thermal = thermal(ThermalSettings {
        tau2_s: 1800.0,
        ..RICH
    });
    let mut slow = SecondLag::new(25.0);
    let lag = |slow: &mut SecondLag, dt_s| slow.update(&Interval::new(&thermal, dt_s), 35.0);
    // Much too long for the rate estimator, whose time constant is 60 s.
    let kept = lag(&mut slow, 600.0);
    assert!(
        (kept / 10.0 - (-600.0_f32 / 1800.0).exp()).abs() < 2e-3,
        "{kept}"
    );
    for dt_s in [0.0, -1.0, f32::NAN] {
        assert!((lag(&mut slow, dt_s) - kept).abs() < 1e-5);
    }
    for dt_s in [900.1, 1e9, f32::MAX, f32::INFINITY] {
        let mut slow = slow;
        assert_eq!(lag(&mut slow, dt_s), 0.0);
        assert!(lag(&mut slow, 1.0).abs() < 1e-5);
    }
}

/// A unit that is switched on in a ramp: where its plays are follows from the rate.
#[test]
fn plays_are_put_once_two_minutes_after_power_on() {
    for (start_min, rate) in [(2.0_f32, 1.5_f32), (2.0, -1.5), (0.5, 1.5), (-1000.0, 1.5)] {
        for dt_s in [1.0_f32, 0.1, 7.0] {
            let settings = ThermalSettings {
                rate_start: 1.0,
                play_start_min: start_min,
                tau_s: 30.0,
                ..RICH
            };
            let (with, without) = (
                thermal(settings),
                thermal(ThermalSettings {
                    rate_start: 0.0,
                    ..settings
                }),
            );
            let run = |thermal: &tempco::Thermal, seconds: f32| {
                let interval = Interval::new(thermal, dt_s);
                let mut state = ThermalState::new(thermal);
                state.start(thermal, 20.0);
                let temp = |i: i32| 20.0 + rate / 60.0 * dt_s * i as f32;
                let count = (seconds / dt_s).round() as i32;
                (1..=count)
                    .map(|i| state.update(thermal, &interval, temp(i)))
                    .last()
                    .unwrap()
            };
            let at = (120.0 / dt_s).ceil() * dt_s;
            let before = run(&with, at - dt_s);
            assert_eq!(before.plays_c, run(&without, at - dt_s).plays_c);
            assert!(before.status.contains(Status::SETTLING));
            assert_eq!(run(&without, at).status, Status::OK);
            let put = run(&with, at);
            assert_eq!(put.status, Status::OK);
            for (play_c, width) in put.plays_c.into_iter().zip(HALF_WIDTHS) {
                let expected = (start_min * put.rate_c_per_min).clamp(-width, width);
                assert!((play_c - expected).abs() < 1e-5, "{play_c}, {expected}");
            }
            // From then on they are dragged, and not put again: back by the whole width.
            let later = run(&with, at + 600.0);
            for (play_c, width) in later.plays_c.into_iter().zip(HALF_WIDTHS) {
                let expected = rate.signum() * width;
                assert!((play_c - expected).abs() < 1e-4, "{later:?}");
            }
        }
    }
}

/// Power-on in the middle of a ramp: two minutes later all is as in a unit that was never off.
#[test]
fn a_ramp_that_lasts_is_known_two_minutes_after_power_on() {
    for (rate, least_divisor) in [(0.3_f32, 1.0_f32), (-0.3, 1.0), (0.3, 0.0)] {
        let settings = ThermalSettings {
            tau_s: 600.0,
            tau2_s: 1800.0,
            kappa: 1.5,
            lag2_min_c: -50.0,
            lag2_max_c: 50.0,
            play_kappa: -1.5,
            least_divisor,
            // With a divisor of 1 the rate has come so far after 120 s.
            rate_start: match least_divisor {
                1.0 => 1.0 / -(-0.2_f32).exp_m1(),
                _ => 1.0,
            },
            lag2_start_min: 1800.0 / 60.0,
            play_start_min: 1000.0,
            ..RICH
        };
        let thermal = thermal(settings);
        let second = Interval::new(&thermal, 1.0);
        let temp = |s: usize| 40.0 + rate / 60.0 * (s as f32 - 9000.0);
        let mut never_off = ThermalState::new(&thermal);
        never_off.start(&thermal, temp(0));
        (1..=9000).for_each(|s| {
            never_off.update(&thermal, &second, temp(s));
        });
        let mut switched_on = ThermalState::new(&thermal);
        switched_on.start(&thermal, temp(9000));
        for s in 9001..9900 {
            let expected = never_off.update(&thermal, &second, temp(s));
            let point = switched_on.update(&thermal, &second, temp(s));
            let passed_s = s - 9000;
            assert_eq!(
                passed_s < 120 && point.status.contains(Status::SETTLING),
                passed_s < 120
            );
            if passed_s < 120 {
                continue;
            }
            let error = (point.rate_c_per_min - expected.rate_c_per_min).abs();
            assert!(error < 0.003, "{point:?} {expected:?}");
            assert!(
                (point.lag2_c - expected.lag2_c).abs() < 0.1,
                "{point:?} {expected:?}"
            );
            for (play_c, expected_c) in point.plays_c.into_iter().zip(expected.plays_c) {
                assert!((play_c - expected_c).abs() < 1e-3, "{point:?} {expected:?}");
            }
            // What the curve is evaluated at gets there no faster than the part can.
            if passed_s > 150 {
                assert!((point.effective_c - expected.effective_c).abs() < 0.1);
            }
        }
    }
}

/// Beside a unit without the rule of the start.
#[test]
fn nothing_is_put_while_the_temperature_is_lost() {
    let of = |rate_start| {
        thermal(ThermalSettings {
            rate_start,
            play_start_min: 100.0,
            lag2_start_min: 10.0,
            hold_s: 10.0,
            ..RICH
        })
    };
    let thermals = [of(2.0), of(0.0)];
    for (lost, is_put) in [(100..=140, false), (0..=0, true)] {
        let mut states = thermals.each_ref().map(ThermalState::new);
        for (state, thermal) in states.iter_mut().zip(&thermals) {
            state.start(thermal, 20.0);
        }
        let mut differs = false;
        for s in 1..260 {
            let is_lost = lost.contains(&s);
            let temp_c = if is_lost {
                f32::NAN
            } else {
                20.0 + 0.02 * s as f32
            };
            let [with, without] = core::array::from_fn(|of| {
                let second = Interval::new(&thermals[of], 1.0);
                states[of].update(&thermals[of], &second, temp_c)
            });
            differs |= with.plays_c != without.plays_c
                || with.lag2_c != without.lag2_c
                || with.rate_c_per_min != without.rate_c_per_min;
        }
        assert_eq!(differs, is_put);
    }
}

/// Whatever the readings and intervals, rate, lag and plays included: one update moves a play by
/// no more than the slew and the weight, but for the moment when it is put.
#[test]
fn no_reading_makes_a_step_of_the_history() {
    for seed in 1..fewer(60, 3) as u64 {
        let mut noise = Noise(seed);
        let mut state = ThermalState::new(&RICH_THERMAL);
        let mut last = state.start(&RICH_THERMAL, 20.0);
        for _ in 0..fewer(3000, 100) {
            let dt_s = [1.0, 0.1, 5.0, 30.0][noise.bits() as usize % 4];
            let temp = match noise.bits() % 16 {
                0..8 => noise.between(19.0, 22.0),
                8..10 => noise.between(-60.0, 150.0),
                10 => 150.0,
                _ => [f32::NAN, f32::INFINITY][noise.bits() as usize % 2],
            };
            let point = state.update(&RICH_THERMAL, &Interval::new(&RICH_THERMAL, dt_s), temp);
            let (slew, fade) = (SLEW_C * dt_s, dt_s / 60.0);
            let plays = point.plays_c.into_iter().zip(last.plays_c);
            for ((play_c, last_c), width) in plays.zip(HALF_WIDTHS) {
                assert!(play_c.abs() <= width + 1e-4);
                let moved = (play_c - last_c).abs();
                assert!(moved <= slew + fade * width + 1e-4, "{last:?} {point:?}");
            }
            let most = RICH.lag2_max_c;
            let moved = (point.lag2_c - last.lag2_c).abs();
            let decay = dt_s / RICH.tau2_s * (most + slew);
            assert!(
                moved <= slew + fade * most + decay + 1e-4,
                "{last:?} {point:?}"
            );
            last = point;
        }
    }
}

/// A late first temperature is a start for the history, but not for the status.
#[test]
fn where_there_was_no_temperature_the_history_begins_at_the_first_one() {
    for missing in [1, 200] {
        let mut state = ThermalState::new(&RICH_THERMAL);
        state.start(&RICH_THERMAL, f32::NAN);
        let mut update = |temp| state.update(&RICH_THERMAL, &RICH_SECOND, temp);
        for temp in std::iter::repeat_n(f32::NAN, missing).chain([-30.0]) {
            let point = update(temp);
            assert_eq!((point.lag2_c, point.plays_c), (0.0, [0.0; PLAYS]));
        }
        for second in 0..1000 {
            let point = update(-30.0);
            assert_eq!(
                (point.lag2_c, point.plays_c),
                (0.0, [0.0; PLAYS]),
                "{second}"
            );
            assert!(point.status.contains(Status::HISTORY_UNKNOWN));
        }
    }
}

#[test]
fn the_status_is_that_of_a_lag_beyond_what_was_calibrated() {
    for (rate, limit) in [(2.0_f32, RICH.lag2_max_c), (-2.0, RICH.lag2_min_c)] {
        let mut state = ThermalState::new(&RICH_THERMAL);
        state.start(&RICH_THERMAL, 40.0);
        let mut clamped = 0;
        for s in 1..3000 {
            let temp = 40.0 + rate / 60.0 * s as f32;
            let point = state.update(&RICH_THERMAL, &RICH_SECOND, temp.clamp(-59.0, 149.0));
            let is_clamped = point.status.contains(Status::LAG_CLAMPED);
            assert_eq!(is_clamped, point.lag2_c == limit, "{s} s");
            clamped += u32::from(is_clamped);
        }
        assert!(clamped > 500, "{clamped}");
    }
}

/// Without second lag and plays there is nothing of either, and no flag of theirs.
#[test]
fn the_default_settings_have_no_history() {
    let flags = Status::LAG_CLAMPED | Status::HISTORY_UNKNOWN;
    let mut noise = Noise(3);
    let mut state = ThermalState::new(&THERMAL);
    for i in 0..fewer(20_000, 300) {
        let temp = noise.between(-70.0, 160.0) * [0.1, 1.0][i / 50 % 2];
        let interval = Interval::new(&THERMAL, noise.between(0.0, 40.0));
        let point = state.update(&THERMAL, &interval, temp);
        assert_eq!((point.lag2_c, point.plays_c), (0.0, [0.0; PLAYS]));
        assert!(!point.status.intersects(flags));
    }
}

#[test]
fn both_halves_end_at_the_bias_of_a_single_step() {
    let mut unit = Compensator::new(&RICH_TABLE);
    let mut half = ThermalHalf::new(&RICH_TABLE, 4);
    unit.start(25.0);
    half.start(25.0);
    for second in 0..600 {
        let temp = 25.0 + 10.0 * (second as f32 * 0.01).sin();
        let out = unit.step(&RICH_SECOND, temp, [0.0; 2]);
        assert_eq!(half.update(&RICH_SECOND, temp).end, out.bias);
    }
}

#[test]
fn gains_of_zero_change_no_bit_of_the_bias() {
    let table = table(RICH_THERMAL);
    let none = table.with_plays([[0.0; 2]; PLAYS]).unwrap();
    assert_eq!(none, table);
    let mut unit = Compensator::new(&none);
    for second in 0..fewer(2000, 50) {
        let temp = 25.0 + 60.0 * (second as f32 * 0.003).sin();
        let out = unit.step(&RICH_SECOND, temp, [1.0, 2.0]);
        assert!(second < 200 || out.point.plays_c[0] != 0.0);
        assert_eq!(out.bias, without_history(&none, &out.point));
    }
}

#[test]
fn gains_that_are_no_figures_are_refused() {
    for (gain, refused) in [
        (f32::NAN, true),
        (f32::INFINITY, true),
        (f32::NEG_INFINITY, true),
        (f32::next_up(1e20), true),
        (1e20, false),
        (-1e20, false),
    ] {
        for (play, axis) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let mut gains = GAINS;
            gains[play][axis] = gain;
            let found = TABLE.with_plays(gains);
            let expected = Err(TableError::Setting("play_gains"));
            assert_eq!(
                found.map(|table| *table.play_gains()),
                if refused { expected } else { Ok(gains) }
            );
        }
    }
}

// The compiler refuses it as well.
const _: () = assert!(
    rich_table(THERMAL)
        .with_plays([[f32::NAN; 2]; PLAYS])
        .is_err()
);

#[test]
fn a_table_tells_its_gains() {
    assert_eq!(RICH_TABLE.play_gains(), &GAINS);
    assert_eq!(TABLE.play_gains(), &[[0.0; 2]; PLAYS]);
    let narrower = RICH_TABLE.calibrated(-30.0, 70.0).unwrap();
    assert_eq!(narrower.play_gains(), &GAINS);
}
