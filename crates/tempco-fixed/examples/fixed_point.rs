//! The integer core as on a Cortex-M0: a sensor in steps of 1/16 degC, a gyro that counts pulses.
//!
//! Run it with `cargo run -p tempco-fixed --example fixed_point`.

use tempco::{Status, Table, Terms, Thermal, ThermalSettings};
use tempco_fixed::{FixedInterval, FixedTable, FixedTwoRate, INVALID, PulseCarry, from_binary_c};

/// One axis \[pulses/s\], three cells of 40 degC; the same constants the f32 core takes.
const CELLS: [[Terms; 1]; 3] = [
    [Terms {
        a: [0.30, -0.16, 0.04],
        r: [0.06, 0.02],
    }],
    [Terms {
        a: [0.18, -0.08, 0.04],
        r: [0.08, 0.00],
    }],
    [Terms {
        a: [0.14, 0.00, 0.10],
        r: [0.08, 0.03],
    }],
];

const THERMAL: Thermal = match Thermal::new(ThermalSettings::DEFAULT) {
    Ok(thermal) => thermal,
    Err(error) => panic!("{}", error.message()),
};

static F32_TABLE: Table<1> = match Table::new(THERMAL, -40.0, 80.0, &CELLS) {
    Ok(table) => table,
    Err(error) => panic!("{}", error.message()),
};

/// Converted by the compiler; a table that does not fit does not compile.
static TABLE: FixedTable<1, { F32_TABLE.cells().len() }> = match FixedTable::new(&F32_TABLE) {
    Ok(table) => table,
    Err(error) => panic!("{}", error.message()),
};

static TENTH: FixedInterval = FixedInterval::new(TABLE.thermal(), 0.1);
/// The gyro is read 100 times for each temperature, at 1 kHz.
const SAMPLES: u16 = 100;

fn main() {
    println!(
        "last place 2^{} pulses/s, error at most {:.1e} pulses/s",
        TABLE.exponents()[0],
        TABLE.error_bounds()[0]
    );
    let mut carry = PulseCarry::new(TABLE.exponents()[0], 1e-3).expect("a scale that fits");
    let mut unit = FixedTwoRate::new(&TABLE, SAMPLES);
    // 20 degC, then 2 degC/min: codes of 1/16 degC.
    let code = |tenths: i32| 320 + tenths * 2 * 16 / 600;
    unit.start(from_binary_c(code(0), 4));

    let (mut pulses, mut bias_sum) = (0_i64, 0.0_f64);
    let unit_per_place = f64::from(TABLE.exponents()[0]).exp2();
    for tenths in 1..=3000 {
        unit.update(&TENTH, from_binary_c(code(tenths), 4));
        for _ in 0..SAMPLES {
            // The raw pulses of a gyro at rest that has nothing but its bias: none are left.
            let out = unit.compensate([0]);
            pulses += i64::from(carry.pulses(out.bias[0]));
            bias_sum += f64::from(out.bias[0]) * unit_per_place * 1e-3;
        }
    }
    println!("{pulses} pulses taken out in 5 min, for a bias worth {bias_sum:.3}");
    assert!((pulses as f64 - bias_sum).abs() < 1.0);

    unit.update(&TENTH, INVALID);
    let out = unit.compensate([0]);
    assert_eq!(out.status, Status::TEMPERATURE_INVALID | Status::SETTLING);
    println!("sensor broken: {:?}", out.status.validity());
}
