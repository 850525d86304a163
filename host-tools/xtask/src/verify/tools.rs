//! The compilers and programs the gates need, each of one version, installed where it is missing.

use std::process::{Command, Stdio};

use anyhow::Result;
use tempco_qemu::Workspace;

use crate::run::{cargo, run as step};

/// Branch coverage and Miri are to be had of nightly compilers only.
pub(super) const NIGHTLY: &str = "nightly-2026-05-20";
/// The last compilers that knew MC/DC are of this time.
pub(super) const MCDC_NIGHTLY: &str = "nightly-2025-06-01";
pub(super) const LLVM_COV: Program = Program("cargo-llvm-cov", "0.9.1");
pub(super) const MUTANTS: Program = Program("cargo-mutants", "27.1.0");

/// A subcommand of cargo's and its version.
pub(super) struct Program(&'static str, &'static str);

/// A tool that can be had neither here nor from where it is installed from.
#[derive(Debug)]
pub(super) struct Missing(String);

impl Missing {
    pub(super) fn new(why: impl ToString) -> Self {
        Self(why.to_string())
    }
}

impl std::fmt::Display for Missing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "not to be had: {}", self.0)
    }
}

impl std::error::Error for Missing {}

/// A toolchain with components of it.
pub(super) fn ensure_toolchain(
    workspace: &Workspace,
    name: &str,
    components: &[&str],
) -> Result<(), Missing> {
    if answer(Command::new("rustup").args(["run", name, "rustc", "--version"])).is_none() {
        let mut install = Command::new("rustup");
        install.args(["toolchain", "install", name, "--profile", "minimal"]);
        have(workspace, &mut install)?;
    }
    let mut add = Command::new("rustup");
    add.args(["component", "add", "--toolchain", name]);
    have(workspace, add.args(components))
}

/// A subcommand of cargo's. One of another version gives way: figures are comparable only if the
/// same program made them.
pub(super) fn ensure_program(
    workspace: &Workspace,
    Program(name, version): &Program,
) -> Result<(), Missing> {
    let subcommand = name.trim_start_matches("cargo-");
    let found = answer(Command::new(name).args([subcommand, "--version"]));
    let wanted = format!("{name} {version}");
    if found.is_some_and(|found| found.trim() == wanted) {
        return Ok(());
    }
    let what = format!("{name}@{version}");
    have(
        workspace,
        &mut cargo(workspace, &["install", "--locked", &what]),
    )
}

/// A cargo command of a toolchain, without what the cargo that runs this set for itself.
pub(super) fn cargo_of(workspace: &Workspace, toolchain: &str, args: &[&str]) -> Command {
    let mut command = Command::new("rustup");
    command.args(["run", toolchain, "cargo"]).args(args);
    for name in ["CARGO", "RUSTC", "RUSTDOC", "RUSTUP_TOOLCHAIN"] {
        command.env_remove(name);
    }
    command.current_dir(workspace.root());
    command
}

fn have(workspace: &Workspace, install: &mut Command) -> Result<(), Missing> {
    step(workspace, install).map_err(|error| Missing::new(format!("{error:#}")))
}

/// What a command says, if it succeeds.
fn answer(command: &mut Command) -> Option<String> {
    let output = command.stderr(Stdio::null()).output().ok()?;
    let said = String::from_utf8(output.stdout).ok()?;
    output.status.success().then_some(said)
}
