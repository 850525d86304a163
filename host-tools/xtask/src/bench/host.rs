//! Rows per second of the `tempco` command, next to what users would write instead.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;
use serde_json::{Map, Value, json};
use tempco_log::median::median;
use tempco_qemu::Workspace;
use tempco_twin::Profile;

use super::log::write_log;
use super::peers::{self, PEERS};
use super::watch::{Taken, watch};
use crate::run::build_tempco;

/// The segments of the paper, in degC.
const SEGMENTS: &str = "-15:15,5:35,25:60,50:80";

/// Samples per second of the simulation that is timed.
const SIMULATED_HZ: f64 = 20.0;

#[derive(clap::Args)]
pub(super) struct HostArgs {
    /// Rows of the logs that are used on the host, one after the other
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_values_t = [100_000, 1_000_000])]
    rows: Vec<u32>,
    /// Every program is run so often, in turn
    #[arg(long, value_name = "N", default_value_t = 3)]
    rounds: usize,
    /// Also fit a log of so many rows that comes through a pipe
    #[arg(long, value_name = "N")]
    pipe: Option<u64>,
}

/// A program and its runs.
struct Job<'a> {
    /// What is done, and the key of its figures.
    name: &'static str,
    rows: u64,
    command: Box<dyn Fn() -> Command + 'a>,
    runs: Vec<Taken>,
}

impl Job<'_> {
    /// The median of something that the runs took.
    fn median(&self, of: impl Fn(&Taken) -> f64) -> f64 {
        median(&mut self.runs.iter().map(of).collect::<Vec<_>>())
    }

    fn seconds(&self) -> f64 {
        self.median(|run| run.seconds)
    }

    fn cpu_s(&self) -> f64 {
        self.median(|run| run.cpu_s)
    }
}

/// Uses logs of each size: process start included, all programs in one run since the machine's load
/// shows in each. The figures are of the last size; `sizes` has the processor time of `fit`
/// for every one.
pub(super) fn figures(workspace: &Workspace, args: &HostArgs) -> Result<Value> {
    let program = build_tempco(workspace, &["--release"])?;
    let folder = workspace.root().join("target/bench");
    std::fs::create_dir_all(&folder)?;
    let python = peers::install(workspace);
    if let Err(error) = &python {
        println!("pandas, polars, DuckDB and Parquet are not measured: {error:#}");
    }
    let bench = Bench {
        workspace,
        program,
        folder,
        python: python.ok(),
    };
    let (mut figures, mut sizes) = (Map::new(), Vec::new());
    for &rows in &args.rows {
        let (of_size, fit) = bench.of_size(rows, args.rounds)?;
        figures = of_size;
        sizes.push(fit);
    }
    if let Some(rows) = args.pipe {
        sizes.push(bench.pipe(rows)?);
    }
    if let (Some(first), Some(last)) = (sizes.first(), sizes.last())
        && first.0 < last.0
    {
        let exponent = (last.1 / first.1).ln() / (last.0 as f64 / first.0 as f64).ln();
        println!("processor time of fit grows with the rows to the power of {exponent:.2}");
        figures.insert("exponent".to_owned(), json!(exponent));
    }
    figures.insert("sizes".to_owned(), json!(sizes));
    Ok(Value::Object(figures))
}

/// What is needed to run programs.
struct Bench<'a> {
    workspace: &'a Workspace,
    program: PathBuf,
    folder: PathBuf,
    /// The Python of the peers.
    python: Option<PathBuf>,
}

