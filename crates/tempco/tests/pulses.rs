//! No pulse is lost: the sums of whole pulses against the sums of what they stand for.

mod common;

use common::{Noise, fewer};
use tempco::{BiasRamp, PulseCorrector, PulseRamp, Ramp, RampBuffer, Status};

/// What stands for one pulse.
const PULSE: i64 = 1 << 26;

fn level(bias: f32) -> PulseRamp<1> {
    let ramp = BiasRamp {
        end: [bias],
        slope: [0.0],
        samples: 0,
        status: Status::OK,
    };
    PulseRamp::new(&ramp, [1.0])
}

/// A bias of a quarter pulse makes every fourth sample a pulse, not a burst.
#[test]
fn pulses_come_evenly() {
    for (bias, expected) in [
        (0.25, [7, 6, 7, 7, 7, 6, 7, 7]),
        (-0.25, [7, 7, 8, 7, 7, 7, 8, 7]),
        (3.5, [3, 4, 3, 4, 3, 4, 3, 4]),
    ] {
        let ramps = RampBuffer::new();
        ramps.publish(&level(bias));
        let mut corrector = PulseCorrector::new(&ramps);
        let out: [i32; 8] = std::array::from_fn(|_| corrector.correct([7])[0]);
        assert_eq!(out, expected, "{bias}");
    }
}

/// A million samples of any kind, over ramps of any kind: early, on time, late.
#[test]
fn pulses_follow_their_sum_within_half_a_pulse() {
    for kind in 0..6_u32 {
        let mut noise = Noise(u64::from(kind) + 1);
        let ramps = RampBuffer::new();
        let mut corrector = PulseCorrector::new(&ramps);
        let mut sum = 0_i64;
        let (mut until_next, mut to_end) = (0, 0);
        let mut ramp = level(0.0);
        for sample in 0..fewer(1_000_000, 1000) {
            if until_next == 0 {
                let mut bias = || match kind {
                    0 => 3.1e-7,
                    1 => -0.499_999_97,
                    2 => noise.between(-1.0, 1.0),
                    3 => noise.between(-40.0, 40.0),
                    4 => 1e-4 * (sample as f32 * 1e-5).sin(),
                    _ => f32::from_bits(noise.bits()),
                };
                let (end, slope) = ([bias()], [0.01 * bias()]);
                let samples = (noise.bits() % 100) as u16;
                let status = Status::OK;
                let of_bias = BiasRamp {
                    end,
                    slope,
                    samples,
                    status,
                };
                ramp = PulseRamp::new(&of_bias, [1.0]);
                ramps.publish(&ramp);
                to_end = i64::from(samples);
                until_next = 1 + to_end * i64::from(noise.bits() % 3);
            }
            until_next -= 1;
            to_end = (to_end - 1).max(0);
            let bias = i64::from(ramp.end[0]) - i64::from(ramp.slope[0]) * to_end;
            assert!(bias.abs() <= 15 * PULSE, "{bias}");
            let raw = if kind == 5 {
                noise.bits().cast_signed()
            } else {
                (noise.bits() % 1000) as i32 - 500
            };
            let [out] = corrector.correct([raw]);
            // Of the sum only what goes beyond whole turns of 32 bits counts.
            sum += i64::from(raw.wrapping_sub(out)) * PULSE - bias;
            assert!(
                sum.abs() <= PULSE / 2,
                "kind {kind}, sample {sample}: {sum}"
            );
        }
    }
}

/// The fixed point stands for the ramp of biases, to its resolution.
#[test]
fn a_ramp_of_pulses_is_the_ramp_of_biases() {
    let mut noise = Noise(3);
    for _ in 0..fewer(100_000, 100) {
        let samples = 1 + (noise.bits() % 65_535) as u16;
        let (end, start) = (noise.between(-15.0, 15.0), noise.between(-15.0, 15.0));
        let slope = (end - start) / f32::from(samples);
        let per_unit = noise.between(-1.0, 1.0);
        let (end, slope, status) = ([end], [slope], Status::SETTLING);
        let ramp = BiasRamp {
            end,
            slope,
            samples,
            status,
        };
        let pulses = PulseRamp::new(&ramp, [per_unit]);
        assert_eq!((pulses.samples, pulses.status), (samples, status));
        for left in [0, samples / 2, samples] {
            let expected = (end[0] - slope[0] * f32::from(left)) * per_unit;
            let found = i64::from(pulses.end[0]) - i64::from(pulses.slope[0]) * i64::from(left);
            let error = (found as f64 / PULSE as f64 - f64::from(expected)).abs();
            let allowed = f64::from(left) / PULSE as f64 + 2e-5 + 1.0 / PULSE as f64;
            assert!(error <= allowed, "{error} at {left} of {samples}");
        }
    }
}

/// Whatever comes in, a ramp stays within what fits, from its beginning to its end.
#[test]
fn what_is_no_bias_becomes_none_and_what_is_too_large_the_largest() {
    let of = |end, slope| {
        let ramp = BiasRamp {
            end: [end],
            slope: [slope],
            samples: 100,
            status: Status::OK,
        };
        let Ramp { end, slope, .. } = PulseRamp::new(&ramp, [1.0]);
        (i64::from(end[0]), i64::from(slope[0]))
    };
    assert_eq!(of(f32::NAN, 1.0), (0, 0));
    assert_eq!(of(1.0, f32::NAN), (PULSE, PULSE / 100));
    assert_eq!(of(1e30, 0.0), (15 * PULSE, 0));
    assert_eq!(of(f32::NEG_INFINITY, 0.0), (-15 * PULSE, 0));
    assert_eq!(of(15.0, 1e30), (15 * PULSE, 30 * PULSE / 100));
    let mut noise = Noise(9);
    for _ in 0..fewer(100_000, 100) {
        let (end, slope) = of(f32::from_bits(noise.bits()), f32::from_bits(noise.bits()));
        for left in [0, 50, 100] {
            assert!((end - left * slope).abs() <= 15 * PULSE);
        }
    }
}

/// As of the corrector in f32.
#[test]
fn late_and_early_ramps_are_flagged() {
    let mut ramp = level(0.5);
    ramp.samples = 100;
    let ramps = RampBuffer::new();
    let mut corrector = PulseCorrector::new(&ramps);
    let mut flagged = |ramps: &RampBuffer<1, i32>, publish, count| {
        if publish {
            ramps.publish(&ramp);
        }
        let mut take = || {
            corrector.correct([0]);
            corrector.status().contains(Status::INTERVAL_INVALID)
        };
        (0..count).filter(|_| take()).count()
    };
    assert_eq!(flagged(&ramps, true, 200), 0);
    let late = fewer(300_000, 300);
    assert_eq!(flagged(&ramps, false, late), late);
    assert_eq!(flagged(&ramps, true, 49), 0);
    assert_eq!(flagged(&ramps, true, 100), 100, "early");
    assert_eq!(flagged(&ramps, true, 50), 0);
    assert_eq!(flagged(&ramps, true, 50), 0);
}
