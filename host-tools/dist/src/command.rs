//! The `tempco` command as people install it who have no Rust tool chain.

use std::path::{Path, PathBuf};

use anyhow::Result;
use tempco_qemu::{Workspace, checked, clean_cargo};

use crate::archive::remapped;
use crate::package::write;
use crate::{Platform, Tree, VERSION};

/// Makes `folder/tempco-VERSION-TARGET.zip` with the command for a system, and returns its path.
///
/// # Errors
/// The command does not build, or a file cannot be read or written.
pub fn command(workspace: &Workspace, platform: &Platform, folder: &Path) -> Result<PathBuf> {
    let target_dir = folder.join("build");
    let mut cargo = clean_cargo(workspace, "build", &target_dir);
    cargo
        .args(["--locked", "--package", "tempco-cli", "--release"])
        .args(["--target", platform.target])
        .env("CARGO_ENCODED_RUSTFLAGS", remapped(workspace));
    checked(&mut cargo)?;
    let name = if *platform == Platform::WINDOWS {
        "tempco.exe"
    } else {
        "tempco"
    };
    let built = target_dir.join(platform.target).join("release").join(name);
    let mut tree = Tree::default();
    tree.add_program(name, &built)?;
    for name in ["LICENSE-APACHE", "LICENSE-MIT", "CHANGELOG.md"] {
        tree.add(name, &workspace.root().join(name))?;
    }
    tree.add("README.md", &workspace.root().join("docs/command-line.md"))?;
    write(
        tree,
        folder,
        &format!("tempco-{VERSION}-{}", platform.target),
    )
}
