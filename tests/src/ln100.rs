//! The simulated unit `ln100` against the records it is made after.

use std::fs;

use tempco_evaluate::allan::overlapping;
use tempco_twin::{Output, Profile, Simulation, Unit};

use crate::shared;

/// Rate of the records and of the simulation \[Hz\].
pub const RATE_HZ: f64 = 64.0;

/// Number of averaging times: octaves from 1/64 s to 32 s.
pub const OCTAVES: usize = 12;

/// Averaging time of an octave \[s\].
pub fn tau_s(octave: usize) -> f64 {
    (1 << octave) as f64 / RATE_HZ
}

/// Overlapping Allan deviations \[deg/h\] of an axis at all octaves.
pub type Deviations = [f64; OCTAVES];

/// Deviations of the X, Y and Z gyro of a record, `up` or `down`; `None`, with a printed reason,
/// where it is absent.
///
/// # Panics
/// If the record is not what it was.
pub fn record(orientation: &str) -> Option<[Deviations; 3]> {
    let path = shared(&format!("data/ln100_rlg_static_x_{orientation}.csv"))?;
    let text = fs::read_to_string(path).expect("the record");
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    assert!(header.starts_with("time_s,gx_dps,gy_dps,gz_dps,"));
    let mut rates = [const { Vec::new() }; 3];
    for line in lines {
        let cells: Vec<f64> = line
            .split(',')
            .map(|cell| cell.parse().expect("a number"))
            .collect();
        for (rates, rate_dps) in rates.iter_mut().zip(&cells[1..4]) {
            rates.push(3600.0 * rate_dps);
        }
    }
    Some(rates.map(|rates| deviations(&rates)))
}

/// Deviations of the X, Y and Z gyro of the simulated unit over two hours at rest.
///
/// # Panics
/// If the unit or the profile are gone.
pub fn twin(seed: u64) -> [Deviations; 3] {
    let unit = Unit::named("ln100").expect("the unit");
    let profile = Profile::named("rest").expect("the profile");
    let Output::Pulses {
        scale_factor_arcsec,
    } = unit.output
    else {
        panic!("the unit counts pulses");
    };
    let mut rates = [const { Vec::new() }; 3];
    for sample in Simulation::new(&unit, &profile, seed, RATE_HZ).expect("a valid unit") {
        for (rates, count) in rates.iter_mut().zip(sample.counts) {
            // An arcsec/s is a deg/h.
            rates.push(scale_factor_arcsec * RATE_HZ * count as f64);
        }
    }
    rates.map(|rates| deviations(&rates))
}

fn deviations(rates_deg_per_h: &[f64]) -> Deviations {
    let points = overlapping(rates_deg_per_h.iter().copied(), 1.0 / RATE_HZ);
    std::array::from_fn(|octave| points[octave].deviation)
}

/// How far two numbers are apart, as a factor of at least 1.
pub fn factor(a: f64, b: f64) -> f64 {
    (a / b).max(b / a)
}
