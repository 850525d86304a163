//! Tables, units and streams that the tests of this folder share.

// Each test file uses a part of it.
#![allow(dead_code, unused_imports)]

mod rich;
mod table;

use tempco::{Compensator, Interval, Output, Status, Table, Terms};

pub(crate) use rich::*;
pub(crate) use table::*;

pub(crate) const SECOND: Interval = Interval::new(&THERMAL, 1.0);
/// What the lag-compensated temperature may move in one second by the default settings \[degC\].
pub(crate) const SLEW_C: f32 = 0.5;

/// Cases of a property; a few under Miri, which looks at every access and is slow.
pub(crate) const fn cases(count: u32) -> u32 {
    if cfg!(miri) { 3 } else { count }
}

/// Rounds of a loop; fewer under Miri.
pub(crate) const fn fewer(all: usize, under_miri: usize) -> usize {
    if cfg!(miri) { under_miri } else { all }
}

/// Under Miri the first `under_miri` of them, else all.
pub(crate) fn first<T>(all: &[T], under_miri: usize) -> &[T] {
    &all[..fewer(all.len(), under_miri)]
}

/// How fast a bias can change with either coordinate of its point, read off the table.
pub(crate) struct Lipschitz {
    /// \[unit per degC\]
    pub(crate) per_c: f32,
    /// \[unit per degC/min\]
    pub(crate) per_rate: f32,
}

pub(crate) fn lipschitz(table: &Table<'_, 2>, axis: usize) -> Lipschitz {
    let settings = table.thermal().settings();
    let rate = settings
        .rate_max_c_per_min
        .max(-settings.rate_min_c_per_min);
    let cells = table.cells();
    let cells_per_c = cells.len() as f32 / (table.t_max_c() - table.t_min_c());
    let mut bound = Lipschitz {
        per_c: 0.0,
        per_rate: 0.0,
    };
    for Terms { a, r, .. } in cells.iter().map(|cell| cell[axis]) {
        let per_cell = a[1].abs().max((a[1] + 2.0 * a[2]).abs()) + rate * r[1].abs();
        bound.per_c = bound.per_c.max(per_cell * cells_per_c);
        bound.per_rate = bound.per_rate.max(r[0].abs()).max((r[0] + r[1]).abs());
    }
    bound
}

/// A unit that has been at `temp_c` for so long that there is no flag left.
pub(crate) fn settled(temp_c: f32) -> Compensator<'static, 2> {
    let mut unit = Compensator::new(&TABLE);
    unit.start(temp_c);
    let out = feed(&mut unit, [temp_c; SETTLE_S]);
    assert_eq!(out[SETTLE_S - 2].status, Status::SETTLING);
    assert_eq!(out[SETTLE_S - 1].status, Status::OK);
    unit
}

/// A unit on a steady ramp that is at `temp_c` now and at `temp_c + rate / 60` in a second.
pub(crate) fn on_ramp(temp_c: f32, rate_c_per_min: f32) -> Compensator<'static, 2> {
    // Ten time constants.
    let seconds = 600;
    let temp = |s| temp_c + rate_c_per_min / 60.0 * s as f32;
    let mut unit = Compensator::new(&TABLE);
    unit.start(temp(-seconds));
    let out = feed(&mut unit, (1 - seconds..=0).map(temp));
    let rate = out.last().unwrap().point.rate_c_per_min;
    assert!((rate / rate_c_per_min - 1.0).abs() < 1e-3);
    unit
}

/// Steps the unit once a second.
pub(crate) fn feed(
    unit: &mut Compensator<'static, 2>,
    temps: impl IntoIterator<Item = f32>,
) -> Vec<Output<2>> {
    let step = |temp| unit.step(&SECOND, temp, [1.0, -2.0]);
    temps.into_iter().map(step).collect()
}

/// What is applied without any temperature: the bias at the reference temperature.
pub(crate) fn constant_bias() -> [f32; 2] {
    feed(&mut Compensator::new(&TABLE), [f32::NAN])[0].bias
}

/// All the numbers of an output, so that NaN equals itself and 0 differs from -0.
pub(crate) fn bits(out: &Output<2>) -> [u32; 9] {
    let [c0, c1] = out.compensated;
    let [b0, b1] = out.bias;
    let point = out.point;
    let [p0, p1] = point.plays_c;
    let (u, rate, lag2) = (point.effective_c, point.rate_c_per_min, point.lag2_c);
    [c0, c1, b0, b1, u, rate, lag2, p0, p1].map(f32::to_bits)
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
