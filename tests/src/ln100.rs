//! The simulated unit `ln100` beside the records it is made after.

use std::fs;

use tempco_twin::{Output, Profile, Simulation, Unit};

use crate::shared;

/// Rate of the records and of the simulation \[Hz\].
pub const RATE_HZ: f64 = 64.0;

/// Averaging times in samples: octaves from 1/64 s, and 30 s.
pub const AVERAGED: [usize; 12] = [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 1920];

/// Seconds of an averaging time.
pub fn tau_s(averaged: usize) -> f64 {
    averaged as f64 / RATE_HZ
}

/// Overlapping Allan deviations \[deg/h\] of an axis at the times of [`AVERAGED`].
pub type Deviations = [f64; AVERAGED.len()];

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
    let mut angles = [const { Vec::new() }; 3];
    for line in lines {
        let cells: Vec<f64> = line
            .split(',')
            .map(|cell| cell.parse().expect("a number"))
            .collect();
        for (angles, rate_dps) in angles.iter_mut().zip(&cells[1..4]) {
            // deg/s are 3600 arcsec/s.
            append(angles, 3600.0 * rate_dps / RATE_HZ);
        }
    }
    Some(angles.map(|angles| deviations(&angles)))
}

/// Deviations of the X, Y and Z gyro of the simulated unit over two hours at rest.
///
/// # Panics
/// If the unit or the programme are gone.
pub fn twin(seed: u64) -> [Deviations; 3] {
    let unit = Unit::named("ln100").expect("the unit");
    let profile = Profile::named("rest").expect("the programme");
    let Output::Pulses {
        scale_factor_arcsec,
    } = unit.output
    else {
        panic!("the unit counts pulses");
    };
    let mut angles = [const { Vec::new() }; 3];
    for sample in Simulation::new(&unit, &profile, seed, RATE_HZ).expect("a valid unit") {
        for (angles, count) in angles.iter_mut().zip(sample.counts) {
            append(angles, scale_factor_arcsec * count as f64);
        }
    }
    angles.map(|angles| deviations(&angles))
}

fn append(angles: &mut Vec<f64>, increment: f64) {
    angles.push(angles.last().copied().unwrap_or(0.0) + increment);
}

/// `sqrt(mean((a[i + 2m] - 2 a[i + m] + a[i])^2) / 2) / tau` of angles \[arcsec\]: in arcsec/s, deg/h.
fn deviations(angles_arcsec: &[f64]) -> Deviations {
    AVERAGED.map(|m| {
        let count = angles_arcsec.len() - 2 * m;
        let square: f64 = (0..count)
            .map(|i| angles_arcsec[i + 2 * m] - 2.0 * angles_arcsec[i + m] + angles_arcsec[i])
            .map(|difference| difference * difference)
            .sum();
        (square / (2.0 * count as f64)).sqrt() / tau_s(m)
    })
}

/// How far two figures are apart, as a factor of at least 1.
pub fn factor(a: f64, b: f64) -> f64 {
    (a / b).max(b / a)
}
