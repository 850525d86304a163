//! A table with all there is: second lag, plays, and both in both mixes.

use tempco::{Interval, PLAYS, Table, Terms, Thermal, ThermalSettings};

use super::table::{COUNT, SETTINGS, T_MAX, T_MIN, cells, thermal};

pub(crate) const RICH: ThermalSettings = ThermalSettings {
    kappa: 0.5,
    tau2_s: 900.0,
    kappa2: 0.25,
    lag2_min_c: -20.0,
    lag2_max_c: 25.0,
    half_width1_c: 5.0,
    half_width2_c: 2.0,
    play_kappa: 0.75,
    play_kappa2: -0.5,
    ..SETTINGS
};
pub(crate) const HALF_WIDTHS: [f32; PLAYS] = [RICH.half_width1_c, RICH.half_width2_c];
pub(crate) const GAINS: [[f32; 2]; PLAYS] = [[0.01, -0.02], [0.004, 0.003]];
pub(crate) const RICH_THERMAL: Thermal = thermal(RICH);
pub(crate) const RICH_SECOND: Interval = Interval::new(&RICH_THERMAL, 1.0);
static RICH_CELLS: [[Terms; 2]; COUNT] = rich_cells();
/// The cells of [`TABLE`](super::table::TABLE) with terms of the second lag.
pub(crate) static RICH_TABLE: Table<'static, 2> = rich_table(RICH_THERMAL);

pub(crate) const fn rich_table(thermal: Thermal) -> Table<'static, 2> {
    let Ok(table) = Table::new(thermal, T_MIN, T_MAX, &RICH_CELLS) else {
        panic!();
    };
    match table.with_plays(GAINS) {
        Ok(table) => table,
        Err(error) => panic!("{}", error.message()),
    }
}

const fn rich_cells() -> [[Terms; 2]; COUNT] {
    let mut cells = cells();
    let mut k = 0;
    while k < COUNT {
        let share = k as f32 * 1e-3;
        cells[k][0].s = [0.02 + share, 0.001];
        cells[k][1].s = [-0.01 - share, -0.001];
        k += 1;
    }
    cells
}
