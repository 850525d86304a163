//! Simulated units.

use std::path::Path;

use pyo3::prelude::*;
use tempco_twin::{Profile, Simulation, Unit, write_log};

use crate::errors::{TempcoError, work};

/// The text of a simulated log, as `tempco simulate` writes it.
#[pyfunction]
pub(crate) fn simulate(
    py: Python,
    unit: &str,
    profile: &str,
    seed: u64,
    rate_hz: f64,
    draw: Option<u64>,
) -> PyResult<Vec<u8>> {
    work(py, || {
        text(unit, profile, seed, rate_hz, draw)
            .map_err(|error| TempcoError::new_err(error.to_string()))
    })
}

fn text(
    unit: &str,
    profile: &str,
    seed: u64,
    rate_hz: f64,
    draw: Option<u64>,
) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let unit = match unit {
        file if file.ends_with(".toml") => Unit::read(Path::new(file))?,
        name => Unit::named(name)?,
    };
    let unit = match draw {
        Some(seed) => unit.redrawn(seed),
        None => unit,
    };
    let profile = match profile {
        file if file.ends_with(".toml") => Profile::read(Path::new(file))?,
        name => Profile::named(name)?,
    };
    let mut text = Vec::new();
    write_log(&mut text, Simulation::new(&unit, &profile, seed, rate_hz)?)?;
    Ok(text)
}
