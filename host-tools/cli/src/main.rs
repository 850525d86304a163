//! The `tempco` command: fits, applies and judges bias compensation of gyro units.
//!
//! Exit codes: 0 done; 1 done, but judged not acceptable; 2 bad usage or bad input.

mod apply;
mod batch;
mod evaluate;
mod faults;
mod fit;
mod flash_set;
mod image;
mod inspect;
mod judgement;
mod method_args;
mod monitor;
mod output;
mod port_args;
mod progress;
mod replay;
mod report;
mod set_files;
mod set_tables;
mod shared_args;
#[cfg_attr(windows, path = "ctrl_c.rs")]
mod signals;
mod simulate;
mod status;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use tempco_set::escape;

/// Temperature compensation of gyroscope bias: from chamber logs to a table that flies.
#[derive(Parser)]
#[command(
    version,
    after_help = "Exit codes: 0 done; 1 done, but judged not acceptable; 2 bad usage or bad input."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Fit(fit::Args),
    Apply(apply::Args),
    Evaluate(evaluate::Args),
    Inspect(inspect::Args),
    Simulate(simulate::Args),
    Replay(replay::Args),
    FlashSet(flash_set::Args),
    Monitor(monitor::Args),
    Faults(faults::Args),
}

/// Whether what was done is acceptable; the exit code tells.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Exit {
    Acceptable,
    NotAcceptable,
}

impl Exit {
    const fn of(acceptable: bool) -> Self {
        if acceptable {
            Self::Acceptable
        } else {
            Self::NotAcceptable
        }
    }
}

fn main() -> ExitCode {
    // The shells of Windows leave patterns such as `*.csv` to the command.
    let command = Cli::parse_from(wild::args_os()).command;
    if let Err(error) = signals::watch() {
        // Whatever is unfinished then stays when the command is told to end.
        eprintln!("signals: {error}");
    }
    let result = match command {
        Command::Fit(args) => fit::run(&args),
        Command::Apply(args) => apply::run(&args),
        Command::Evaluate(args) => evaluate::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::FlashSet(args) => flash_set::run(&args),
        Command::Monitor(args) => monitor::run(&args),
        Command::Faults(args) => faults::run(&args),
    };
    match result {
        Ok(Exit::Acceptable) => ExitCode::SUCCESS,
        Ok(Exit::NotAcceptable) => ExitCode::from(1),
        Err(error) if output::is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}", escape::lines(&format!("error: {error:#}")));
            ExitCode::from(2)
        }
    }
}
