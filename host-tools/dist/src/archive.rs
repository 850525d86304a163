//! The static library for one platform.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use tempco_qemu::{Workspace, checked, clean_cargo};

use crate::Platform;
use crate::symbols::{faults, names};

/// What the crate's own object is called in the compiler's library.
const OWN: &str = "tempco_c-";
/// What all names of the interface begin with.
pub(crate) const PREFIX: &str = "tempco";

/// Builds `libtempco.a` for a platform in `folder`, which nobody else writes to, and returns its path.
///
/// The compiler's library has one object of all crates and many of its run-time library. Whatever is
/// needed of the latter is linked to the former, and only the names of the interface stay visible. So
/// an archive clashes with no other library, Rust or not, and computes floats of processors without
/// an FPU by its own functions, whatever the linker of the program would have taken.
///
/// # Errors
/// The compiler or a tool fails, or a name in the archive should not be there: a panic that can be
/// reached, among others.
pub fn archive(workspace: &Workspace, platform: &Platform, folder: &Path) -> Result<PathBuf> {
    let library = compile(workspace, platform, &folder.join("build"))?;
    let folder = folder.join(platform.target);
    fs::create_dir_all(&folder)?;
    let object = joined(platform, &library, &folder)?;
    let symbols = names(&platform.tool("nm"), &object)?;
    let faults = faults(&symbols, PREFIX, platform.from_libc);
    ensure!(faults.is_empty(), "{}: {faults:#?}", platform.target);

    let archive = folder.join("libtempco.a");
    if archive.exists() {
        fs::remove_file(&archive)?;
    }
    // `D`: no times, owners or modes.
    let mut pack = Command::new(platform.tool("ar"));
    checked(pack.arg("rcsD").args([&archive, &object]))?;
    fs::remove_file(&object)?;
    Ok(archive)
}

/// The compiler's static library.
fn compile(workspace: &Workspace, platform: &Platform, target_dir: &Path) -> Result<PathBuf> {
    let mut cargo = clean_cargo(workspace, "rustc", target_dir);
    cargo
        .args(["--locked", "--package", "tempco-c", "--lib"])
        .args(["--crate-type", "staticlib", "--profile", "archive"])
        .args(["--target", platform.target])
        // No path of this machine gets into it.
        .env("CARGO_ENCODED_RUSTFLAGS", remapped(workspace));
    checked(&mut cargo)?;
    let profile = target_dir.join(platform.target).join("archive");
    Ok(profile.join("libtempco_c.a"))
}

/// Flags of the compiler that give folders of this machine other names.
pub(crate) fn remapped(workspace: &Workspace) -> OsString {
    let cargo_home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = std::env::home_dir().map(|home| home.join(".cargo"));
    let mut flags = OsString::from("-Cllvm-args=-unroll-runtime=false\x1f--remap-path-prefix=");
    flags.push(workspace.root());
    flags.push("=tempco");
    if let Some(cargo) = cargo_home.or(home) {
        flags.push("\x1f--remap-path-prefix=");
        flags.push(cargo);
        flags.push("=cargo");
    }
    flags
}

/// Links the object of the crates with what it needs into one, and hides all foreign names.
fn joined(platform: &Platform, library: &Path, folder: &Path) -> Result<PathBuf> {
    let members = folder.join("members");
    if members.exists() {
        fs::remove_dir_all(&members)?;
    }
    fs::create_dir(&members)?;
    let mut unpack = Command::new(platform.tool("ar"));
    checked(unpack.arg("x").arg(library).current_dir(&members))?;
    let is_own = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default();
        name.to_string_lossy().starts_with(OWN)
    };
    let paths = fs::read_dir(&members)?.filter_map(|entry| Some(entry.ok()?.path()));
    let own = paths.into_iter().find(is_own);
    let own = own.context("the compiler's library has no object of the crate")?;

    let object = folder.join("tempco.o");
    let mut link = Command::new(platform.tool("ld"));
    link.args(["-r", "--gc-sections", "-o"]).arg(&object);
    for symbol in names(&platform.tool("nm"), &own)? {
        if symbol.is_defined() && symbol.name.starts_with(PREFIX) {
            link.args(["-u", &symbol.name]);
        }
    }
    checked(link.arg(own).arg(library))?;
    fs::remove_dir_all(&members)?;

    let mut hide = Command::new(platform.tool("objcopy"));
    hide.args(["--wildcard", "--keep-global-symbol", &format!("{PREFIX}*")])
        // Bitcode of the run-time library, which other compilers do not understand.
        .args(["--remove-section=.llvmbc", "--remove-section=.llvmcmd"])
        .args(platform.without)
        .arg("--strip-debug")
        .arg(&object);
    checked(&mut hide)?;
    Ok(object)
}
