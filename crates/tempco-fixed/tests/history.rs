//! Terms of the thermal history: the integer core beside the f32 core.

mod common;

use common::*;
use tempco::{Compensator, Interval, Play, SlowPart, Table};
use tempco_fixed::{
    FixedCompensator, FixedError, FixedInterval, FixedTable, FixedTwoRate, from_f32,
};

const PLAY: Play<2> = Play {
    half_width_c: 3.0,
    gain: [0.01, -0.02],
};
const SLOW: SlowPart<2> = SlowPart {
    tau_s: 1800.0,
    limit_c: 10.0,
    gain: [0.03, 0.005],
};
static F32: Table<'static, 2, 1, 1> = match F32_TABLE.with_history([PLAY], [SLOW]) {
    Ok(table) => table,
    Err(error) => panic!("{}", error.message()),
};
static FIXED: FixedTable<2, COUNT, 1, 1> = match FixedTable::new(&F32) {
    Ok(table) => table,
    Err(error) => panic!("{}", error.message()),
};

/// Both terms in f64, of the effective temperatures that the integer core had.
struct Reference {
    contact: f64,
    slow: f64,
}

impl Reference {
    /// The sum of the terms of each axis.
    fn update(&mut self, u: f64, dt_s: f64) -> [f64; 2] {
        let width = f64::from(PLAY.half_width_c);
        self.contact = self.contact.clamp(u - width, u + width);
        let x = dt_s / f64::from(SLOW.tau_s);
        let alpha = x * (1.0 - x / 2.0 * (1.0 - x / 3.0));
        self.slow += if x > 0.5 { 1.0 } else { alpha } * (u - self.slow);
        let limit = f64::from(SLOW.limit_c);
        let lag = (u - self.slow).clamp(-limit, limit);
        [0, 1].map(|axis| {
            f64::from(PLAY.gain[axis]) * (u - self.contact) + f64::from(SLOW.gain[axis]) * lag
        })
    }
}

/// What the terms add is within what they add to the bound; the whole bias is near that of the
/// f32 core.
#[test]
fn the_terms_are_within_their_share_of_the_bound() {
    let mut noise = Noise(0x6869_7374);
    let mut unit = FixedCompensator::new(&FIXED);
    let mut f32_unit = Compensator::new(&F32);
    unit.start(from_f32(25.0));
    f32_unit.start(25.0);
    let mut reference = Reference {
        contact: 25.0,
        slow: 25.0,
    };
    let (mut speed, mut temp, mut worst) = (0.0, 25.0_f32, [0.0_f64; 2]);
    for i in 0..40_000 {
        if i % 300 == 0 {
            speed = noise.between(-0.2, 0.2);
        }
        temp = ((temp + speed).clamp(-39.0, 79.0) * 1024.0).round() / 1024.0;
        let dt_s = match noise.bits() % 2000 {
            0 => 600.0,
            1 => 1000.0,
            2 => 0.0,
            _ => [0.1, 1.0, 5.0][i / 4000 % 3],
        };
        let interval = FixedInterval::new(FIXED.thermal(), dt_s);
        let out = unit.step(&interval, from_f32(temp), [0; 2]);
        let expected = f32_unit.step(&Interval::new(&THERMAL, dt_s), temp, [0.0; 2]);
        let (table, status) = FIXED.bias(&out.point);
        assert_eq!(out.status, status);
        let terms = reference.update(f64::from(out.point.effective) / 1_048_576.0, dt_s.into());
        for axis in 0..2 {
            let unit = f64::from(FIXED.exponents()[axis]).exp2();
            let added = f64::from(out.bias[axis] - table[axis]) * unit;
            worst[axis] = worst[axis].max((added - terms[axis]).abs());
            let f32_error = f64::from(out.bias[axis]) * unit - f64::from(expected.bias[axis]);
            assert!(f32_error.abs() < 3e-4, "{f32_error} at {i}");
        }
    }
    for (axis, worst) in worst.into_iter().enumerate() {
        let unit = f64::from(FIXED.exponents()[axis]).exp2();
        let gains = f64::from(PLAY.gain[axis].abs() + SLOW.gain[axis].abs());
        // With what f64 loses in the sum of 40 000 steps.
        let bound = 2.5 * unit + 2.0 * gains / 1_048_576.0 + 1e-12;
        assert!(worst <= bound, "{worst} of {bound}");
        let plain = FixedTable::<2, COUNT>::with_exponents(&F32_TABLE, *FIXED.exponents());
        let more = FIXED.error_bounds()[axis] - plain.unwrap().error_bounds()[axis];
        assert!((more / (bound - 1e-12) - 1.0).abs() < 1e-6, "{more}");
    }
}

