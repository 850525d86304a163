// Coefficient table of unit imported, written by tempco 0.1.0. Do not edit.

/// Serial number of the unit.
pub const SERIAL: &str = "imported";
/// CRC-32P4 over the numbers of the tables.
pub const CRC: u32 = 0x6a640d2c;
/// Temperature channels.
pub const CHANNELS: usize = 1;
/// Axes per channel.
pub const AXES: usize = 2;
/// Names of the axes.
pub const AXIS_NAMES: [[&str; AXES]; CHANNELS] = [["x", "y"]];
/// Units of the axes and of their biases.
pub const AXIS_UNITS: [[&str; AXES]; CHANNELS] = [["pulses_per_s", "pulses_per_s"]];

const CELLS_0: [[tempco::Terms; AXES]; 1] = [
    [
        tempco::Terms { a: [0.04055, -0.1615, 0.09025], r: [0.0, 0.0], s: [-0.0005, 0.0] },
        tempco::Terms { a: [-0.0086, 0.152, -0.361], r: [0.0, 0.0], s: [1e-6, 0.0] },
    ],
];

/// The tables, one per temperature channel.
pub static TABLES: [tempco::Table<'static, AXES>; CHANNELS] = [
    {
        const THERMAL: tempco::Thermal = match tempco::Thermal::new(tempco::ThermalSettings {
            sensor_min_c: -60.0,
            sensor_max_c: 150.0,
            spike_gate_c: 2.0,
            max_slew_c_per_min: 30.0,
            hold_s: 60.0,
            heal_s: 10.0,
            tau_s: 60.0,
            kappa: 0.0,
            rate_min_c_per_min: 0.0,
            rate_max_c_per_min: 0.0,
            reference_c: 25.0,
            tau2_s: 4500.0,
            kappa2: 0.0,
            lag2_min_c: -40.0,
            lag2_max_c: 40.0,
            half_width1_c: 2.5,
            half_width2_c: 0.0,
            play_kappa: 0.0,
            play_kappa2: 0.0,
            least_divisor: 0.0,
            rate_start: 0.0,
            lag2_start_min: 0.0,
            play_start_min: 0.0,
        }) { Ok(checked) => checked, Err(error) => panic!("{}", error.message()) };
        const WHOLE: tempco::Table<'static, AXES> = match tempco::Table::new(THERMAL, -15.0, 80.0, &CELLS_0) { Ok(checked) => checked, Err(error) => panic!("{}", error.message()) };
        const CALIBRATED: tempco::Table<'static, AXES> = match WHOLE.calibrated(-15.0, 80.0) { Ok(checked) => checked, Err(error) => panic!("{}", error.message()) };
        match CALIBRATED.with_plays([[0.004, -0.25], [0.0, 0.0]]) { Ok(checked) => checked, Err(error) => panic!("{}", error.message()) }
    },
];
