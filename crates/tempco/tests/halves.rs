//! The thermal half and the sample half: the bias between two updates of the temperature.

mod common;

use common::*;
use proptest::prelude::*;
use tempco::{BiasRamp, Compensator, Corrector, Interval, RampBuffer, Status, ThermalHalf};

/// Gyro samples per update; fewer under Miri, which is slow.
const SAMPLES: u16 = if cfg!(miri) { 10 } else { 100 };
const RAW: [f32; 2] = [1.0, -2.0];
const LATE_OR_EARLY: Status = Status::INTERVAL_INVALID;

/// Both halves, as a main loop and an interrupt have them.
struct Unit {
    thermal: ThermalHalf<'static, 2>,
    ramps: RampBuffer<2>,
}

/// What a sample got.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Corrected {
    bias: [f32; 2],
    status: Status,
}

impl Corrected {
    fn bits(&self) -> [u32; 2] {
        self.bias.map(f32::to_bits)
    }

    fn is_flagged(&self) -> bool {
        self.status.contains(LATE_OR_EARLY)
    }
}

impl Unit {
    fn new(samples_per_update: u16) -> Self {
        Self {
            thermal: ThermalHalf::new(&TABLE, samples_per_update),
            ramps: RampBuffer::new(),
        }
    }

    fn started(samples_per_update: u16, temp_c: f32) -> Self {
        let mut unit = Self::new(samples_per_update);
        let ramp = unit.thermal.start(temp_c);
        unit.ramps.publish(&ramp);
        unit
    }

    fn update(&mut self, interval: &Interval, temp_c: f32) -> BiasRamp<2> {
        let ramp = self.thermal.update(interval, temp_c);
        self.ramps.publish(&ramp);
        ramp
    }

    fn take(&self, count: usize) -> Vec<Corrected> {
        (0..count).map(|_| self.sample()).collect()
    }

    fn sample(&self) -> Corrected {
        let (bias, status) = Corrector::new(&self.ramps).advance::<1>();
        Corrected { bias, status }
    }
}

/// A place where the table is steep, far from its reference, on a strong ramp.
fn temp(second: i32) -> f32 {
    52.0 + 0.4 * second as f32
}

#[test]
fn the_bias_ramps_linearly_to_that_of_the_single_rate() {
    let mut single = Compensator::new(&TABLE);
    let mut unit = Unit::started(SAMPLES, temp(0));
    single.start(temp(0));
    let mut before = unit.take(SAMPLES.into())[0].bias;
    for second in 1..fewer(60, 10) as i32 {
        unit.update(&SECOND, temp(second));
        let end = single.step(&SECOND, temp(second), RAW);
        assert_eq!(unit.thermal.point(), end.point);
        for (sample, out) in (1..).zip(unit.take(SAMPLES.into())) {
            let part = sample as f32 / f32::from(SAMPLES);
            for (bias, (before, end)) in out.bias.iter().zip(before.iter().zip(&end.bias)) {
                let line = before + part * (end - before);
                assert!((bias - line).abs() < 2e-6, "{second}.{sample}");
            }
            assert_eq!(out.status, end.status);
            assert!(sample < SAMPLES || out.bits() == end.bias.map(f32::to_bits));
        }
        before = end.bias;
    }
}

/// To the bit, what a ramp is documented to be; and the subtraction.
#[test]
fn each_sample_has_the_bias_of_its_place_on_the_ramp() {
    let mut unit = Unit::started(SAMPLES, temp(0));
    unit.take(SAMPLES.into());
    let ramp = unit.update(&SECOND, temp(3));
    for n in 1..=2 * i32::from(SAMPLES) {
        let left = (i32::from(SAMPLES) - n).max(0) as f32;
        let expected: [f32; 2] =
            std::array::from_fn(|axis| RAW[axis] - (ramp.end[axis] - ramp.slope[axis] * left));
        let found = Corrector::new(&unit.ramps).correct(RAW);
        assert_eq!(found.map(f32::to_bits), expected.map(f32::to_bits), "{n}");
    }
}

