//! The log that is fitted: of a simulated fibre-optic gyro, with as many digits as real logs have.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::Result;
use tempco_twin::{Profile, Simulation, Unit};

/// Step of the output of the unit `fog` \[deg/h\].
const STEP_DPH: f64 = 0.01;

/// Writes a log of about so many rows; returns how many it has.
pub(super) fn write_log(path: &Path, rows: u32) -> Result<u64> {
    let mut log = BufWriter::with_capacity(1 << 20, File::create(path)?);
    let rows = write_rows(&mut log, rows.into())?;
    log.flush()?;
    Ok(rows)
}

/// Writes its text.
pub(super) fn write_rows(log: &mut impl Write, rows: u64) -> Result<u64> {
    let profile = Profile::named("calibration")?;
    let rate_hz = rows as f64 / profile.duration_s();
    let samples = Simulation::new(&Unit::named("fog")?, &profile, 1, rate_hz)?;
    writeln!(log, "time_s,temp_c,x_dph,y_dph,z_dph")?;
    let mut rows = 0;
    for sample in samples {
        let axis = |axis: usize| STEP_DPH * f64::from(sample.counts[axis] as i32);
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let (time_s, temp_c) = (sample.time_s, sample.temp_c);
        writeln!(log, "{time_s:.4},{temp_c:.4},{x:.6},{y:.6},{z:.6}")?;
        rows += 1;
    }
    Ok(rows)
}
