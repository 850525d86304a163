//! What the images of the integer core share with the host: the table, a stream of samples that
//! leaves no path out, and a digest of all that comes of it.

use tempco::Table;
use tempco_fixed::{
    FixedCompensator, FixedInterval, FixedOutput, FixedTable, FixedTwoRate, INVALID, PulseCarry,
};

/// Converts a checked table; in a constant, a table that does not fit stops the build.
///
/// # Panics
/// The table does not fit the integer formats.
pub const fn converted<const A: usize, const C: usize>(table: &Table<'_, A>) -> FixedTable<A, C> {
    match FixedTable::new(table) {
        Ok(table) => table,
        Err(error) => panic!("{}", error.message()),
    }
}

/// Numbers without a pattern, the same everywhere (xorshift).
#[derive(Clone, Debug)]
struct Noise(u32);

impl Noise {
    fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// Evenly within `2^bits` either way.
    fn even(&mut self, bits: u32) -> i32 {
        self.bits() as i32 >> (31 - bits)
    }
}

/// What one sample brings.
#[derive(Clone, Copy, Debug)]
pub struct FixedSample<const A: usize> {
    /// Time since the sample before \[us\].
    pub dt_us: i64,
    /// Temperature \[2^-20 degC\].
    pub temp: i32,
    /// Gyro samples.
    pub raw: [i32; A],
}

/// A walk over the sensor's range in stretches of calm, ramps, noise and faults: one temperature,
/// interval or gyro sample in eight is none at all, or any number.
pub fn samples<const A: usize>(count: u32) -> impl Iterator<Item = FixedSample<A>> {
    let mut noise = Noise(0x7465_6d70);
    let (mut temp, mut speed) = (25 << 20, 0);
    (0..count).map(move |number| {
        if number % 512 == 0 {
            // At most 0.25 degC a sample, 15 degC/min at a second.
            speed = noise.even(18);
        }
        temp += speed;
        if !((-60 << 20)..(150 << 20)).contains(&temp) {
            speed = -speed;
            temp += 2 * speed;
        }
        // Every other stretch is calm, so that the status returns to nothing to remark.
        let wild = number / 2048 % 2 == 1;
        let mut spoil = |good: i32| match noise.bits() % 16 {
            0 if wild => noise.bits() as i32,
            1 if wild => INVALID,
            _ => good,
        };
        let reading = spoil(temp);
        let dt_us = match spoil(0) {
            0 => 1_000_000,
            // A minute either way at most.
            any => i64::from(any >> 5),
        };
        let raw = core::array::from_fn(|_| spoil(0));
        FixedSample {
            dt_us,
            temp: reading.wrapping_add(if wild { noise.even(16) } else { 0 }),
            raw,
        }
    })
}

/// A digest (FNV-1a of words) of everything the integer core puts out over a stream: single-call
/// and two-rate, pulses and counters.
pub fn digest<const A: usize, const C: usize>(table: &FixedTable<A, C>, count: u32) -> u32 {
    let mut digest = Digest(0x811c_9dc5);
    let mut single = FixedCompensator::new(table);
    let mut two_rate = FixedTwoRate::new(table, 3);
    // A multiplier for the finest exponent of any table.
    let mut carry = PulseCarry::new(-30, 0.37);
    for sample in samples(count) {
        let interval = FixedInterval::from_micros(table.thermal(), sample.dt_us);
        let out = single.step(&interval, sample.temp, sample.raw);
        digest.output(&out);
        two_rate.update(&interval, sample.temp);
        for _ in 0..sample.raw.first().map_or(0, |raw| *raw as u32 % 5) {
            digest.output(&two_rate.compensate(sample.raw));
        }
        if let Ok(carry) = &mut carry {
            digest.word(carry.pulses(out.bias[0]) as u32);
        }
    }
    let state = single.thermal_state();
    digest.word(state.rejected());
    digest.word(state.restarts());
    digest.0
}

struct Digest(u32);

impl Digest {
    fn word(&mut self, word: u32) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0100_0193).rotate_left(7);
    }

    fn output<const A: usize>(&mut self, out: &FixedOutput<A>) {
        for value in out.compensated.iter().chain(&out.bias) {
            self.word(*value as u32);
        }
        self.word(out.point.effective as u32);
        self.word(out.point.rate as u32);
        self.word(out.status.bits().into());
    }
}
