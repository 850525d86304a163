//! Terms of the thermal history: hysteresis and a second lag, on their own and on top of a table.

mod common;

use common::*;
use proptest::prelude::*;
use tempco::{
    Compensator, History, HistoryState, Interval, Play, SlowPart, Table, TableError, ThermalHalf,
};

const PLAY: Play<2> = Play {
    half_width_c: 3.0,
    gain: [0.01, -0.02],
};
const SLOW: SlowPart<2> = SlowPart {
    tau_s: 1800.0,
    limit_c: 20.0,
    gain: [0.03, 0.005],
};
/// The table of the other tests with one term of each kind; a bad one would not compile.
static WITH_HISTORY: Table<'static, 2, 1, 1> = match TABLE.with_history([PLAY], [SLOW]) {
    Ok(table) => table,
    Err(error) => panic!("{}", error.message()),
};

fn play(half_width_c: f32) -> History<1, 1> {
    let gain = [1.0];
    History::new(60.0, [Play { half_width_c, gain }], []).unwrap()
}

fn slow_part(tau_s: f32, limit_c: f32) -> History<1, 0, 1> {
    let gain = [1.0];
    let part = SlowPart {
        tau_s,
        limit_c,
        gain,
    };
    History::new(60.0, [], [part]).unwrap()
}

