//! `cargo xtask`: the demo, the tests and the benchmarks, each from a bare machine.

mod bench;
mod demo;
mod prove;
mod run;
mod test;

use anyhow::Result;
use clap::{Parser, Subcommand};

/// Tasks of the tempco workspace; each installs what is missing.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// The whole main job: simulate a unit, fit, build firmware, run it in QEMU, compare
    Demo,
    /// Formatting, lints, documentation and every test, those in QEMU included
    Test,
    /// Executed instructions on the target, rows per second on the host
    Bench(bench::Args),
    /// Proofs on the compiled core by two solvers, bounds on rounding; skips what is not there
    Prove(prove::Args),
}

fn main() -> Result<()> {
    match Cli::parse().task {
        Task::Demo => demo::run(),
        Task::Test => test::run(),
        Task::Bench(args) => bench::run(&args),
        Task::Prove(args) => prove::run(&args),
    }
}