#[test]
fn a_table_without_terms_has_the_size_it_had() {
    assert_eq!(
        size_of::<FixedCompensator<'static, 2, COUNT>>() + 16,
        size_of::<FixedCompensator<'static, 2, COUNT, 1, 1>>()
    );
}

#[test]
fn the_start_adds_nothing_and_both_compensators_agree() {
    let mut unit = FixedCompensator::new(&FIXED);
    let mut pair = FixedTwoRate::new(&FIXED, 3);
    for start in [70.0, -20.0] {
        unit.start(from_f32(start));
        pair.start(from_f32(start));
        let out = unit.step(&SECOND, from_f32(start), [0; 2]);
        assert_eq!(out.bias, FIXED.bias(&out.point).0);
        assert_eq!(pair.compensate([0; 2]).bias, out.bias);
        pair.update(&SECOND, from_f32(start));
        for second in 0..2000 {
            let temp = from_f32(start + 8.0 * (second as f32 * 0.005).sin());
            let out = unit.step(&SECOND, temp, [0; 2]);
            pair.update(&SECOND, temp);
            pair.compensate([0; 2]);
            pair.compensate([0; 2]);
            assert_eq!(pair.compensate([0; 2]).bias, out.bias);
        }
    }
}

/// At 1 kHz the slowest part moves by a fraction of a last place of its temperature.
#[test]
fn the_slowest_part_does_not_stand_still() {
    let gain = [1.0, 0.0];
    let part = SlowPart {
        tau_s: 60_000.0,
        limit_c: 1000.0,
        gain,
    };
    let f32_table = F32_TABLE.with_history([], [part]).unwrap();
    let table = FixedTable::<2, COUNT, 0, 1>::new(&f32_table).unwrap();
    let mut unit = FixedCompensator::new(&table);
    unit.start(from_f32(60.0));
    let second = FixedInterval::new(table.thermal(), 1.0);
    let warm = from_f32(62.0);
    for _ in 0..10 {
        unit.step(&second, warm, [0; 2]);
    }
    let interval = FixedInterval::from_micros(table.thermal(), 1000);
    let mut lag = |steps| {
        let mut out = unit.step(&interval, warm, [0; 2]);
        for _ in 1..steps {
            out = unit.step(&interval, warm, [0; 2]);
        }
        let added = out.bias[0] - table.bias(&out.point).0[0];
        f64::from(added) * f64::from(table.exponents()[0]).exp2()
    };
    let before = lag(1);
    let gone = before - lag(300_000);
    assert!(
        (gone / (before * 300.0 / 60_000.0) - 1.0).abs() < 4e-3,
        "{gone} of {before}"
    );
}

/// The terms count in what has to fit: with a large gain a last place must be larger.
#[test]
fn an_exponent_that_the_terms_do_not_fit_is_refused() {
    let play = Play {
        gain: [1e20, 0.0],
        ..PLAY
    };
    let table = F32_TABLE.with_history([play], []).unwrap();
    let plain = TABLE.exponents();
    let refused = FixedTable::<2, COUNT, 1, 0>::with_exponents(&table, *plain).err();
    assert_eq!(refused, Some(FixedError::Exponent { axis: 0 }));
    let fixed = FixedTable::<2, COUNT, 1, 0>::new(&table).unwrap();
    assert!(fixed.exponents()[0] > plain[0] + 60);
    assert_eq!(fixed.exponents()[1], plain[1]);
}
