//! A table as a firmware engineer has it: a constant in flash, checked while it is compiled,
//! used once per sample or at two rates.
//!
//! Run it with `cargo run -p tempco --example static_table`.

use tempco::{
    Compensator, Corrector, Interval, RampBuffer, Status, Table, Terms, Thermal, ThermalHalf,
    ThermalSettings, Validity,
};

/// What the fit found for a gyro of one axis; all that is not said keeps its default.
const THERMAL: Thermal = match Thermal::new(ThermalSettings {
    tau_s: 30.0,
    rate_min_c_per_min: -3.0,
    rate_max_c_per_min: 3.0,
    ..ThermalSettings::DEFAULT
}) {
    Ok(thermal) => thermal,
    Err(error) => panic!("{}", error.message()),
};

/// Three cells of 40 degC from -40 degC on: bias [deg/h], and deg/h per degC/min.
const CELLS: [[Terms; 1]; 3] = [
    [Terms::new([0.30, -0.16, 0.04], [0.06, 0.02])],
    [Terms::new([0.18, -0.08, 0.04], [0.08, 0.00])],
    [Terms::new([0.14, 0.00, 0.10], [0.08, 0.03])],
];

/// A table that is not usable (a coefficient lost, a range the wrong way round) does not compile.
static TABLE: Table<1> = match Table::new(THERMAL, -40.0, 80.0, &CELLS) {
    Ok(table) => table,
    Err(error) => panic!("{}", error.message()),
};

/// Temperature at 10 Hz.
const TENTH: Interval = Interval::new(&THERMAL, 0.1);
/// From the main loop to the sampling interrupt.
static RAMPS: RampBuffer<1> = RampBuffer::new();
/// Gyro samples from one temperature to the next where the gyro runs at 1 kHz.
const SAMPLES_PER_UPDATE: u16 = 100;

/// A part that warms up by 2 degC/min from 20 degC on, and its gyro at rest.
fn temp_c(tenths: u32) -> f32 {
    20.0 + 2.0 / 600.0 * tenths as f32
}

/// Gyro and temperature at the same rate: one call does everything.
fn single_rate() {
    let mut unit = Compensator::new(&TABLE);
    unit.start(temp_c(0));
    let mut out = unit.step(&TENTH, temp_c(0), [0.25]);
    assert_eq!(out.status, Status::SETTLING);
    for tenths in 1..=3000 {
        out = unit.step(&TENTH, temp_c(tenths), [0.25]);
    }
    println!(
        "single rate: {:.2} degC, {:.3} degC/min, bias {:.4} deg/h, compensated {:.4} deg/h, {:?}",
        out.point.effective_c,
        out.point.rate_c_per_min,
        out.bias[0],
        out.compensated[0],
        out.status.validity()
    );
    // 30 degC is z = 3/4 of the second cell; the rate term adds 2 degC/min times 0.08.
    let expected = 0.18 - 0.08 * 0.75 + 0.04 * 0.75 * 0.75 + 2.0 * 0.08;
    assert!((out.bias[0] - expected).abs() < 1e-4);
    assert_eq!(out.compensated[0], 0.25 - out.bias[0]);
    assert_eq!(out.status.validity(), Validity::Valid);
}

/// The gyro runs faster: the thermal work is done at 10 Hz, a subtraction for each sample.
fn two_rate() {
    // The main loop's half, the interrupt's half, and what is between them.
    let mut thermal = ThermalHalf::new(&TABLE, SAMPLES_PER_UPDATE);
    let mut corrector = Corrector::new(&RAMPS);

    let [mut bias] = thermal.start(temp_c(0)).end;
    let mut largest_step = 0.0_f32;
    for tenths in 1..=3000 {
        RAMPS.publish(&thermal.update(&TENTH, temp_c(tenths)));
        for _ in 0..SAMPLES_PER_UPDATE {
            let [compensated] = corrector.correct([0.25]);
            let next = 0.25 - compensated;
            largest_step = largest_step.max((next - bias).abs());
            bias = next;
        }
    }
    println!("two rates: bias {bias:.4} deg/h, largest step {largest_step:.1e} deg/h");
    assert!((bias - 0.3025).abs() < 1e-4);
    assert!(largest_step < 1e-5);

    // The sensor breaks. The status tells at once, and which class of fault it is.
    RAMPS.publish(&thermal.update(&TENTH, f32::NAN));
    corrector.correct([0.25]);
    let status = corrector.status();
    for (flag, name) in Status::NAMES {
        if status.contains(flag) {
            println!("sensor broken: {name}");
        }
    }
    assert_eq!(status, Status::TEMPERATURE_INVALID | Status::SETTLING);
    assert_eq!(status.validity(), Validity::Degraded);
}

fn main() {
    single_rate();
    two_rate();
}
