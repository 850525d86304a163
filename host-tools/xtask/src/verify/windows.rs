//! The command for Windows under wine: the tests of the main job, and the same files as here.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};
use tempco_qemu::{Workspace, ensure_program};

use super::tools::Missing;
use super::{Measured, output_folder};
use crate::run::{build_tempco, cargo, run as step, run_and_read};
use crate::test::count;
use crate::windows::{C_COMPILER, TARGET, ensure_compilers};

const TESTS: [&str; 3] = ["main_job", "set_files", "windows"];
/// By their names: QEMU and signals are of Unix.
const LEFT_OUT: [&str; 2] = ["replayed", "signals"];
/// A DLL that the command needs and an older wine, such as that of Debian 12, does not have.
const RANDOM: &str = "bcryptprimitives.dll";

pub(super) fn under_wine(workspace: &Workspace) -> Result<Measured> {
    ensure_compilers(workspace).map_err(Missing::new)?;
    ensure_program(workspace, "wine", &["wine", "wine64"]).map_err(Missing::new)?;
    let prefix = output_folder(workspace)?.join("wine");
    let environment = [
        ("WINEPREFIX", prefix.as_os_str()),
        ("WINEDEBUG", "-all".as_ref()),
    ];
    // What wine says when it is new must not be taken for a message of the command.
    let mut boot = Command::new("wine");
    step(
        workspace,
        boot.args(["wineboot", "--init"]).envs(environment),
    )?;
    let command = build_tempco(workspace, &["--target", TARGET])?;
    let system = prefix.join("drive_c/windows/system32");
    if !system.join(RANDOM).exists() {
        build_random(workspace, command.parent().context("no folder")?)?;
    }

    let mut test = cargo(
        workspace,
        &["test", "--locked", "--package", "tempco-tests"],
    );
    for name in TESTS {
        test.args(["--test", name]);
    }
    test.args(["--no-fail-fast", "--", "--include-ignored"]);
    for name in LEFT_OUT {
        test.args(["--skip", name]);
    }
    test.env("TEMPCO_COMMAND", command)
        .env("TEMPCO_RUNNER", "wine")
        .envs(environment);
    let (output, succeeded) = run_and_read(workspace, &mut test)?;
    let [passed, failed] = ["passed", "failed"].map(|what| count(&output, what));
    Ok(Measured {
        reached: succeeded && passed > 0,
        figure: format!("{passed} tests passed, {failed} failed"),
    })
}

/// Builds the DLL that wine lacks into the folder of the command, where it is found first.
fn build_random(workspace: &Workspace, folder: &Path) -> Result<()> {
    let source = "host-tools/xtask/src/verify/bcryptprimitives.c";
    let mut build = Command::new(C_COMPILER);
    build.current_dir(workspace.root());
    build.args(["-shared", "-o"]).arg(folder.join(RANDOM));
    step(workspace, build.args([source, "-ladvapi32"]))
}
