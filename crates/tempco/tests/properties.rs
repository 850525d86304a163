//! What holds for every input: any bit pattern as temperature, gyro sample or interval.

mod common;

use common::*;
use proptest::prelude::*;
use tempco::{Compensator, Interval, Output, Status, Table, ThermalSettings};

/// Any f32 at all, with the plausible ones and the borders as likely as the absurd ones.
fn number() -> impl Strategy<Value = f32> {
    let special = vec![
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        0.0,
        -0.0,
        1e-45,
        -60.0,
        150.0,
        150.000_02,
    ];
    prop_oneof![
        any::<u32>().prop_map(f32::from_bits),
        -70.0_f32..160.0,
        20.0_f32..24.0,
        prop::sample::select(special),
    ]
}

fn interval_s() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => 1e-4_f32..30.0,
        2 => Just(1.0_f32),
        1 => 0.0_f32..100.0,
        1 => number(),
    ]
}

/// Settings from sluggish to hasty, with the shift of the lag-compensated temperature on or off.
fn settings() -> impl Strategy<Value = ThermalSettings> {
    let kappa = prop_oneof![Just(0.0_f32), 0.0_f32..=2.0];
    (
        0.1_f32..20.0,
        1.0_f32..100.0,
        0.0_f32..200.0,
        1.0_f32..600.0,
        kappa,
    )
        .prop_map(|(gate, slew, hold_s, tau_s, kappa)| ThermalSettings {
            spike_gate_c: gate,
            max_slew_c_per_min: slew,
            hold_s,
            tau_s,
            kappa,
            ..SETTINGS
        })
}

type Sample = (f32, f32, [f32; 2]);

fn stream(length: usize) -> impl Strategy<Value = Vec<Sample>> {
    let raw = [number(), number()];
    prop::collection::vec((interval_s(), number(), raw), 1..fewer(length, 20))
}

fn run(table: &Table<'static, 2>, stream: &[Sample]) -> Vec<Output<2>> {
    let mut unit = Compensator::new(table);
    let step =
        |&(dt_s, temp, raw): &Sample| unit.step(&Interval::new(table.thermal(), dt_s), temp, raw);
    stream.iter().map(step).collect()
}