/// How far the contact is behind at each lag-compensated temperature, from a first one on.
fn through_play(history: &History<1, 1>, start: f32, path: &[f32]) -> Vec<f32> {
    let mut state = HistoryState::new(start);
    let update = |&u: &f32| state.update(history, &SECOND, u).plays_c[0];
    path.iter().map(update).collect()
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

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(300), failure_persistence: None, ..Default::default() })]

    #[test]
    fn the_contact_is_never_further_than_the_half_width_but_for_rounding(
        width in 0.0_f32..20.0,
        path in prop::collection::vec(-60.0_f32..150.0, 1..200),
    ) {
        for (u, distance) in path.iter().zip(through_play(&play(width), path[0], &path)) {
            let rounding = f32::EPSILON * (u.abs() + width);
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
        let history = play(width);
        let turning: Vec<f32> = turns.iter().map(|&(turn, _)| turn).collect();
        let coarse = through_play(&history, start, &turning);
        let (mut state, mut from) = (HistoryState::new(start), start);
        for (&(turn, steps), coarse) in turns.iter().zip(coarse) {
            let path = ramp(from, turn, steps);
            let fine = path.map(|u| state.update(&history, &SECOND, u).plays_c[0]).last();
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
        let last = path[path.len() - 1];
        let end = last + direction * 2.001 * width;
        let full = [path.as_slice(), &[end]].concat();
        let distance = *through_play(&play(width), path[0], &full).last().unwrap();
        prop_assert!((distance - direction * width).abs() < 1e-4, "{distance} of {width}");
    }

    /// The bias is the table's, plus the gains times what the terms are on their own.
    #[test]
    fn terms_are_added_to_the_bias_of_the_table(
        walk in prop::collection::vec((-5.0_f32..5.0, 0.1_f32..40.0), 1..200),
    ) {
        let mut plain = Compensator::new(&TABLE);
        let mut unit = Compensator::new(&WITH_HISTORY);
        plain.start(25.0);
        unit.start(25.0);
        let mut state = HistoryState::new(25.0);
        let mut temp = 25.0;
        for (step, dt_s) in walk {
            temp = (temp + step).clamp(-60.0, 150.0);
            let interval = Interval::new(&THERMAL, dt_s);
            let expected = plain.step(&interval, temp, [0.0; 2]);
            let out = unit.step(&interval, temp, [0.0; 2]);
            let past = state.update(WITH_HISTORY.history(), &interval, out.point.effective_c);
            prop_assert_eq!((out.point, out.status), (expected.point, expected.status));
            for axis in 0..2 {
                let bias = expected.bias[axis] + PLAY.gain[axis] * past.plays_c[0];
                prop_assert_eq!(out.bias[axis], bias + SLOW.gain[axis] * past.lags_c[0]);
            }
        }
    }

    /// After power-on the bias is the table's, whatever was before.
    #[test]
    fn the_start_adds_nothing(
        before in prop::collection::vec(-60.0_f32..150.0, 0..20),
        temp in -39.0_f32..79.0,
    ) {
        let mut unit = Compensator::new(&WITH_HISTORY);
        let mut half = ThermalHalf::new(&WITH_HISTORY, 4);
        for before in before {
            unit.step(&SECOND, before, [0.0; 2]);
            half.update(&SECOND, before);
        }
        unit.start(temp);
        let ramp = half.start(temp);
        let out = unit.step(&SECOND, temp, [0.0; 2]);
        let (table, _) = TABLE.bias(&out.point);
        prop_assert_eq!(out.bias, table);
        prop_assert_eq!((ramp.end, ramp.slope), (table, [0.0; 2]));
    }
}

#[test]
fn the_loop_is_closed_and_twice_the_half_width_wide() {
    let history = play(3.0);
    let mut state = HistoryState::new(20.0);
    let mut pass = |from, to| -> Vec<f32> {
        let path = ramp(from, to, 60);
        path.map(|u| state.update(&history, &SECOND, u).plays_c[0])
            .collect()
    };
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

/// The lag of the recursion in f64, with the exponential in place of the series.
fn reference(tau_s: f64, dt_s: f64, start: f64, path: &[f32]) -> Vec<f64> {
    let alpha = -(-dt_s / tau_s).exp_m1();
    let mut slow = start;
    let lag = |&u: &f32| {
        let u = f64::from(u);
        slow += alpha * (u - slow);
        u - slow
    };
    path.iter().map(lag).collect()
}

#[test]
fn a_slow_part_follows_the_recursion_in_f64() {
    for &(tau_s, dt_s) in first(
        &[(1800.0, 1.0), (60.0, 0.1), (60.0, 29.0), (60000.0, 20.0)],
        1,
    ) {
        let history = slow_part(tau_s, 1000.0);
        let interval = Interval::new(&THERMAL, dt_s);
        // Up, held, down and a wobble.
        let wave = |i: usize| match i % 3000 {
            i @ 0..1000 => 0.05 * i as f32,
            1000..2000 => 50.0,
            i => 50.0 - 0.07 * (i - 2000) as f32 + (i as f32 * 0.3).sin(),
        };
        let path: Vec<f32> = (0..fewer(9000, 300)).map(|i| 25.0 + wave(i)).collect();
        let mut state = HistoryState::new(path[0]);
        let expected = reference(f64::from(tau_s), f64::from(dt_s), f64::from(path[0]), &path);
        let largest = expected
            .iter()
            .fold(0.0, |most, lag: &f64| lag.abs().max(most));
        // The documented error of alpha, at its limit and well below.
        let allowed = if dt_s > 0.1 * tau_s { 1e-2 } else { 1e-4 } * largest + 1e-5;
        for (u, expected) in path.iter().zip(expected) {
            let lag = f64::from(state.update(&history, &interval, *u).lags_c[0]);
            assert!(
                (lag - expected).abs() < allowed,
                "{lag}, not {expected}, {tau_s} s"
            );
        }
    }
}

/// At 1 kHz an increment of the slowest part is a tenth of a last place.
#[test]
fn the_slowest_part_does_not_stand_still() {
    let history = slow_part(60_000.0, 1000.0);
    let interval = Interval::new(&THERMAL, 1e-3);
    let steps = fewer(1_000_000, 2000);
    let mut state = HistoryState::new(60.0);
    let lag = (0..steps).fold(0.0, |_, _| {
        state.update(&history, &interval, 70.0).lags_c[0]
    });
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
    let history = slow_part(1800.0, 1000.0);
    let mut state = HistoryState::new(25.0);
    let lag = |state: &mut HistoryState<0, 1>, dt_s| {
        let interval = Interval::new(&THERMAL, dt_s);
        state.update(&history, &interval, 35.0).lags_c[0]
    };
    // Much too long for the rate estimator, whose time constant is 60 s.
    let kept = lag(&mut state, 600.0);
    assert!(
        (kept / 10.0 - (-600.0_f32 / 1800.0).exp()).abs() < 2e-3,
        "{kept}"
    );
    for dt_s in [0.0, -1.0, f32::NAN] {
        assert!((lag(&mut state, dt_s) - kept).abs() < 1e-5);
    }
    for dt_s in [900.1, 1e9, f32::MAX, f32::INFINITY] {
        let mut state = state;
        assert_eq!(lag(&mut state, dt_s), 0.0);
        assert!(lag(&mut state, 1.0).abs() < 1e-5);
    }
}

#[test]
fn a_lag_beyond_what_was_calibrated_is_held_there() {
    for limit in [0.0, -0.0, 4.0] {
        let history = slow_part(1800.0, limit);
        let mut state = HistoryState::new(25.0);
        for (u, expected) in [(27.0, 2.0_f32), (35.0, 10.0), (15.0, -10.0)] {
            let lag = state.update(&history, &SECOND, u).lags_c[0];
            assert!(
                (lag - expected.clamp(-limit.abs(), limit.abs())).abs() < 0.02,
                "{lag}"
            );
        }
    }
}

#[test]
fn both_rates_end_at_the_same_bias() {
    let mut unit = Compensator::new(&WITH_HISTORY);
    let mut half = ThermalHalf::new(&WITH_HISTORY, 4);
    unit.start(25.0);
    half.start(25.0);
    for second in 0..600 {
        let temp = 25.0 + 10.0 * (second as f32 * 0.01).sin();
        let out = unit.step(&SECOND, temp, [0.0; 2]);
        assert_eq!(half.update(&SECOND, temp).end, out.bias);
    }
}

/// A fault moves the lag-compensated temperature to the reference, and the terms with it.
#[test]
fn a_lost_temperature_leaves_the_terms_within_their_bounds() {
    let mut unit = Compensator::new(&WITH_HISTORY);
    unit.start(25.0);
    for second in 0..7200 {
        let temp = if second < 1800 {
            25.0 + second as f32 / 60.0
        } else {
            f32::NAN
        };
        let out = unit.step(&SECOND, temp, [0.0; 2]);
        let (table, _) = TABLE.bias(&out.point);
        let most = PLAY.gain[0] * PLAY.half_width_c + SLOW.gain[0] * SLOW.limit_c;
        assert!((out.bias[0] - table[0]).abs() <= most * 1.0001);
        if second == 7199 {
            // The play stays where the way back left it, and the lag has nearly died out.
            let left = out.bias[0] - constant_bias()[0];
            let play = -PLAY.gain[0] * PLAY.half_width_c;
            assert!((left - play).abs() < 0.05 * SLOW.gain[0] * 20.0, "{left}");
        }
    }
}

#[test]
fn terms_without_gain_change_no_bit() {
    let zero = [0.0; 2];
    let [play, slow] = [Play { gain: zero, ..PLAY }, Play { gain: zero, ..PLAY }];
    let part = SlowPart { gain: zero, ..SLOW };
    let table = TABLE.with_history([play, slow], [part]).unwrap();
    let none = TABLE.with_history([], []).unwrap();
    assert_eq!(none, TABLE);
    let (mut plain, mut unit) = (Compensator::new(&TABLE), Compensator::new(&table));
    for second in 0..fewer(2000, 50) {
        let temp = 25.0 + 60.0 * (second as f32 * 0.003).sin();
        let expected = plain.step(&SECOND, temp, [1.0, 2.0]);
        assert_eq!(bits(&unit.step(&SECOND, temp, [1.0, 2.0])), bits(&expected));
    }
}

#[test]
fn bad_figures_are_refused_by_name() {
    let refused = |play: Play<2>, part: SlowPart<2>| {
        let error = TABLE.with_history([PLAY, play], [SLOW, part]).unwrap_err();
        match error {
            TableError::Setting(name) => name,
            other => panic!("{other}"),
        }
    };
    for bad in [f32::NAN, -0.1, 1000.1, f32::INFINITY] {
        let play = Play {
            half_width_c: bad,
            ..PLAY
        };
        assert_eq!(refused(play, SLOW), "half_width_c");
        let part = SlowPart {
            limit_c: bad,
            ..SLOW
        };
        assert_eq!(refused(PLAY, part), "limit_c");
    }
    for bad in [f32::NAN, 1.1e20, f32::NEG_INFINITY] {
        for gain in [[bad, 0.0], [0.0, bad]] {
            assert_eq!(refused(Play { gain, ..PLAY }, SLOW), "gain of a play");
            assert_eq!(
                refused(PLAY, SlowPart { gain, ..SLOW }),
                "gain of a second thermal lag"
            );
        }
    }
    for tau_s in [f32::NAN, 0.0, 59.9, 60_001.0] {
        let part = SlowPart { tau_s, ..SLOW };
        assert_eq!(refused(PLAY, part), "tau_s of a second thermal lag");
    }
    let fitting = SlowPart {
        tau_s: 60.0,
        ..SLOW
    };
    assert!(TABLE.with_history([PLAY], [fitting]).is_ok());
}

// The compiler refuses it as well.
const _: () = {
    let bad = Play {
        half_width_c: -1.0,
        ..PLAY
    };
    assert!(History::<2, 1>::new(60.0, [bad], []).is_err());
};

#[test]
fn a_table_tells_its_terms() {
    let history = WITH_HISTORY.history();
    assert_eq!((history.plays(), history.slow_parts()), (&[PLAY], &[SLOW]));
    let narrower = WITH_HISTORY.calibrated(-30.0, 70.0).unwrap();
    assert_eq!(narrower.history(), history);
}
