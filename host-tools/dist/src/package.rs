//! What a C engineer downloads.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Result;
use tempco_qemu::Workspace;

use crate::{Platform, Tree, VERSION, archive};

/// Makes `folder/tempco-VERSION-c.zip` with archives for some platforms, and returns its path.
///
/// # Errors
/// An archive cannot be made, or a file cannot be read or written.
pub fn c_package(workspace: &Workspace, platforms: &[Platform], folder: &Path) -> Result<PathBuf> {
    let mut tree = Tree::default();
    tree.add_folder("", &workspace.root().join("crates/tempco-c/package"))?;
    for name in ["LICENSE-APACHE", "LICENSE-MIT", "CHANGELOG.md"] {
        tree.add(name, &workspace.root().join(name))?;
    }
    for platform in platforms {
        let path = archive(workspace, platform, folder)?;
        tree.add(&format!("lib/{}/libtempco.a", platform.target), &path)?;
    }
    write(tree, folder, &format!("tempco-{VERSION}-c"))
}

/// Writes a tree as a zip.
pub(crate) fn write(tree: Tree, folder: &Path, name: &str) -> Result<PathBuf> {
    fs::create_dir_all(folder)?;
    let path = folder.join(format!("{name}.zip"));
    fs::write(&path, tree.zip(name)?)?;
    Ok(path)
}