#[test]
fn at_one_sample_per_update_it_is_the_single_rate() {
    for samples_per_update in [0, 1] {
        let mut single = Compensator::new(&TABLE);
        let mut unit = Unit::started(samples_per_update, 0.0);
        unit.sample();
        single.start(0.0);
        for second in 1..fewer(500, 50) as i32 {
            let temp = [temp(second % 90), f32::NAN][usize::from(second % 7 == 0)];
            unit.update(&SECOND, temp);
            let (out, end) = (unit.sample(), single.step(&SECOND, temp, RAW));
            assert_eq!(out.bits(), end.bias.map(f32::to_bits));
            assert_eq!(out.status, end.status);
        }
        assert_eq!(unit.thermal.thermal_state(), single.thermal_state());
    }
}

#[test]
fn where_the_update_is_late_the_bias_stays() {
    let mut unit = Unit::started(SAMPLES, temp(0));
    unit.take(SAMPLES.into());
    unit.update(&SECOND, temp(1));
    let end = *unit.take(SAMPLES.into()).last().unwrap();
    for out in unit.take(fewer(1_000_000, 100)) {
        assert_eq!(out.bits(), end.bits());
    }
    unit.update(&SECOND, temp(2));
    let next = unit.sample();
    assert!((next.bias[0] - end.bias[0]).abs() < 0.1 / f32::from(SAMPLES));
}

/// A thermal half that died must not go unseen, nor be forgotten.
#[test]
fn an_update_that_is_overdue_by_a_period_is_flagged() {
    for samples in [1, SAMPLES] {
        let period = usize::from(samples);
        let mut unit = Unit::started(samples, 30.0);
        unit.take(period);
        unit.update(&SECOND, 30.0);
        assert!(!unit.take(2 * period).iter().any(Corrected::is_flagged));
        let outs = unit.take(fewer(300_000, 500));
        assert!(outs.iter().all(Corrected::is_flagged));
        assert!(Corrector::new(&unit.ramps).status().contains(LATE_OR_EARLY));
        unit.update(&SECOND, 30.0);
        assert!(!unit.take(2 * period).iter().any(Corrected::is_flagged));
        assert_eq!(unit.thermal.thermal_state().rejected(), 0);
    }
}

/// At every place of the period; up to half of it is no matter.
#[test]
fn an_update_that_is_early_by_more_than_half_a_period_is_flagged() {
    let period = usize::from(SAMPLES);
    for taken in 0..=period {
        let mut unit = Unit::started(SAMPLES, temp(0));
        unit.take(period);
        unit.update(&SECOND, temp(1));
        let before = unit.take(taken).last().copied();
        let ramp = unit.update(&SECOND, temp(2));
        let is_early = taken < period / 2;
        let outs = unit.take(period);
        assert!(
            outs.iter().all(|out| out.is_flagged() == is_early),
            "{taken}"
        );
        // The step at its beginning is what was left of the former ramp.
        if let Some(before) = before {
            let step = (outs[0].bias[0] - before.bias[0]).abs();
            let left = (period - taken + 1) as f32;
            assert!(
                step < 1.1 * left * ramp.slope[0].abs() + 1e-6,
                "{step} at {taken}"
            );
        }
        // The next one in time takes the flag back.
        unit.update(&SECOND, temp(3));
        assert!(!unit.take(period).iter().any(Corrected::is_flagged));
    }
}

#[test]
fn a_ramp_that_no_sample_took_over_is_missed() {
    let period = usize::from(SAMPLES);
    let mut unit = Unit::started(SAMPLES, temp(0));
    unit.take(period);
    unit.update(&SECOND, temp(1));
    let ramp = unit.update(&SECOND, temp(2));
    let outs = unit.take(period);
    assert!(outs.iter().all(Corrected::is_flagged));
    assert_eq!(outs[period - 1].bias, ramp.end);
    unit.update(&SECOND, temp(3));
    assert!(!unit.take(period).iter().any(Corrected::is_flagged));
}

