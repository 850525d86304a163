//! The table and streams that the tests of this folder share.

// Each test file uses a part of it.
#![allow(dead_code)]

use tempco::{Status, Table, Terms, Thermal, ThermalSettings};
use tempco_fixed::{FixedCompensator, FixedInterval, FixedOutput, FixedTable, from_f32};

pub(crate) const SETTINGS: ThermalSettings = ThermalSettings::DEFAULT;
pub(crate) const THERMAL: Thermal = thermal(SETTINGS);
/// What the default settings say: three time constants, time to heal and to hold \[s\].
pub(crate) const SETTLE_S: usize = 180;
pub(crate) const HEAL_S: usize = 10;
pub(crate) const HOLD_S: usize = 60;
/// What the effective temperature may move in one second by the default settings.
pub(crate) const SLEW: i32 = 1 << 19;
pub(crate) const RAW: [i32; 2] = [1 << 20, -(2 << 20)];

pub(crate) const COUNT: usize = 12;
/// Bias at the edges of the cells: kinked, never twice the same.
const EDGES: [f32; COUNT + 1] = [
    0.31, 0.27, 0.18, 0.22, 0.40, 0.37, 0.41, 0.55, 0.52, 0.66, 0.71, 0.93, 0.87,
];
static CELLS: [[Terms; 2]; COUNT] = cells();
/// Two axes, 12 cells over -40..80 degC, continuous in temperature at every rate.
pub(crate) static F32_TABLE: Table<'static, 2> = table(THERMAL);
pub(crate) static TABLE: FixedTable<2, COUNT> = fixed(&F32_TABLE);
pub(crate) static SECOND: FixedInterval = FixedInterval::new(TABLE.thermal(), 1.0);

pub(crate) const fn thermal(settings: ThermalSettings) -> Thermal {
    match Thermal::new(settings) {
        Ok(thermal) => thermal,
        Err(error) => panic!("{}", error.message()),
    }
}

pub(crate) const fn table(thermal: Thermal) -> Table<'static, 2> {
    match Table::new(thermal, -40.0, 80.0, &CELLS) {
        Ok(table) => table,
        Err(error) => panic!("{}", error.message()),
    }
}

pub(crate) const fn fixed(table: &Table<'_, 2>) -> FixedTable<2, COUNT> {
    match FixedTable::new(table) {
        Ok(table) => table,
        Err(error) => panic!("{}", error.message()),
    }
}

const fn cells() -> [[Terms; 2]; COUNT] {
    let none = Terms {
        a: [0.0; 3],
        r: [0.0; 2],
    };
    let mut cells = [[none; 2]; COUNT];
    let mut k = 0;
    while k < COUNT {
        let (cold, hot) = (EDGES[k], EDGES[k + 1]);
        let curve = 0.02 + 0.01 * k as f32;
        cells[k][0] = Terms {
            a: [cold, hot - cold - curve, curve],
            r: [0.1 * cold, 0.1 * (hot - cold)],
        };
        cells[k][1] = Terms {
            a: [-3.0 * cold, 3.0 * (cold - hot) + curve, -curve],
            r: [0.2 - cold, cold - hot],
        };
        k += 1;
    }
    cells
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