/// One rounding of the lag-compensated temperature to f32, at the far end of any sensor.
fn last_place(value: f32) -> f32 {
    value.abs().max(1.0) * f32::EPSILON
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(500), failure_persistence: None, ..Default::default() })]

    #[test]
    fn the_bias_is_finite_and_the_output_is_raw_less_bias(
        settings in settings(),
        stream in stream(200),
    ) {
        for (out, (_, _, raw)) in run(&table(thermal(settings)), &stream).iter().zip(&stream) {
            for ((raw, bias), compensated) in raw.iter().zip(out.bias).zip(out.compensated) {
                prop_assert!(bias.is_finite());
                let exact = raw - bias;
                prop_assert!(compensated.to_bits() == exact.to_bits() || exact.is_nan());
                prop_assert_eq!(compensated.is_nan(), raw.is_nan());
            }
            let valid = raw[0].is_finite() && raw[1].is_finite();
            prop_assert_eq!(out.status.contains(Status::RAW_INVALID), !valid);
            prop_assert!(out.point.effective_c.is_finite());
            let rate = out.point.rate_c_per_min;
            prop_assert!((-30.0..=30.0).contains(&rate));
        }
    }

    /// With the table's Lipschitz bounds this limits the step of the bias at every update.
    #[test]
    fn the_bias_moves_no_faster_than_slew_and_rate_allow(
        settings in settings(),
        stream in stream(200),
    ) {
        let table = table(thermal(settings));
        let bounds = [0, 1].map(|axis| lipschitz(&table, axis));
        let outs = run(&table, &stream);
        for (pair, (dt_s, ..)) in outs.windows(2).zip(&stream[1..]) {
            let [before, after] = [pair[0], pair[1]];
            let dt_s = if *dt_s > 0.0 { dt_s.min(0.5 * settings.tau_s) } else { 0.0 };
            let slew = settings.max_slew_c_per_min / 60.0 * dt_s * 1.000_001;
            // The least slew keeps the last place of a hot temperature from stopping it.
            let slew = if dt_s > 0.0 { slew.max(2e-5) } else { 0.0 };
            let moved = (after.point.effective_c - before.point.effective_c).abs();
            let rounding = 2.0 * last_place(after.point.effective_c);
            prop_assert!(moved <= slew + rounding, "{} of {} degC", moved, slew);

            let turned = (after.point.rate_c_per_min - before.point.rate_c_per_min).abs();
            for (axis, bound) in bounds.iter().enumerate() {
                let change = (after.bias[axis] - before.bias[axis]).abs();
                // 12 cells over 120 degC in f32: the place is good to some 1e-6 of a cell.
                let allowed = bound.per_c * moved + bound.per_rate * turned + 2e-5;
                prop_assert!(change <= allowed, "{} of {}", change, allowed);
            }
        }
    }

    #[test]
    fn two_runs_give_the_same_bits(settings in settings(), stream in stream(100)) {
        let table = table(thermal(settings));
        for (one, two) in run(&table, &stream).iter().zip(run(&table, &stream)) {
            prop_assert_eq!(bits(one), bits(&two));
            prop_assert_eq!(one.status, two.status);
        }
    }

    #[test]
    fn neither_the_payload_of_a_nan_nor_the_gyro_reaches_bias_or_status(
        stream in stream(100),
        payload in 1_u32..0x7f_ffff,
        other in [number(), number()],
    ) {
        let nan = f32::from_bits(0xff80_0000 | payload);
        let changed: Vec<Sample> = stream
            .iter()
            .map(|&(dt_s, temp, _)| (dt_s, if temp.is_nan() { nan } else { temp }, other))
            .collect();
        for (one, two) in run(&TABLE, &stream).iter().zip(run(&TABLE, &changed)) {
            prop_assert_eq!(one.bias.map(f32::to_bits), two.bias.map(f32::to_bits));
            prop_assert_eq!(one.point.status, two.point.status);
        }
    }

    /// Whatever happened, three time constants and the longest ramp later nothing is left but the
    /// memory of a jump.
    #[test]
    fn after_any_stream_a_good_temperature_heals_everything(
        stream in stream(100),
        temp in -39.0_f32..79.0,
    ) {
        let mut unit = Compensator::new(&TABLE);
        for (dt_s, temp, raw) in stream {
            unit.step(&Interval::new(&THERMAL, dt_s), temp, raw);
        }
        // At the longest: the gate opens, the estimator settles, the temperature arrives. What
        // was accepted last may lie 210 degC away, so the old rate needs longer to fade.
        let outs = feed(&mut unit, vec![temp; HOLD_S + 2 + 900]);
        let last = outs.last().unwrap();
        prop_assert_eq!(last.status | Status::TEMPERATURE_JUMPED, Status::TEMPERATURE_JUMPED);
        prop_assert!((last.point.effective_c - temp).abs() <= last_place(temp));
        prop_assert!(last.point.rate_c_per_min.abs() < 1e-3);
    }

    #[test]
    fn a_good_stream_is_ok_once_it_is_settled(
        start in -30.0_f32..70.0,
        rates in prop::collection::vec(-20.0_f32..20.0, 30),
        noise in 0.0_f32..1.0,
    ) {
        let mut unit = Compensator::new(&TABLE);
        unit.start(start);
        let mut temp = start;
        for second in 1..900 {
            let next = temp + rates[second / 30] / 60.0;
            temp = if next.abs() < 39.0 || next.abs() < temp.abs() { next } else { temp };
            let wobble = if second % 2 == 0 { noise } else { -noise };
            let out = feed(&mut unit, [temp + wobble])[0];
            let expected = if second < SETTLE_S { Status::SETTLING } else { Status::OK };
            prop_assert_eq!(out.status, expected, "{} s", second);
        }
    }

    /// A held temperature is a second old. On a ramp that shifts the rate by (dt / tau)^2 of it
    /// afterwards, one part in 3600, and the lag-compensated temperature not at all.
    #[test]
    fn one_bad_temperature_is_forgotten(
        ramp in -10.0_f32..10.0,
        bad in number(),
    ) {
        let temp = |s: i32| 20.0 + ramp / 60.0 * s as f32;
        let believable = (bad - temp(0)).abs() <= 2.6;
        prop_assume!(!believable);
        let mut unit = on_ramp_or_still(temp(0), ramp);
        let mut twin = unit.clone();
        let hit = feed(&mut unit, [bad])[0];
        let good = feed(&mut twin, [temp(1)])[0];
        prop_assert!(hit.status.contains(Status::SETTLING));
        let stale = ramp.abs() / 60.0 + 1e-4;
        prop_assert!((hit.point.effective_c - good.point.effective_c).abs() <= stale);
        prop_assert!((hit.point.rate_c_per_min - good.point.rate_c_per_min).abs() <= stale);

        let later = (2..60).map(temp);
        let outs = feed(&mut unit, later.clone());
        for (second, (out, good)) in (1..).zip(outs.iter().zip(feed(&mut twin, later))) {
            let lag = (out.point.effective_c - good.point.effective_c).abs();
            prop_assert!(lag <= last_place(good.point.effective_c), "{} degC", lag);
            let turn = (out.point.rate_c_per_min - good.point.rate_c_per_min).abs();
            prop_assert!(turn <= ramp.abs() / 3500.0 + 1e-4, "{} degC/min", turn);
            prop_assert_eq!(out.status == Status::OK, second >= HEAL_S);
        }
    }
}

fn on_ramp_or_still(temp_c: f32, rate: f32) -> Compensator<'static, 2> {
    if rate.abs() < 0.1 {
        settled(temp_c)
    } else {
        on_ramp(temp_c, rate)
    }
}
