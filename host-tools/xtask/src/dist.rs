//! What is shipped.

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::ValueEnum;
use tempco_dist::{Platform, c_package, command};
use tempco_qemu::Workspace;

use crate::python;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// What to make; all, if not said
    #[arg(value_enum)]
    only: Option<What>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    /// Archives, header and modules for C and C++
    C,
    /// The `tempco` command for Linux and Windows
    Command,
    /// The wheels for Python on Linux and Windows
    Wheel,
    /// The page that runs the command in a browser
    Page,
}

/// Makes the page alone.
pub(crate) fn web() -> Result<()> {
    run(&Args {
        only: Some(What::Page),
    })
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let workspace = Workspace::find()?;
    let folder = workspace.root().join("target/dist");
    let is_wanted = |what| args.only.is_none_or(|only| only == what);
    if is_wanted(What::C) {
        for platform in Platform::ALL {
            platform.ensure(&workspace)?;
        }
        say(c_package(&workspace, &Platform::ALL, &folder)?, &workspace);
    }
    if is_wanted(What::Command) {
        for platform in [Platform::LINUX, Platform::WINDOWS] {
            platform.ensure(&workspace)?;
            say(command(&workspace, &platform, &folder)?, &workspace);
        }
    }
    if is_wanted(What::Wheel) {
        for wheel in python::wheels(&workspace, &folder)? {
            say(wheel, &workspace);
        }
    }
    if is_wanted(What::Page) {
        say(tempco_web::page(&workspace, &folder)?, &workspace);
    }
    Ok(())
}

fn say(path: PathBuf, workspace: &Workspace) {
    let shown: &Path = path.strip_prefix(workspace.root()).unwrap_or(&path);
    println!("{}", shown.display());
}
