//! The `tempco` command: fits, applies and judges bias compensation of gyro units.
//!
//! Exit codes: 0 done; 1 done, but judged not acceptable; 2 bad usage or bad input.
//!
//! For WASI, which is how a browser runs it, it has no units, no signals and no terminal.

mod answer;
mod apply;
mod batch;
mod columns;
mod evaluate;
mod fit;
mod image;
mod inspect;
mod judgement;
mod method_args;
mod output;
mod parameters;
mod plan_args;
#[cfg_attr(target_os = "wasi", path = "no_progress.rs")]
mod progress;
mod report;
mod set_tables;
mod shared_args;
#[cfg(not(target_os = "wasi"))]
#[cfg_attr(windows, path = "ctrl_c.rs")]
mod signals;
mod simulate;
mod status;
mod summarise;
#[cfg(not(target_os = "wasi"))]
mod unit;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use tempco_set::escape;

/// Temperature compensation of gyro bias: from chamber logs to a table for firmware
#[derive(Parser)]
#[command(
    name = "tempco",
    version,
    max_term_width = output::WIDTH as usize,
    after_help = "Example: tempco fit chamber.csv --serial RLG-7 --out RLG-7\n\n\
                  Exit codes: 0 done; 1 done, but not acceptable; 2 bad usage or bad input."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Fit(fit::Args),
    Summarise(summarise::Args),
    Columns(columns::Args),
    Apply(apply::Args),
    Evaluate(evaluate::Args),
    Inspect(inspect::Args),
    Simulate(simulate::Args),
    Export(parameters::ExportArgs),
    Import(parameters::ImportArgs),
    #[cfg(not(target_os = "wasi"))]
    #[command(flatten)]
    Unit(unit::Command),
}

/// Whether the result is acceptable. It becomes the exit code.
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
    #[cfg(not(target_os = "wasi"))]
    if let Err(error) = signals::watch() {
        // A file that is not finished then stays if a signal ends the command.
        eprintln!("signals: {error}");
    }
    let result = match command {
        Command::Fit(args) => fit::run(&args),
        Command::Summarise(args) => summarise::run(&args),
        Command::Columns(args) => columns::run(&args),
        Command::Apply(args) => apply::run(&args),
        Command::Evaluate(args) => evaluate::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Export(args) => parameters::export(&args),
        Command::Import(args) => parameters::import(&args),
        #[cfg(not(target_os = "wasi"))]
        Command::Unit(command) => command.run(),
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

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn every_help_fits_into_80_columns_and_has_an_example_that_parses() {
        let mut tempco = Cli::command();
        tempco.build();
        let subcommands = tempco
            .get_subcommands()
            .filter(|of| of.get_name() != "help");
        let commands: Vec<clap::Command> = std::iter::once(&tempco)
            .chain(subcommands)
            .cloned()
            .collect();
        assert_eq!(commands.len(), 19);
        for mut command in commands {
            let name = command.get_name().to_owned();
            for help in [command.render_help(), command.render_long_help()] {
                let help = help.to_string();
                for line in help.lines() {
                    assert!(line.chars().count() <= 80, "{name}: {line}");
                }
                let mut lines = help.lines();
                let example = lines.find_map(|line| line.strip_prefix("Example: "));
                let words: Vec<&str> = example.unwrap_or_default().split(' ').collect();
                assert!(
                    name == "tempco" || words.get(1) == Some(&&name[..]),
                    "{name}: {help}"
                );
                let parsed = Cli::try_parse_from(words);
                assert!(parsed.is_ok(), "{name}: {:?}", parsed.err());
            }
        }
    }
}