/// What comes before the first scheduled update may be replaced at any time.
#[test]
fn before_any_temperature_the_constant_bias_is_applied() {
    let mut unit = Unit::new(SAMPLES);
    unit.ramps.publish(&ThermalHalf::constant(&TABLE));
    for out in unit.take(300) {
        assert_eq!(out.bias, constant_bias());
        assert_eq!(out.status, Status::TEMPERATURE_LOST);
    }
    unit.ramps.publish(&ThermalHalf::constant(&TABLE));
    let ramp = unit.thermal.start(-20.0);
    unit.ramps.publish(&ramp);
    for out in unit.take(2 * usize::from(SAMPLES)) {
        assert_eq!((out.bias, out.status), (ramp.end, Status::SETTLING));
    }
    // A new start, in the middle of a ramp.
    unit.update(&SECOND, -20.0);
    unit.take(1);
    unit.ramps.publish(&ThermalHalf::constant(&TABLE));
    assert_eq!(unit.sample().status, Status::TEMPERATURE_LOST);
}

#[test]
fn without_a_ramp_nothing_is_taken_out() {
    let ramps = RampBuffer::<2>::default();
    let mut corrector = Corrector::new(&ramps);
    for _ in 0..10 {
        assert_eq!(corrector.correct(RAW), RAW);
        assert_eq!(corrector.status(), Status::TEMPERATURE_LOST);
    }
}

#[test]
fn the_longest_ramp_is_as_straight_and_as_exact_as_a_short_one() {
    let samples = if cfg!(miri) { 301 } else { u16::MAX };
    let count = usize::from(samples);
    let mut unit = Unit::started(samples, 30.0);
    let start = unit.take(count)[0].bias;
    let end = unit.update(&SECOND, 30.5).end;
    let outs = unit.take(count);
    for axis in 0..2 {
        let part = (end[axis] - start[axis]).abs() / count as f32;
        // The middle sample of an odd number lies half a part late.
        for (sample, expected) in [
            (0, start[axis]),
            (count / 2, 0.5 * (start[axis] + end[axis])),
            (count - 2, end[axis]),
        ] {
            let bias = outs[sample].bias[axis];
            let error = (bias - expected).abs();
            assert!(error < part + 1e-6, "{bias} for {expected} at {sample}");
        }
    }
    assert_eq!(outs[count - 1].bias, end);
    assert!(!unit.take(count).iter().any(Corrected::is_flagged));
    assert!(unit.sample().is_flagged());
}

/// Two units alike, of which one takes blocks: over ramps, their ends, and late ones.
fn compare_blocks<const N: usize>() {
    let mut single = Unit::started(SAMPLES, temp(0));
    let mut blocks = Unit::started(SAMPLES, temp(0));
    let mut slices = Unit::started(SAMPLES, temp(0));
    // A whole number of blocks as near to the period as there is.
    let count = usize::from(SAMPLES).div_ceil(N);
    let mut second = 0;
    for late in [0, 0, 1, 0, 5] {
        second += 1;
        let ramp = single.update(&SECOND, temp(second));
        blocks.update(&SECOND, temp(second));
        slices.update(&SECOND, temp(second));
        for number in 0..count + late {
            let ones = single.take(N);
            let mut block = [RAW; N];
            Corrector::new(&blocks.ramps).correct_block(&mut block);
            let first = block[0];
            assert_eq!(block, [first; N]);
            let mut slice = vec![RAW; N];
            let mut corrector = Corrector::new(&slices.ramps);
            corrector.correct_slice(&mut slice);
            assert_eq!(slice, block, "{N}: {number}");
            corrector.correct_slice(&mut []);
            assert_eq!(corrector.status(), Corrector::new(&blocks.ramps).status());
            for axis in 0..2 {
                let bias = RAW[axis] - first[axis];
                let half = 0.5 * (N - 1) as f32 * ramp.slope[axis].abs() + 1e-6;
                let sum: f64 = ones.iter().map(|one| f64::from(one.bias[axis])).sum();
                let mean = (sum / N as f64) as f32;
                for one in &ones {
                    assert!((bias - one.bias[axis]).abs() <= half, "{N}: {number}");
                }
                let within = (number + 1) * N <= SAMPLES.into() || number * N >= SAMPLES.into();
                assert!(
                    (bias - mean).abs() < 1e-6 || !within,
                    "{N}: {bias}, mean {mean}"
                );
            }
            let status = Corrector::new(&blocks.ramps).status();
            assert_eq!(status, ones[N - 1].status);
        }
    }
}

