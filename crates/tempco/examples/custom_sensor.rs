//! A sensor of one's own: a thermistor on an analogue-to-digital converter, from code to
//! compensation, with what happens when its wire breaks and is mended.
//!
//! Run it with `cargo run -p tempco --example custom_sensor`.

use tempco::{
    Compensator, Interval, Status, Table, Terms, Thermal, ThermalSettings, ThermalState, Validity,
};

/// A thermistor of 10 kiloohm at 25 degC against a resistor of the same size, read by a
/// converter of 12 bits that is fed by the same voltage.
struct Thermistor;

impl Thermistor {
    const BETA_K: f64 = 3950.0;
    const FULL_SCALE: u16 = 4095;

    /// The temperature of a code \[degC\]. NaN at the rails: an open or shorted sensor. The core
    /// takes NaN for what it is, so a driver needs no other way to say that it has no value.
    fn temp_c(code: u16) -> f32 {
        if !(8..=Self::FULL_SCALE - 8).contains(&code) {
            return f32::NAN;
        }
        let share = f64::from(code) / f64::from(Self::FULL_SCALE);
        let ratio = share / (1.0 - share);
        (1.0 / (1.0 / 298.15 + ratio.ln() / Self::BETA_K) - 273.15) as f32
    }

    /// The code at a temperature, for the simulation.
    fn code(temp_c: f64) -> u16 {
        let ratio = (Self::BETA_K * (1.0 / (temp_c + 273.15) - 1.0 / 298.15)).exp();
        (f64::from(Self::FULL_SCALE) * ratio / (1.0 + ratio)).round() as u16
    }
}

/// The settings that belong to the sensor: its range; what its noise and steps may make it jump;
/// how fast the part can move at most; how long a value may be held.
const THERMAL: Thermal = match Thermal::new(ThermalSettings {
    sensor_min_c: -45.0,
    sensor_max_c: 110.0,
    spike_gate_c: 0.5,
    max_slew_c_per_min: 10.0,
    hold_s: 30.0,
    ..ThermalSettings::DEFAULT
}) {
    Ok(thermal) => thermal,
    Err(error) => panic!("{}", error.message()),
};
static TABLE: Table<1> = match Table::new(
    THERMAL,
    -40.0,
    85.0,
    &[[Terms::new([0.2, 0.5, 0.1], [0.04, 0.0])]],
) {
    Ok(table) => table,
    Err(error) => panic!("{}", error.message()),
};
const SECOND: Interval = Interval::new(&THERMAL, 1.0);

/// What the converter reads after so many seconds: 1 degC/min from 20 degC; the wire is off for ten
/// seconds, and later for a minute and a half.
fn code(s: u32) -> u16 {
    match s {
        300..310 | 600..690 => Thermistor::FULL_SCALE,
        _ => Thermistor::code(20.0 + f64::from(s) / 60.0),
    }
}

fn main() {
    // At power-on the first value is accepted, so it is worth a median of a few.
    let mut first = [0, 1, 2].map(|s| Thermistor::temp_c(code(s)));
    first.sort_by(f32::total_cmp);
    let mut unit = Compensator::new(&TABLE);
    unit.start(first[1]);

    let mut before = (Status::OK, unit.step(&SECOND, first[1], [0.0]).bias[0]);
    let mut seen = Vec::new();
    for s in 3..1200 {
        let out = unit.step(&SECOND, Thermistor::temp_c(code(s)), [0.45]);
        let step = (out.bias[0] - before.1).abs();
        // Whatever the sensor does, the bias moves no faster than the part could.
        assert!(step < 0.01, "{step} at {s} s");
        if out.status != before.0 {
            let names = Status::NAMES.iter();
            let names = names.filter(|(flag, _)| out.status.contains(*flag));
            let names: Vec<&str> = names.map(|(_, name)| *name).collect();
            println!(
                "{s:4} s  {:6.2} degC  bias {:.4} deg/h  {:?}  {}",
                out.point.effective_c,
                out.bias[0],
                out.status.validity(),
                names.join(", ")
            );
            seen.push(out.status.validity());
        }
        before = (out.status, out.bias[0]);
    }
    let state: &ThermalState = unit.thermal_state();
    println!(
        "{} values rejected, {} starts of the estimator",
        state.rejected(),
        state.restarts()
    );
    // A hundred seconds without a wire, and the first value after the temperature was given up,
    // which has to wait for a second one that agrees.
    assert_eq!(state.rejected(), 101);
    assert!(seen.contains(&Validity::Degraded) && seen.contains(&Validity::Invalid));
    assert_eq!(before.0, Status::OK);
}
