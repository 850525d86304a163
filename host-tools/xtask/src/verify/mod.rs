//! How thorough the tests of the core are, what Miri says about them, the command on Windows, logs of
//! autopilots as others read them, and fleets on Spark. Apart from these gates: how good the fit is.
//!
//! Slow, and in need of tools that are not to be had everywhere: no part of the continuous checks.

mod coverage;
mod fleets;
mod logs;
mod miri;
mod model;
mod mutants;
mod places;
mod tools;
mod windows;

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::ValueEnum;
use tempco_qemu::Workspace;

use self::tools::Missing;

/// The tests of the core alone, without the example in its documentation.
const TESTS: [&str; 5] = ["--package", "tempco", "--locked", "--lib", "--tests"];

#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct Args {
    /// The gates to run; all of them, if none is said
    #[arg(value_enum)]
    gates: Vec<Gate>,
    #[command(subcommand)]
    trials: Option<Trials>,
}

/// Figures to look at, which no gate judges.
#[derive(clap::Subcommand)]
enum Trials {
    /// How good the fit is, on simulated units whose bias is known (tempco-trials)
    Model(model::Args),
}

#[derive(Clone, Copy, ValueEnum)]
enum Gate {
    /// Every region of the core and both outcomes of every branch are reached (cargo-llvm-cov)
    Coverage,
    /// Every condition of a compound decision is shown to decide on its own
    Mcdc,
    /// Of the mutants of the core that compile, the tests catch at least 95 % (cargo-mutants)
    Mutants,
    /// The tests of the core run under Miri, little and big endian
    Miri,
    /// The command for Windows does the main job under wine, with the same tables as here
    Windows,
    /// Logs of PX4 and ArduPilot are read as by pyulog and pymavlink
    Logs,
    /// Spark makes the tables of a single process, with damaged logs and a worker that dies
    Fleets,
}

impl Gate {
    fn measure(self, workspace: &Workspace) -> Result<Measured> {
        match self {
            Self::Coverage => coverage::regions_and_branches(workspace),
            Self::Mcdc => coverage::conditions(workspace),
            Self::Mutants => mutants::caught(workspace),
            Self::Miri => miri::both_endians(workspace),
            Self::Windows => windows::under_wine(workspace),
            Self::Logs => logs::as_others_read_them(workspace),
            Self::Fleets => fleets::on_spark(workspace),
        }
    }

    fn name(self) -> String {
        let value = self.to_possible_value();
        value.map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// What a gate measured.
#[derive(Debug, PartialEq)]
struct Measured {
    reached: bool,
    figure: String,
}

/// A gate without its tool is skipped; one that fails in any other way has failed.
#[derive(Debug, PartialEq)]
enum Verdict {
    Passed(String),
    Failed(String),
    Skipped(String),
}

impl From<Result<Measured>> for Verdict {
    fn from(measured: Result<Measured>) -> Self {
        match measured {
            Ok(Measured { reached, figure }) if reached => Self::Passed(figure),
            Ok(Measured { figure, .. }) => Self::Failed(figure),
            Err(error) if error.is::<Missing>() => Self::Skipped(format!("{error:#}")),
            Err(error) => Self::Failed(format!("{error:#}")),
        }
    }
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let workspace = Workspace::find()?;
    if let Some(Trials::Model(args)) = &args.trials {
        return model::trials(&workspace, args);
    }
    let gates = match args.gates.as_slice() {
        [] => Gate::value_variants(),
        some => some,
    };
    let mut verdicts = Vec::new();
    for &gate in gates {
        println!("\n== {}", gate.name());
        verdicts.push((gate.name(), Verdict::from(gate.measure(&workspace))));
    }
    println!();
    let (mut failed, mut skipped) = (0, 0);
    for (name, verdict) in &verdicts {
        let (word, figure) = match verdict {
            Verdict::Passed(figure) => ("passed", figure),
            Verdict::Failed(figure) => ("FAILED", figure),
            Verdict::Skipped(why) => ("SKIPPED", why),
        };
        failed += usize::from(word == "FAILED");
        skipped += usize::from(word == "SKIPPED");
        println!("{name:9} {word:8} {figure}");
    }
    let passed = verdicts.len() - failed - skipped;
    println!("\n{passed} passed, {failed} failed, {skipped} skipped");
    ensure!(failed == 0, "{failed} of {} gates failed", verdicts.len());
    Ok(())
}

/// Where the gates leave what they read their figures from.
fn output_folder(workspace: &Workspace) -> Result<PathBuf> {
    let folder = workspace.root().join("target/verify");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    Ok(folder)
}

#[cfg(test)]
mod tests {
    use anyhow::anyhow;

    use super::*;

    #[test]
    fn only_a_missing_tool_is_skipped() {
        let figure = || "99 of 100".to_owned();
        let measured = |reached| {
            Verdict::from(Ok(Measured {
                reached,
                figure: figure(),
            }))
        };
        assert_eq!(measured(true), Verdict::Passed(figure()));
        assert_eq!(measured(false), Verdict::Failed(figure()));
        let failed = Verdict::from(Err(anyhow!("a test failed").context("coverage")));
        assert_eq!(
            failed,
            Verdict::Failed("coverage: a test failed".to_owned())
        );
        let missing = Verdict::from(Err(Missing::new("no network").into()));
        assert!(matches!(missing, Verdict::Skipped(why) if why.contains("no network")));
    }
}
