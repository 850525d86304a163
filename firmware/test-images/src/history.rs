//! The built-in table with a second lag and both plays, to compare what becomes of them.

use tempco::{Table, Terms, Thermal, ThermalSettings};

use tempco_firmware::table::{AXES, TABLES};

/// With the time constant of a slow sensor, start rules, second lag and plays.
pub static HISTORY: [Table<'static, AXES>; 1] = [{
    let table = &TABLES[0];
    let settings = ThermalSettings {
        tau_s: 600.0,
        kappa: 0.5,
        tau2_s: 3600.0,
        kappa2: 0.125,
        lag2_min_c: -20.0,
        lag2_max_c: 20.0,
        half_width1_c: 2.5,
        half_width2_c: 6.0,
        play_kappa: 0.25,
        play_kappa2: -0.125,
        least_divisor: 0.25,
        rate_start: 1.75,
        lag2_start_min: 8.0,
        play_start_min: 1.5,
        ..*table.thermal().settings()
    };
    let thermal = match Thermal::new(settings) {
        Ok(thermal) => thermal,
        Err(error) => panic!("{}", error.message()),
    };
    let cold_c = table.first_edge_c();
    let table = match Table::new(thermal, cold_c, table.t_max_c(), &CELLS) {
        Ok(table) => table,
        Err(error) => panic!("{}", error.message()),
    };
    match table.with_plays([[0.001; AXES], [-0.002; AXES]]) {
        Ok(table) => table,
        Err(error) => panic!("{}", error.message()),
    }
}];

/// The cells, with terms of the second lag.
static CELLS: [[Terms; AXES]; TABLES[0].cells().len()] = {
    let mut cells = [[Terms::new([], []); AXES]; TABLES[0].cells().len()];
    let mut cell = 0;
    while cell < cells.len() {
        cells[cell] = TABLES[0].cells()[cell];
        let mut axis = 0;
        while axis < AXES {
            cells[cell][axis].s = [-0.0005, 0.0001];
            axis += 1;
        }
        cell += 1;
    }
    cells
};
