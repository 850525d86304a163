//! What users would write instead: pandas, polars or DuckDB with numpy, from PyPI.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;
use tempco_qemu::Workspace;

use crate::python::environment;

/// What `peers/fit.py` can read CSV by.
pub(super) const PEERS: [&str; 3] = ["pandas", "polars", "duckdb"];

/// The Python of the peers.
pub(super) fn install(workspace: &Workspace) -> Result<PathBuf> {
    environment(
        workspace,
        "peers",
        "host-tools/xtask/peers/requirements.txt",
    )
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
