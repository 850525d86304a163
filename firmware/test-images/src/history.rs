//! The built-in table with terms of the thermal history, to measure and compare what they take.

use tempco::{Play, SlowPart, Table, Thermal, ThermalSettings};

use tempco_firmware::table::{AXES, TABLES};

/// One hysteresis term on top.
pub static PLAY: Table<'static, AXES, 1> = match slow().with_history([TERM], []) {
    Ok(table) => table,
    Err(error) => panic!("{}", error.message()),
};

/// One hysteresis term and one second lag on top.
pub static HISTORY: [Table<'static, AXES, 1, 1>; 1] = [match slow().with_history([TERM], [PART]) {
    Ok(table) => table,
    Err(error) => panic!("{}", error.message()),
}];

const TERM: Play<AXES> = Play {
    half_width_c: 2.5,
    gain: [0.001; AXES],
};

const PART: SlowPart<AXES> = SlowPart {
    tau_s: 3600.0,
    limit_c: 20.0,
    gain: [-0.0005; AXES],
};

/// The table with a time constant that takes a correction after power-on, and with a shift.
const fn slow() -> Table<'static, AXES> {
    let table = &TABLES[0];
    let settings = ThermalSettings {
        tau_s: 600.0,
        kappa: 0.5,
        ..*table.thermal().settings()
    };
    let thermal = match Thermal::new(settings) {
        Ok(thermal) => thermal,
        Err(error) => panic!("{}", error.message()),
    };
    match Table::new(
        thermal,
        table.first_edge_c(),
        table.t_max_c(),
        table.cells(),
    ) {
        Ok(table) => table,
        Err(error) => panic!("{}", error.message()),
    }
}
