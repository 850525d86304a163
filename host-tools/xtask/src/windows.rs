//! The `tempco` command for Windows, from here.

use anyhow::Result;
use tempco_qemu::{Error, Workspace, ensure_program, ensure_rust_target};

use crate::run::{cargo, run as step};

pub(crate) const TARGET: &str = "x86_64-pc-windows-gnu";
pub(crate) const C_COMPILER: &str = "x86_64-w64-mingw32-gcc";

/// Installs the Rust target, and the C compiler that a library needs.
///
/// # Errors
/// They cannot be installed from here; the error says how to.
pub(crate) fn ensure_compilers(workspace: &Workspace) -> Result<(), Error> {
    ensure_rust_target(workspace, TARGET)?;
    let packages = ["gcc-mingw-w64-x86-64"];
    ensure_program(workspace, C_COMPILER, &packages)
}

/// Checks that the command compiles for Windows without warnings. Returns why this was skipped.
pub(crate) fn lint(workspace: &Workspace) -> Result<Option<String>> {
    if let Err(missing) = ensure_compilers(workspace) {
        return Ok(Some(format!("the check for Windows: {missing}")));
    }
    let mut lint = cargo(
        workspace,
        &["clippy", "--locked", "--package", "tempco-cli"],
    );
    lint.args(["--target", TARGET, "--", "-D", "warnings"]);
    step(workspace, &mut lint)?;
    Ok(None)
}
