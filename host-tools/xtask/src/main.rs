//! `cargo xtask`: the demo, the tests and the benchmarks, each from a bare machine.

mod bench;
mod check;
mod demo;
mod dist;
mod figure;
mod golden;
mod paper;
mod prove;
mod python;
mod run;
mod test;
mod verify;
mod windows;

use std::process::ExitCode;

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
    /// What the linked images consist of: no panics, no branch on data, the worst-case stack
    Check,
    /// The same bits on hosts and targets, over ten million samples
    Golden(golden::Args),
    /// The paper's tables on a simulated unit, next to the printed ones
    Paper(paper::Args),
    /// What is shipped, in target/dist: the zip for C, the command, the wheel for Python, the page
    Dist(dist::Args),
    /// The page that runs the command in a browser, target/dist/tempco.html
    Web,
    /// Coverage, mutants, Miri, Windows and logs, as far as their tools can be had: slow, not part of `test`
    Verify(verify::Args),
    /// Executed instructions on the target, rows per second on the host
    Bench(bench::Args),
    /// Proofs on the compiled core by two solvers, bounds on rounding; skips what is not there
    Prove(prove::Args),
}

fn main() -> ExitCode {
    let result = match Cli::parse().task {
        Task::Demo => demo::run(),
        Task::Test => test::run(),
        Task::Check => check::run(),
        Task::Golden(args) => golden::run(&args),
        Task::Paper(args) => paper::run(&args),
        Task::Dist(args) => dist::run(&args),
        Task::Web => dist::web(),
        Task::Verify(args) => verify::run(&args),
        Task::Bench(args) => bench::run(&args),
        Task::Prove(args) => prove::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_options_of_all_tasks_are_sound() {
        Cli::command().debug_assert();
    }
}
