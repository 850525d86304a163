//! How good the fit is: runs `tempco-trials`.

use anyhow::Result;
use tempco_qemu::Workspace;

use crate::run::{cargo, run as step};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Arguments of the trials; `-- --help` lists them
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    passed_on: Vec<String>,
}

pub(super) fn trials(workspace: &Workspace, args: &Args) -> Result<()> {
    let mut trials = cargo(workspace, &["run", "--quiet", "--release", "--locked"]);
    trials.args(["--package", "tempco-trials", "--"]);
    trials.args(&args.passed_on);
    step(workspace, &mut trials)
}
