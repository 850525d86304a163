//! Builds an image, the same one whatever the caller's environment.

use std::ffi::OsStr;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use crate::install::checked;
use crate::{Board, Error, Workspace};

/// The board's processor. It is more than the target's default: with it the compiler knows, for
/// instance, that a separate multiplication and addition are faster than VMLA on a Cortex-M4.
fn rustflags(board: Board) -> String {
    let (target, processor) = (board.target(), board.processor());
    format!(r#"target.{target}.rustflags=["-C","target-cpu={processor}"]"#)
}

/// Environment variables that would change the image, by their first letters. `cargo` sets some
/// of them for the programs it runs, coverage and lint tools others.
const FOREIGN: [&str; 10] = [
    "RUSTFLAGS",
    "CARGO_ENCODED_RUSTFLAGS",
    "RUSTC_WRAPPER",
    "RUSTC_WORKSPACE_WRAPPER",
    "CARGO_BUILD_",
    "CARGO_INCREMENTAL",
    "CARGO_PROFILE_",
    "CARGO_TARGET_",
    "TEMPCO_TABLE",
    "DEFMT_LOG",
];

/// Builds the firmware's binary `bin` for a board and returns the image's path.
///
/// With `table`, the coefficient table in that file is built in, else the example. Every
/// combination has a path of its own, which stays valid when another is built.
///
/// # Errors
/// The compiler's words, if it refuses; a bad table is among the reasons.
pub fn build(
    workspace: &Workspace,
    board: Board,
    bin: &str,
    table: Option<&Path>,
) -> Result<PathBuf, Error> {
    let table = table
        .map(|path| path.canonicalize().map_err(Error::file(path)))
        .transpose()?;
    let target_dir = workspace.target_dir();
    let name = image_name(board, bin, table.as_deref())?;

    // Held until the image is copied, or the next build could come in between.
    let _lock = workspace.lock()?;
    checked(&mut cargo(
        workspace,
        &target_dir,
        board,
        bin,
        table.as_deref(),
    ))?;
    let built = target_dir.join(board.target()).join("release").join(bin);
    let images = target_dir.join("images");
    fs::create_dir_all(&images).map_err(Error::file(&images))?;
    let image = images.join(name);
    // Renamed into place: another process may be running the image that was there.
    let partial = image.with_extension("partial");
    fs::copy(&built, &partial).map_err(Error::file(&built))?;
    fs::rename(&partial, &image).map_err(Error::file(&image))?;
    Ok(image)
}

/// A file name for each combination: tables are told apart by what is in them.
fn image_name(board: Board, bin: &str, table: Option<&Path>) -> Result<String, Error> {
    let Some(path) = table else {
        return Ok(format!("{bin}-{board}.elf"));
    };
    let mut hasher = DefaultHasher::new();
    fs::read(path).map_err(Error::file(path))?.hash(&mut hasher);
    Ok(format!("{bin}-{board}-{:016x}.elf", hasher.finish()))
}

fn cargo(
    workspace: &Workspace,
    target_dir: &Path,
    board: Board,
    bin: &str,
    table: Option<&Path>,
) -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    for (name, _) in env::vars_os().filter(|(name, _)| is_foreign(name)) {
        cargo.env_remove(name);
    }
    cargo
        .current_dir(workspace.root())
        .args(["build", "--release", "--package", "tempco-firmware"])
        .args(["--target", board.target(), "--config", &rustflags(board)])
        .args(["--no-default-features", "--features", &board.feature()])
        .args(["--bin", bin, "--target-dir"])
        .arg(target_dir)
        .env("DEFMT_LOG", "info");
    if let Some(table) = table {
        cargo.env("TEMPCO_TABLE", table);
    }
    cargo
}

fn is_foreign(name: &OsStr) -> bool {
    let name = name.to_string_lossy();
    FOREIGN.iter().any(|foreign| name.starts_with(foreign))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_settings_are_kept_out_and_others_are_not() {
        for name in ["RUSTFLAGS", "CARGO_PROFILE_RELEASE_LTO", "TEMPCO_TABLE"] {
            assert!(is_foreign(OsStr::new(name)), "{name}");
        }
        for name in ["PATH", "HOME", "CARGO_HOME", "RUSTUP_TOOLCHAIN", "CARGO"] {
            assert!(!is_foreign(OsStr::new(name)), "{name}");
        }
    }

    #[test]
    fn a_missing_table_is_named() {
        let missing = Path::new("/nonexistent/table.rs");
        let workspace = Workspace::find().unwrap();
        let error = build(&workspace, Board::Mps2An386, "replay", Some(missing)).unwrap_err();
        assert!(error.to_string().starts_with("/nonexistent/table.rs"));
    }
}
