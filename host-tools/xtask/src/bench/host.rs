//! Rows per second of the `tempco` command, next to what users would write instead.

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

/// Step of the output of the unit `fog` \[deg/h\].
const STEP_DPH: f64 = 0.01;

/// Rows of a log of usual size.
const USUAL_ROWS: u32 = 100_000;

/// A program and its fastest run.
struct Job<'a> {
    /// What is done, and the key of its figures.
    name: &'static str,
    rows: u64,
    command: Box<dyn Fn() -> Command + 'a>,
    best: Option<Taken>,
}

impl<'a> Job<'a> {
    fn new(name: &'static str, rows: u64, command: impl Fn() -> Command + 'a) -> Self {
        Self {
            name,
            rows,
            command: Box::new(command),
            best: None,
        }
    }
}

/// Fits simulated logs from CSV to coefficients: process start included, all programs in one run
/// since the machine's load shows in each.
pub(super) fn figures(workspace: &Workspace, rows: u32) -> Result<Value> {
    let program = build_tempco(workspace, &["--release"])?;
    // Logs: one of the size asked for, one of usual size.
    let folder = workspace.root().join("target/bench");
    std::fs::create_dir_all(&folder)?;
    let (log, usual) = (folder.join("host.csv"), folder.join("usual.csv"));
    let rows = write_log(&log, rows)?;
    let usual_rows = write_log(&usual, USUAL_ROWS)?;
    let simulated = SIMULATED_HZ * Profile::named("calibration")?.duration_s() + 1.0;

    // The jobs. The peers do what `fit` does without its report.
    let simulate = || {
        let mut command = Command::new(&program);
        command.args(["simulate", "--unit", "paper", "--profile", "calibration"]);
        command.arg("--rate").arg(SIMULATED_HZ.to_string());
        command.arg("--out").arg(folder.join("simulated.csv"));
        command
    };
    let fit = |log: &Path, options: &[&str]| {
        let mut command = Command::new(&program);
        command.arg("fit").arg(log).args(["--serial", "BENCH"]);
        command.arg("--out").arg(folder.join("set")).args(options);
        command
    };
    let with_report = ["--model", "composite", "--segments", SEGMENTS];
    let composite = [&with_report[..], &["--no-report"]].concat();
    let auto = ["--no-report"];
    let python = peers::install(workspace);
    let mut jobs = vec![
        Job::new("fit", rows, || fit(&log, &composite)),
        Job::new("auto", rows, || fit(&log, &auto)),
        Job::new("with_report", rows, || fit(&log, &with_report)),
        Job::new("usual_fit", usual_rows, || fit(&usual, &composite)),
        Job::new("usual_auto", usual_rows, || fit(&usual, &auto)),
        Job::new("simulate", simulated as u64, simulate),
    ];
    match &python {
        Ok(python) => {
            for peer in PEERS {
                let log = &log;
                let command = move || peers::command(workspace, python, peer, log);
                jobs.push(Job::new(peer, rows, command));
            }
        }
        Err(error) => println!("pandas and polars are not measured: {error:#}"),
    }
    // In turn, so that a slow moment of the machine hits all of them.
    for _ in 0..ROUNDS {
        for job in &mut jobs {
            keep_best(&mut job.best, watch(&mut (job.command)())?);
        }
    }
    // The least of each job, and its ratio to `fit`.
    println!("this machine, best of {ROUNDS}, three axes from CSV to coefficients");
    println!("                      rows   seconds      rows/s  peak MiB  times fit");
    let fitting = jobs[0].best;
    let mut of_host = Map::new();
    for job in &jobs {
        let (Some(taken), Some(fitting)) = (job.best, fitting) else {
            continue;
        };
        let (seconds, ratio) = (taken.seconds, taken.seconds / fitting.seconds);
        println!(
            "  {:12} {:>11} {seconds:>9.2} {:>11.0} {:>9.1} {ratio:>10.2}",
            job.name,
            job.rows,
            job.rows as f64 / seconds,
            taken.peak_memory_bytes as f64 / (1 << 20) as f64,
        );
        let figures = json!({
            "rows": job.rows,
            "seconds": seconds,
            "rows_per_s": (job.rows as f64 / seconds).round(),
            "ratio": ratio,
            "peak_memory_bytes": taken.peak_memory_bytes,
        });
        of_host.insert(job.name.to_owned(), figures);
    }
    drop(jobs);
    std::fs::remove_file(&log)?;
    Ok(Value::Object(of_host))
}

fn keep_best(best: &mut Option<Taken>, taken: Taken) {
    if best.is_none_or(|best| taken.seconds < best.seconds) {
        *best = Some(taken);
    }
}

/// Writes a log of a fibre-optic gyro of about so many rows, with as many digits as real logs have.
fn write_log(path: &Path, rows: u32) -> Result<u64> {
    let profile = Profile::named("calibration")?;
    let rate_hz = f64::from(rows) / profile.duration_s();
    let samples = Simulation::new(&Unit::named("fog")?, &profile, 1, rate_hz)?;
    let mut log = BufWriter::with_capacity(1 << 20, File::create(path)?);
    writeln!(log, "time_s,temp_c,x_dph,y_dph,z_dph")?;
    let mut rows = 0;
    for sample in samples {
        let axis = |axis: usize| STEP_DPH * f64::from(sample.counts[axis] as i32);
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let (time_s, temp_c) = (sample.time_s, sample.temp_c);
        writeln!(log, "{time_s:.4},{temp_c:.4},{x:.6},{y:.6},{z:.6}")?;
        rows += 1;
    }
    log.flush()?;
    Ok(rows)
}
