//! The table and streams that the tests of this folder share.

// Each test file uses a part of it.
#![allow(dead_code)]

#[path = "../../../tempco/tests/common/table.rs"]
mod table;

pub(crate) use table::*;
use tempco::{Status, Table};
use tempco_fixed::{FixedCompensator, FixedInterval, FixedOutput, FixedTable, from_f32};

/// What the effective temperature may move in one second by the default settings.
pub(crate) const SLEW: i32 = 1 << 19;
pub(crate) const RAW: [i32; 2] = [1 << 20, -(2 << 20)];

pub(crate) static TABLE: FixedTable<2, COUNT> = fixed(&F32_TABLE);
pub(crate) static SECOND: FixedInterval = FixedInterval::new(TABLE.thermal(), 1.0);

pub(crate) const fn fixed(table: &Table<'_, 2>) -> FixedTable<2, COUNT> {
    match FixedTable::new(table) {
        Ok(table) => table,
        Err(error) => panic!("{}", error.message()),
    }
}

pub(crate) type Unit = FixedCompensator<'static, 2, COUNT>;

/// Steps the unit once a second, with temperatures in degC; NaN is no temperature.
pub(crate) fn feed(unit: &mut Unit, temps: impl IntoIterator<Item = f32>) -> Vec<FixedOutput<2>> {
    let step = |temp| unit.step(&SECOND, from_f32(temp), RAW);
    temps.into_iter().map(step).collect()
}

pub(crate) fn started(temp_c: f32) -> Unit {
    let mut unit = FixedCompensator::new(&TABLE);
    unit.start(from_f32(temp_c));
    unit
}

/// A unit that has been at `temp_c` for so long that there is nothing left to remark.
pub(crate) fn settled(temp_c: f32) -> Unit {
    let mut unit = started(temp_c);
    let out = feed(&mut unit, [temp_c; SETTLE_S]);
    assert_eq!(out[SETTLE_S - 2].status, Status::SETTLING);
    assert_eq!(out[SETTLE_S - 1].status, Status::OK);
    unit
}

/// A unit on a steady ramp that is at `temp_c` now and at `temp_c + rate / 60` in a second.
pub(crate) fn on_ramp(temp_c: f32, rate_c_per_min: f32) -> Unit {
    let seconds = 600;
    let temp = |s| temp_c + rate_c_per_min / 60.0 * s as f32;
    let mut unit = started(temp(-seconds));
    let out = feed(&mut unit, (1 - seconds..=0).map(temp));
    assert!((rate(out.last().unwrap()) / rate_c_per_min - 1.0).abs() < 1e-3);
    unit
}

/// The rate of an output \[degC/min\].
pub(crate) fn rate(out: &FixedOutput<2>) -> f32 {
    tempco_fixed::to_f32(out.point.rate)
}

/// What is applied without any temperature: the bias at the reference temperature.
pub(crate) fn constant_bias() -> [i32; 2] {
    feed(&mut FixedCompensator::new(&TABLE), [f32::NAN])[0].bias
}

/// Numbers without a pattern, the same on every run (xorshift64*).
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn bits(&mut self) -> u32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32) as u32
    }

    /// Evenly from `low` to `high`.
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.bits() as f32 / u32::MAX as f32)
    }
}
