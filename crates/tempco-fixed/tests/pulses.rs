//! No pulse is lost: the sums of whole pulses against the sums of what they stand for.

mod common;

use common::Noise;
use tempco_fixed::{FixedError, PulseCarry, PulseCarryF32};

const SAMPLES: u32 = 1_000_000;

/// Biases of a kind that would be lost if each were rounded on its own, and of any kind.
fn biases(kind: u32) -> impl Iterator<Item = i32> {
    let mut noise = Noise(kind.into());
    (0..SAMPLES).map(move |i| match kind {
        1 => 12_345,
        2 => -1,
        3 => noise.bits() as i32,
        4 => (f64::from(i) * 1e-4).sin().mul_add(3e8, 1e6) as i32,
        _ => [i32::MAX, i32::MIN, i32::MIN + 1, 0][(noise.bits() % 4) as usize],
    })
}

#[test]
fn fixed_pulses_follow_their_sum_within_half_a_pulse() {
    for kind in 1..=5 {
        for (exponent, sample_s) in [
            (-30, 1e-3),
            (-24, 2.5e-4),
            (-31, 1.0),
            (-20, 0.02),
            (-16, 0.7),
        ] {
            let mut carry = PulseCarry::new(exponent, sample_s).unwrap();
            let per_place = f64::from(exponent).exp2() * f64::from(sample_s);
            assert!((carry.pulses_per_place() / per_place - 1.0).abs() < 1e-6);
            // Exact: in units of the last place, as integers.
            let (mut sum, mut out, mut worst) = (0_i64, 0_i64, 0.0_f64);
            for bias in biases(kind) {
                sum += i64::from(bias);
                out += i64::from(carry.pulses(bias));
                let real = sum as f64 * carry.pulses_per_place();
                worst = worst.max((real - out as f64).abs());
            }
            // Beyond 2^-23 pulses f64 cannot tell.
            let f64_rounding = (out as f64).abs() * 2.0_f64.powi(-51);
            assert!(
                worst <= 0.5 + 1e-6 + f64_rounding,
                "{worst} of kind {kind}, {exponent}"
            );
            // Against the real number too: one pulse, where there are fewer than 10^9 of them.
            let real = sum as f64 * per_place;
            let multiplier =
                real.abs() * 2.0_f64.powi(-31) + (sum as f64).abs() * 2.0_f64.powi(-63);
            assert!((real - out as f64).abs() < 1.0 + multiplier, "kind {kind}");
        }
    }
}

/// A bias of a quarter pulse makes every fourth sample a pulse, not a burst.
#[test]
fn pulses_come_evenly() {
    let mut carry = PulseCarry::new(-30, 0.25).unwrap();
    let pulses: Vec<i32> = (0..12).map(|_| carry.pulses(1 << 30)).collect();
    assert_eq!(pulses, [0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0]);
    let mut carry = PulseCarry::new(-30, 0.25).unwrap();
    let counts: Vec<i32> = (0..8).map(|_| carry.compensate(7, -(1 << 30))).collect();
    assert_eq!(counts.iter().sum::<i32>(), 7 * 8 + 2);
    assert!(counts.iter().all(|count| (7..=8).contains(count)));
}

#[test]
fn counts_saturate_instead_of_wrapping() {
    let mut carry = PulseCarry::new(-30, 1.0).unwrap();
    assert_eq!(carry.compensate(i32::MIN, i32::MAX), i32::MIN);
    assert_eq!(carry.compensate(i32::MAX, i32::MIN), i32::MAX);
}

#[test]
fn impossible_scales_are_refused() {
    for (exponent, sample_s) in [
        (-30, 0.0),
        (-30, -1.0),
        (-30, f32::NAN),
        (-30, f32::INFINITY),
        (1, 1.0),
        (101, 1e-30),
        (-62, 1.0),
        (i32::MIN, 1.0),
    ] {
        assert_eq!(
            PulseCarry::new(exponent, sample_s),
            Err(FixedError::Pulses),
            "{exponent}"
        );
    }
    for exponent in -60..=-2 {
        let mut carry = PulseCarry::new(exponent, 1.0).unwrap();
        let full = carry.pulses(1 << 30);
        let expected = f64::from(30 + exponent).exp2();
        assert!(
            (f64::from(full) - expected).abs() <= 0.5,
            "{full} at {exponent}"
        );
    }
}

#[test]
fn f32_pulses_follow_their_sum_within_half_a_pulse() {
    for kind in 0..6 {
        let mut noise = Noise(kind + 1);
        let mut carry = PulseCarryF32::new();
        let (mut sum, mut out) = (0_i128, 0_i128);
        for i in 0..SAMPLES {
            let correction = match kind {
                0 => 3.1e-7,
                1 => -0.499_999_97,
                2 => noise.between(-1.0, 1.0),
                3 => noise.between(-1e6, 1e6),
                4 => 1e-4 * (i as f32 * 1e-5).sin(),
                _ => noise.between(-1e-9, 2e-9),
            };
            // Exact: all of an f32 from 2^-38 on lies above 2^-62.
            sum += (f64::from(correction) * 2.0_f64.powi(62)) as i128;
            out += i128::from(carry.pulses(correction)) << 62;
            assert!(
                (sum - out).abs() <= (1 << 61) + i128::from(i) + 1,
                "kind {kind}, sample {i}"
            );
        }
    }
}

/// Whatever comes in, the carry stays a number and good samples after it are as before.
#[test]
fn what_is_no_number_leaves_the_f32_carry_as_it_was() {
    let mut carry = PulseCarryF32::default();
    carry.pulses(0.3);
    let before = carry;
    for bad in [f32::NAN, -f32::NAN, 0.0, -0.0, 1e-45] {
        assert_eq!(carry.pulses(bad), 0);
        assert_eq!(carry, before, "{bad}");
    }
    for (large, limit) in [
        (f32::INFINITY, 1 << 30),
        (-3e38, -(1 << 30)),
        (2e9, 1 << 30),
    ] {
        assert_eq!(carry.pulses(large), limit);
        assert_eq!(carry, before, "{large}");
    }
    let mut noise = Noise(7);
    for _ in 0..100_000 {
        carry.pulses(f32::from_bits(noise.bits()));
        let probe = carry.clone().pulses(0.0);
        assert_eq!(probe, 0);
    }
}
