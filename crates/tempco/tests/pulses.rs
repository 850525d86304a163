//! No pulse is lost: the sums of whole pulses against the sums of what they stand for.

mod common;

use common::{Noise, fewer};
use tempco::PulseCarry;

/// A correction of a quarter pulse makes every fourth sample a pulse, not a burst.
#[test]
fn pulses_come_evenly() {
    let mut carry = PulseCarry::new();
    let pulses: Vec<i32> = (0..12).map(|_| carry.pulses(0.25)).collect();
    assert_eq!(pulses, [0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0]);
    let mut carry = PulseCarry::new();
    let counts: Vec<i32> = (0..8).map(|_| 7 - carry.pulses(-0.25)).collect();
    assert_eq!(counts.iter().sum::<i32>(), 7 * 8 + 2);
    assert!(counts.iter().all(|count| (7..=8).contains(count)));
}

#[test]
fn pulses_follow_their_sum_within_half_a_pulse() {
    for kind in 0..6 {
        let mut noise = Noise(kind + 1);
        let mut carry = PulseCarry::new();
        let (mut sum, mut out) = (0_i128, 0_i128);
        for i in 0..fewer(1_000_000, 1000) as u32 {
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
fn what_is_no_number_leaves_the_carry_as_it_was() {
    let mut carry = PulseCarry::default();
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
    for _ in 0..fewer(100_000, 1000) {
        carry.pulses(f32::from_bits(noise.bits()));
        let probe = carry.clone().pulses(0.0);
        assert_eq!(probe, 0);
    }
}
