// Coefficient table of unit TWO,CHANNELS, made by hand: of another shape than the example.
pub const SERIAL: &str = "TWO,CHANNELS";
pub const CRC: u32 = 0x0000_0002;
pub const CHANNELS: usize = 2;
pub const AXES: usize = 2;
pub const AXIS_NAMES: [[&str; AXES]; CHANNELS] = [["a", "b"], ["c", "d"]];
pub const AXIS_UNITS: [[&str; AXES]; CHANNELS] = [["dph", "dph"], ["mps2", "mps2"]];
const CELLS_0: [[tempco::Terms; AXES]; 1] = [[
    tempco::Terms { a: [1.0, 2.0, 3.0], r: [4.0, 5.0], s: [0.0; 2] },
    tempco::Terms { a: [-1.0, -2.0, -3.0], r: [-4.0, -5.0], s: [0.0; 2] },
]];
const CELLS_1: [[tempco::Terms; AXES]; 3] = [[
    tempco::Terms { a: [1e-3, 2e-3, -3e-3], r: [4e-4, 5e-4], s: [0.0; 2] },
    tempco::Terms { a: [0.1, -0.2, 0.3], r: [0.01, -0.01], s: [0.0; 2] },
]; 3];
const SLOW: tempco::ThermalSettings = tempco::ThermalSettings {
    tau_s: 120.0,
    kappa: 0.5,
    ..tempco::ThermalSettings::DEFAULT
};
pub static TABLES: [tempco::Table<'static, AXES>; CHANNELS] = [
    match tempco::Table::new(
        match tempco::Thermal::new(tempco::ThermalSettings::DEFAULT) {
            Ok(thermal) => thermal,
            Err(error) => panic!("{}", error.message()),
        },
        -40.0,
        85.0,
        &CELLS_0,
    ) {
        Ok(table) => table,
        Err(error) => panic!("{}", error.message()),
    },
    match tempco::Table::new(
        match tempco::Thermal::new(SLOW) {
            Ok(thermal) => thermal,
            Err(error) => panic!("{}", error.message()),
        },
        0.0,
        60.0,
        &CELLS_1,
    ) {
        Ok(table) => table,
        Err(error) => panic!("{}", error.message()),
    },
];
