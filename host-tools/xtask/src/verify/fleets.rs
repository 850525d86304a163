//! Sets of a fleet by Spark, with damage and a worker that dies.

use std::fs;
use std::process::Command;

use anyhow::{Context, Result};
use tempco_qemu::{Workspace, ensure_program};

use super::tools::Missing;
use super::{Measured, output_folder};
use crate::python;
use crate::run::run_and_read;

/// The packages of a worker.
const PACKAGES: &str = "host-tools/xtask/src/verify/fleets.txt";
const SCRIPT: &str = include_str!("fleets.py");

pub(super) fn on_spark(workspace: &Workspace) -> Result<Measured> {
    ensure_program(workspace, "java", &["openjdk-17-jre-headless"]).map_err(Missing::new)?;
    let python = python::environment(workspace, "spark", PACKAGES)
        .map_err(|error| Missing::new(format!("{error:#}")))?;
    let module = python::module(workspace)?;
    let folder = output_folder(workspace)?.join("fleets");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let script = folder.join("fleets.py");
    fs::write(&script, SCRIPT)?;
    let paths = [module.package, workspace.root().join(python::TESTS)];
    let mut verify = Command::new(&python);
    verify
        .arg(script)
        .args([&module.command, &folder.join("run")])
        .env("PYTHONPATH", std::env::join_paths(paths)?)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("PYSPARK_PYTHON", &python);
    let (output, reached) = run_and_read(workspace, &mut verify)?;
    let is_figure = |line: &&str| line.starts_with(|first: char| first.is_ascii_digit());
    let figures = output.lines().filter(is_figure);
    Ok(Measured {
        reached,
        figure: figures.collect::<Vec<_>>().join("; "),
    })
}
