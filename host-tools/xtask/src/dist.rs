//! What is shipped.

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::ValueEnum;
use tempco_dist::{Platform, c_package, command};
use tempco_qemu::Workspace;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// What to make; both, if not said
    #[arg(value_enum)]
    only: Option<What>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    /// Archives, header and modules for C and C++
    C,
    /// The `tempco` command for Linux and Windows
    Command,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let workspace = Workspace::find()?;
    let folder = workspace.root().join("target/dist");
    if args.only != Some(What::Command) {
        for platform in Platform::ALL {
            platform.ensure(&workspace)?;
        }
        say(c_package(&workspace, &Platform::ALL, &folder)?, &workspace);
    }
    if args.only != Some(What::C) {
        for platform in [Platform::LINUX, Platform::WINDOWS] {
            platform.ensure(&workspace)?;
            say(command(&workspace, &platform, &folder)?, &workspace);
        }
    }
    Ok(())
}

fn say(path: PathBuf, workspace: &Workspace) {
    let shown: &Path = path.strip_prefix(workspace.root()).unwrap_or(&path);
    println!("{}", shown.display());
}
