//! What of the core its tests reach: regions and branches, and conditions by MC/DC.

use std::fs;

use anyhow::Result;
use serde_json::Value;
use tempco_qemu::Workspace;

use super::places::Places;
use super::tools::{LLVM_COV, MCDC_NIGHTLY, NIGHTLY, cargo_of, ensure_program, ensure_toolchain};
use super::{Measured, TESTS, output_folder};
use crate::run::run as step;

pub(super) fn regions_and_branches(workspace: &Workspace) -> Result<Measured> {
    let report = report(workspace, NIGHTLY, &["--branch"])?;
    let regions = Places::regions(&report).judge("regions", workspace)?;
    let branches = Places::branches(&report).judge("outcomes of branches", workspace)?;
    Ok(Measured {
        reached: regions.reached && branches.reached,
        figure: format!("{}, {}", regions.figure, branches.figure),
    })
}

pub(super) fn conditions(workspace: &Workspace) -> Result<Measured> {
    // The compiler is older than what the manifest asks for, but builds the core.
    let report = report(
        workspace,
        MCDC_NIGHTLY,
        &["--mcdc", "--ignore-rust-version"],
    )?;
    Places::conditions(&report).judge("conditions", workspace)
}

/// Runs the tests instrumented and returns what llvm-cov exports.
fn report(workspace: &Workspace, toolchain: &str, kind: &[&str]) -> Result<Value> {
    ensure_toolchain(workspace, toolchain, &["llvm-tools"])?;
    ensure_program(workspace, &LLVM_COV)?;
    let path = output_folder(workspace)?.join("coverage.json");
    // Only its subcommand `test` knows `--ignore-rust-version`.
    let mut command = cargo_of(workspace, toolchain, &["llvm-cov", "test", "--json"]);
    command.args(kind).args(TESTS);
    step(workspace, command.arg("--output-path").arg(&path))?;
    Ok(serde_json::from_slice(&fs::read(&path)?)?)
}
