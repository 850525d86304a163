//! The table of the tests, and the settings behind it.

use tempco::{Table, Terms, Thermal, ThermalSettings};

/// The default settings: 60 s of hold and time constant, 10 s to heal, 0.5 degC/s of slew.
pub(crate) const THERMAL: Thermal = thermal(ThermalSettings::DEFAULT);
pub(crate) const SETTINGS: ThermalSettings = ThermalSettings::DEFAULT;
/// Three time constants, after which a restart counts as settled.
pub(crate) const SETTLE_S: usize = 180;
pub(crate) const HEAL_S: usize = 10;
pub(crate) const HOLD_S: usize = 60;
pub(crate) const T_MIN: f32 = -40.0;
pub(crate) const T_MAX: f32 = 80.0;
pub(crate) const COUNT: usize = 12;
/// Bias at the edges of the cells: kinked, curved within, never twice the same, so that a wrong
/// cell, place or order of coefficients cannot pass.
const EDGES: [f32; COUNT + 1] = [
    0.31, 0.27, 0.18, 0.22, 0.40, 0.37, 0.41, 0.55, 0.52, 0.66, 0.71, 0.93, 0.87,
];
pub(crate) static CELLS: [[Terms; 2]; COUNT] = cells();
/// Two axes, 12 cells over -40..80 degC, continuous in temperature at every rate.
pub(crate) static TABLE: Table<'static, 2> = table(THERMAL);

pub(crate) const fn thermal(settings: ThermalSettings) -> Thermal {
    match Thermal::new(settings) {
        Ok(thermal) => thermal,
        Err(error) => panic!("{}", error.message()),
    }
}

pub(crate) const fn table(thermal: Thermal) -> Table<'static, 2> {
    match Table::new(thermal, T_MIN, T_MAX, &CELLS) {
        Ok(table) => table,
        Err(error) => panic!("{}", error.message()),
    }
}

pub(super) const fn cells() -> [[Terms; 2]; COUNT] {
    let none = Terms::new([], []);
    let mut cells = [[none; 2]; COUNT];
    let mut k = 0;
    while k < COUNT {
        let (cold, hot) = (EDGES[k], EDGES[k + 1]);
        let curve = 0.02 + 0.01 * k as f32;
        cells[k][0] = Terms::new(
            [cold, hot - cold - curve, curve],
            [0.1 * cold, 0.1 * (hot - cold)],
        );
        cells[k][1] = Terms::new(
            [-3.0 * cold, 3.0 * (cold - hot) + curve, -curve],
            [0.2 - cold, cold - hot],
        );
        k += 1;
    }
    cells
}
