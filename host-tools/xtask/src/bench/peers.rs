//! What users would write instead: pandas, polars or DuckDB with numpy, from PyPI.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use tempco_qemu::Workspace;

/// What `peers/fit.py` can read CSV by.
pub(super) const PEERS: [&str; 3] = ["pandas", "polars", "duckdb"];

/// The Python of the peers, installed below `target` if it is not yet.
pub(super) fn install(workspace: &Workspace) -> Result<PathBuf> {
    let folder = workspace.root().join("target/peers");
    let bin = if cfg!(windows) { "Scripts" } else { "bin" };
    let python = folder.join(bin).join("python");
    let wanted = workspace
        .root()
        .join("host-tools/xtask/peers/requirements.txt");
    let installed = folder.join("requirements.txt");
    let is_there = std::fs::read(&installed)
        .is_ok_and(|former| std::fs::read(&wanted).is_ok_and(|wanted| wanted == former));
    if !is_there {
        let done = |command: &mut Command| -> Result<()> {
            let status = command.status().with_context(|| format!("{command:?}"))?;
            ensure!(status.success(), "{command:?} ended with {status}");
            Ok(())
        };
        done(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
        let pip = [
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            "-r",
        ];
        done(Command::new(&python).args(pip).arg(&wanted))?;
        std::fs::copy(&wanted, &installed)?;
    }
    Ok(python)
}

/// The command that writes a log as Parquet.
pub(super) fn parquet(workspace: &Workspace, python: &Path, log: &Path, to: &Path) -> Command {
    let mut command = Command::new(python);
    command
        .arg(
            workspace
                .root()
                .join("host-tools/xtask/peers/to_parquet.py"),
        )
        .args([log, to]);
    command
}

/// The command by which a peer does the job.
pub(super) fn command(workspace: &Workspace, python: &Path, peer: &str, log: &Path) -> Command {
    let mut command = Command::new(python);
    command
        .arg(workspace.root().join("host-tools/xtask/peers/fit.py"))
        .arg(peer)
        .arg(log);
    command
}
