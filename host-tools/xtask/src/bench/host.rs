//! Rows per second of the `tempco` command, beside what users would write instead.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::Command;

use anyhow::Result;
use serde_json::{Map, Value, json};
use tempco_qemu::Workspace;
use tempco_twin::{Profile, Simulation, Unit};

use super::peers::{self, PEERS};
use super::watch::{Taken, watch};
use crate::run::build_tempco;

/// Every program is run so often, in turn, and its fastest run counts.
const ROUNDS: usize = 3;

/// Samples per second of the simulation that is timed.
const SIMULATED_HZ: f64 = 20.0;

/// The segments of the paper, in degC.
const SEGMENTS: &str = "-15:15,5:35,25:60,50:80";

/// Fits a simulated log from CSV to coefficients: process start included, all programs in one run
/// since the machine's load shows in each.
pub(super) fn figures(workspace: &Workspace, rows: u32) -> Result<Value> {
    let program = build_tempco(workspace, &["--release"])?;
    let folder = workspace.root().join("target/bench");
    std::fs::create_dir_all(&folder)?;
    let log = folder.join("host.csv");
    let rows = write_log(&log, rows)?;

    let simulate = || {
        let mut command = Command::new(&program);
        command.args(["simulate", "--unit", "paper", "--profile", "calibration"]);
        command.arg("--rate").arg(SIMULATED_HZ.to_string());
        command.arg("--out").arg(folder.join("simulated.csv"));
        command
    };
    let fit = || {
        let mut command = Command::new(&program);
        command.arg("fit").arg(&log).args(["--serial", "BENCH"]);
        command.args(["--segments", SEGMENTS]);
        // The peers draw no figures either.
        command.arg("--no-report");
        command.arg("--out").arg(folder.join("set"));
        command
    };
    let python = peers::install(workspace);
    if let Err(error) = &python {
        println!("pandas and polars are not measured: {error:#}");
    }
    let mut fitting: Option<Taken> = None;
    let mut simulating = fitting;
    let mut of_peers = [None; PEERS.len()];
    for _ in 0..ROUNDS {
        keep_best(&mut simulating, watch(&mut simulate())?);
        keep_best(&mut fitting, watch(&mut fit())?);
        if let Ok(python) = &python {
            for (peer, best) in PEERS.iter().zip(&mut of_peers) {
                let taken = watch(&mut peers::command(workspace, python, peer, &log))?;
                keep_best(best, taken);
            }
        }
    }
    std::fs::remove_file(&log)?;

    println!("this machine, best of {ROUNDS}, {rows} rows of three axes from CSV to coefficients");
    println!("                    rows/s  peak MiB  times slower");
    let mut of_host = Map::new();
    of_host.insert("rows".to_owned(), json!(rows));
    if let Some(taken) = simulating {
        let simulated = SIMULATED_HZ * Profile::named("calibration")?.duration_s() + 1.0;
        let rows_per_s = (simulated / taken.seconds).round();
        of_host.insert("simulate_rows_per_s".to_owned(), json!(rows_per_s));
    }
    if let Some(fitting) = fitting {
        show("tempco fit", rows, fitting, fitting);
        of_host.insert("fit_rows_per_s".to_owned(), per_s(rows, fitting));
        let peak = json!(fitting.peak_memory_bytes);
        of_host.insert("peak_memory_bytes".to_owned(), peak);
        for (peer, best) in PEERS.iter().zip(of_peers) {
            let Some(best) = best else { continue };
            show(peer, rows, best, fitting);
            let figures = json!({
                "rows_per_s": per_s(rows, best),
                "ratio": best.seconds / fitting.seconds,
                "peak_memory_bytes": best.peak_memory_bytes,
            });
            of_host.insert((*peer).to_owned(), figures);
        }
    }
    Ok(Value::Object(of_host))
}

fn keep_best(best: &mut Option<Taken>, taken: Taken) {
    if best.is_none_or(|best| taken.seconds < best.seconds) {
        *best = Some(taken);
    }
}

fn per_s(rows: u64, taken: Taken) -> Value {
    json!((rows as f64 / taken.seconds).round())
}

fn show(name: &str, rows: u64, taken: Taken, tempco: Taken) {
    println!(
        "  {name:12} {:>11.0} {:>9.1} {:>13.2}",
        rows as f64 / taken.seconds,
        taken.peak_memory_bytes as f64 / (1 << 20) as f64,
        taken.seconds / tempco.seconds
    );
}

/// Writes a log of about so many rows with values of as many digits as real logs have.
fn write_log(path: &Path, rows: u32) -> Result<u64> {
    let profile = Profile::named("calibration")?;
    let rate_hz = f64::from(rows) / profile.duration_s();
    let samples = Simulation::new(&Unit::named("paper")?, &profile, 1, rate_hz)?;
    let mut log = BufWriter::with_capacity(1 << 20, File::create(path)?);
    writeln!(log, "time_s,temp_c,x_dph,y_dph,z_dph")?;
    let mut rows = 0;
    for sample in samples {
        // One arcsec per pulse: pulses per s are deg/h.
        let axis =
            |axis: usize| sample.truth.bias[axis] + 0.01 * f64::from(sample.counts[axis] as i32);
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let (time_s, temp_c) = (sample.time_s, sample.temp_c);
        writeln!(log, "{time_s:.4},{temp_c:.4},{x:.6},{y:.6},{z:.6}")?;
        rows += 1;
    }
    log.flush()?;
    Ok(rows)
}
