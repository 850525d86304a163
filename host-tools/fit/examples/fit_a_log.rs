//! The fit as a library: a log is read, a model chosen and judged, the coefficient set written.
//!
//! Run it with `cargo run -p tempco-fit --example fit_a_log`, or with the path of a log of your own.

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use tempco_fit::{FitOptions, fit};
use tempco_log::{ReadOptions, read_log};
use tempco_set::{MARK, Model, write_set};

/// Two cycles between 0 and 50 degC at 1 and 0.5 degC/min, a row every two seconds, of a gyro with
/// a quadratic bias, 0.03 deg/h per degC/min, and some noise.
fn log() -> String {
    let mut text = "time_s,temp_c,gz_dph\n".to_owned();
    let (mut temp_c, mut noise) = (25.0, 1_u32);
    let ramps = [
        (50.0, 1.0),
        (0.0, 1.0),
        (50.0, 0.5),
        (0.0, 0.5),
        (25.0, 1.0),
    ];
    let mut time_s = 0.0;
    for (to_c, rate) in ramps {
        let direction = if to_c > temp_c { 1.0 } else { -1.0 };
        let steps = ((to_c - temp_c) / (direction * rate) * 30.0) as u32;
        for step in 0..steps + 300 {
            // Ten minutes of soak after each ramp.
            let rate = if step < steps { direction * rate } else { 0.0 };
            temp_c += rate / 30.0;
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = f64::from(noise) / f64::from(u32::MAX) - 0.5;
            let z: f64 = (temp_c - 25.0) / 25.0;
            let raw = 1.0 + 0.2 * z - 0.1 * z * z + 0.03 * rate + 0.02 * noise;
            writeln!(text, "{time_s},{temp_c:.4},{raw:.5}").expect("text can be written to");
            time_s += 2.0;
        }
    }
    text
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let path = match std::env::args_os().nth(1) {
        Some(path) => PathBuf::from(path),
        None => {
            let path = folder.path().join("log.csv");
            std::fs::write(&path, log())?;
            path
        }
    };
    let log = read_log(&path, &ReadOptions::default())?;
    let fit = fit(&[log], &FitOptions::new("EXAMPLE", Model::Composite))?;
    for warning in fit.judge().warnings {
        println!("warning: {}", warning.message);
    }
    for (_, axis) in fit.set.axes() {
        let held_out = axis.held_out.as_ref().ok_or("no comparison")?;
        println!(
            "{}: error on data left out of the fit {:.4} {} without compensation, {:.4} with",
            axis.name,
            held_out.none,
            axis.unit.name(),
            held_out.chosen.unwrap_or(f64::NAN)
        );
        assert!(held_out.chosen < Some(0.2 * held_out.none));
    }
    let set = folder.path().join("set");
    write_set(&set, &fit.set, None)?;
    println!(
        "wrote {} and the table for the firmware",
        set.join(MARK).display()
    );
    Ok(())
}