#[test]
fn a_block_gets_the_mean_of_the_biases_of_its_samples() {
    compare_blocks::<2>();
    compare_blocks::<5>();
    compare_blocks::<8>();
    compare_blocks::<32>();
}

/// A slice that is longer than any ramp counts as 65535 samples.
#[test]
fn a_slice_that_is_too_long_ends_the_ramp() {
    let (mut slice, mut block) = (vec![RAW; 70_000], vec![RAW; 65_535]);
    for (samples, left) in [(&mut slice, 70_000), (&mut block, 65_535)] {
        let unit = Unit::started(SAMPLES, temp(0));
        let mut corrector = Corrector::new(&unit.ramps);
        corrector.correct_slice(samples);
        assert_eq!(samples.len(), left);
        assert_eq!(corrector.status(), Status::SETTLING | LATE_OR_EARLY);
    }
    assert_eq!(slice[69_999], block[0]);
}

#[test]
fn an_invalid_gyro_sample_marks_only_itself() {
    let mut unit = Unit::started(SAMPLES, temp(0));
    unit.update(&SECOND, temp(1));
    let mut corrector = Corrector::new(&unit.ramps);
    let [bad, five] = corrector.correct([f32::NAN, 5.0]);
    assert!(bad.is_nan() && five.is_finite());
    assert!(corrector.correct(RAW).iter().all(|value| value.is_finite()));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(300), failure_persistence: None, ..Default::default() })]

    /// On schedule or late, good or bad temperatures: between two samples the bias moves by one
    /// part of what it has to move in the whole period. An update that is early adds what was left.
    #[test]
    fn no_step_is_larger_than_the_change_over_the_samples(
        samples_per_update in prop_oneof![1_u16..50, Just(0), Just(u16::MAX)],
        updates in prop::collection::vec((0_usize..120, -70.0_f32..160.0, 0.0_f32..40.0), 1..30),
    ) {
        let mut unit = Unit::started(samples_per_update, 20.0);
        let mut before = unit.sample().bias;
        let mut goal = before;
        for (samples, temp, dt_s) in updates {
            let end = unit.update(&Interval::new(&THERMAL, dt_s), temp).end;
            let period = f32::from(samples_per_update.max(1));
            let mut left: [f32; 2] = std::array::from_fn(|axis| (goal[axis] - before[axis]).abs());
            for (sample, out) in (1..).zip(unit.take(samples)) {
                for axis in 0..2 {
                    let change = (end[axis] - goal[axis]).abs();
                    let scale = end[axis].abs().max(goal[axis].abs());
                    let allowed = change / period + left[axis] + 6.0 * scale * f32::EPSILON;
                    let step = (out.bias[axis] - before[axis]).abs();
                    prop_assert!(step <= allowed, "{} of {}", step, allowed);
                    prop_assert!((sample as f32) < period || out.bias[axis] == end[axis]);
                }
                left = [0.0; 2];
                before = out.bias;
            }
            goal = end;
        }
    }
}