impl Bench<'_> {
    /// Runs every program on a log of about so many rows. Also returns the rows, and the processor time
    /// of `fit` \[s\].
    fn of_size(&self, rows: u32, rounds: usize) -> Result<(Map<String, Value>, (u64, f64))> {
        let [log, parquet] = ["host.csv", "host.parquet"].map(|name| self.folder.join(name));
        let rows = write_log(&log, rows)?;
        if let Some(python) = &self.python {
            let mut convert = peers::parquet(self.workspace, python, &log, &parquet);
            watch(&mut convert, None)?;
        }
        let mut jobs = self.jobs(&log, &parquet, rows)?;
        // In turn, so that a slow moment of the machine hits all of them.
        for _ in 0..rounds {
            for job in &mut jobs {
                job.runs.push(watch(&mut (job.command)(), None)?);
            }
        }
        let figures = print(&jobs, rounds);
        let fit = (rows, jobs[0].cpu_s());
        drop(jobs);
        std::fs::remove_file(&log)?;
        Ok((figures, fit))
    }

    /// All that is run on a log and on the same log as Parquet.
    fn jobs<'a>(&'a self, log: &'a Path, parquet: &'a Path, rows: u64) -> Result<Vec<Job<'a>>> {
        let set = self.folder.join("set");
        let job = |name, command: Box<dyn Fn() -> Command + 'a>| Job {
            name,
            rows,
            command,
            runs: Vec::new(),
        };
        let fit = |name, log: &'a Path, options: &'static [&'static str]| {
            job(name, Box::new(move || self.fit(log, options)))
        };
        let on_set = |name, command: &'static str, options: &'static [&'static str]| {
            let set = set.join("coefficients.json");
            let run = move || {
                let mut run = Command::new(&self.program);
                run.current_dir(&self.folder).arg(command);
                run.arg(&set).arg(log).args(options);
                run
            };
            job(name, Box::new(run))
        };
        let mut jobs = vec![
            // What the peers do, too.
            fit("fit", log, &["--model", "composite", "--no-report"]),
            fit("auto", log, &["--no-report"]),
            fit("with_report", log, &["--model", "composite"]),
            fit("auto_with_report", log, &[]),
            on_set("apply", "apply", &["--out", "applied.csv"]),
            on_set("evaluate", "evaluate", &["--json"]),
        ];
        let simulated = SIMULATED_HZ * Profile::named("calibration")?.duration_s() + 1.0;
        let simulate = || {
            let mut command = Command::new(&self.program);
            command.args(["simulate", "--unit", "paper", "--profile", "calibration"]);
            command.arg("--rate").arg(SIMULATED_HZ.to_string());
            command.arg("--out").arg(self.folder.join("simulated.csv"));
            command
        };
        jobs.push(Job {
            rows: simulated as u64,
            ..job("simulate", Box::new(simulate))
        });
        if let Some(python) = &self.python {
            jobs.push(fit(
                "parquet",
                parquet,
                &["--model", "composite", "--no-report"],
            ));
            for peer in PEERS {
                let command = move || peers::command(self.workspace, python, peer, log);
                jobs.push(job(peer, Box::new(command)));
            }
        }
        Ok(jobs)
    }

    fn fit(&self, log: &Path, options: &[&str]) -> Command {
        let mut command = Command::new(&self.program);
        command.arg("fit").arg(log).args(["--serial", "BENCH"]);
        command
            .arg("--out")
            .arg(self.folder.join("set"))
            .args(options);
        if options.contains(&"composite") {
            command.args(["--segments", SEGMENTS]);
        }
        command
    }

    /// Fits a log of so many rows that comes through a pipe. Returns them, and the processor time \[s\].
    fn pipe(&self, rows: u64) -> Result<(u64, f64)> {
        let mut fit = self.fit(
            Path::new("/dev/stdin"),
            &["--model", "composite", "--no-report"],
        );
        let taken = watch(&mut fit, Some(rows))?;
        println!(
            "fit of {rows} rows through a pipe: {:.1} s as fast as they are written, {:.1} s of \
             processor time, {:.0} ns a row, {:.1} MiB",
            taken.seconds,
            taken.cpu_s,
            1e9 * taken.cpu_s / rows as f64,
            mebibytes(&taken)
        );
        Ok((rows, taken.cpu_s))
    }
}

fn mebibytes(taken: &Taken) -> f64 {
    taken.peak_memory_bytes as f64 / (1 << 20) as f64
}

/// Prints the medians of all programs, and their ratio to the first one.
fn print(jobs: &[Job], rounds: usize) -> Map<String, Value> {
    println!("this machine, median of {rounds}, three axes from CSV to coefficients");
    println!(
        "                          rows   seconds      rows/s  CPU ns/row  peak MiB  times fit"
    );
    let fit_s = jobs.first().map_or(f64::NAN, Job::seconds);
    let mut figures = Map::new();
    for job in jobs {
        let (seconds, ratio) = (job.seconds(), job.seconds() / fit_s);
        let ns_per_row = 1e9 * job.cpu_s() / job.rows as f64;
        let rows_per_s = job.rows as f64 / seconds;
        println!(
            "  {:16} {:>11} {seconds:>9.2} {rows_per_s:>11.0} {ns_per_row:>11.0} {:>9.1} {ratio:>10.2}",
            job.name,
            job.rows,
            job.median(mebibytes),
        );
        let of_job = json!({
            "rows": job.rows,
            "seconds": seconds,
            "rows_per_s": rows_per_s.round(),
            "ns_per_row": ns_per_row,
            "ratio": ratio,
            "peak_memory_bytes": job.median(|taken| taken.peak_memory_bytes as f64),
        });
        figures.insert(job.name.to_owned(), of_job);
    }
    figures
}
