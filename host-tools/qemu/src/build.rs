//! Builds an image, the same one whatever the caller's environment.

use std::ffi::OsStr;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use crate::install::checked;
use crate::{Board, Error, Workspace};

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

/// The images of the package `tempco-test-images`; all others are of `tempco-firmware`.
const TEST_IMAGES: [&str; 5] = ["bench", "faults", "golden", "guard", "guard_unit"];

/// How an image is compiled, apart from what is in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// Part of the names of its images; empty for the usual one.
    pub name: &'static str,
    /// Cargo features of the firmware beyond the board's.
    pub features: &'static [&'static str],
    /// Values for cargo's `--config`.
    pub config: &'static [&'static str],
}

impl Variant {
    /// The profile `firmware` as it is.
    pub const USUAL: Self = Self {
        name: "",
        features: &[],
        config: &[],
    };

    /// The application, image `unit`, with its logs.
    pub const APPLICATION: Self = Self {
        name: "application",
        features: &["application", "log"],
        config: &[],
    };

    /// The application on the reference board, with a host that plays chamber and gyros.
    pub const WORLD: Self = Self {
        name: "world",
        features: &["application", "log", "world"],
        config: &[],
    };
}

/// Builds the binary `bin` of the firmware or the test images for a board and returns the image's path.
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
    build_variant(workspace, board, bin, table, &Variant::USUAL)
}

/// As [`build()`], compiled in another way.
///
/// # Errors
/// As of [`build()`]; what the linker says is among them.
pub fn build_variant(
    workspace: &Workspace,
    board: Board,
    bin: &str,
    table: Option<&Path>,
    variant: &Variant,
) -> Result<PathBuf, Error> {
    let table = table
        .map(|path| path.canonicalize().map_err(Error::file(path)))
        .transpose()?;
    let target_dir = workspace.target_dir();
    let name = image_name(board, bin, table.as_deref(), variant)?;

    // Held until the image is copied, or the next build could come in between.
    let _lock = workspace.lock()?;
    let mut command = cargo(workspace, &target_dir, bin, variant);
    command.args(["--profile", "firmware"]);
    checked(&mut cargo_for(board, table.as_deref(), variant, command))?;
    let built = target_dir.join(board.target()).join("firmware").join(bin);
    keep(&built, &target_dir, &name)
}

/// Builds a binary of the firmware or the test images as a program for this machine, with the example table.
///
/// # Errors
/// The compiler's words, if it refuses.
pub fn build_host(
    workspace: &Workspace,
    bin: &str,
    profile: Profile,
    variant: &Variant,
) -> Result<PathBuf, Error> {
    let _lock = workspace.lock()?;
    let (mut command, built) = match profile {
        // As the tests of the workspace build it, where they do, so that it is there.
        Profile::Dev => {
            let folder = workspace.host_dir();
            let mut command = clean_cargo(workspace, "build", &folder);
            command.args(["--workspace", "--bin", bin]);
            (command, folder.join("debug"))
        }
        Profile::Firmware => {
            let folder = workspace.target_dir();
            let mut command = cargo(workspace, &folder, bin, variant);
            command.args(["--profile", "firmware"]);
            (command, folder.join("firmware"))
        }
    };
    checked(&mut command)?;
    let built = built.join(bin).with_extension(env::consts::EXE_EXTENSION);
    let name = format!("{bin}-host-{profile:?}{}", variant.name);
    keep(&built, &workspace.target_dir(), &name)
}

/// A profile of cargo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// Little optimisation, with overflow checks and debug assertions.
    Dev,
    /// All optimisation, no checks, as the images of the boards.
    Firmware,
}

/// Copies what was built to where the next build does not overwrite it.
fn keep(built: &Path, target_dir: &Path, name: &str) -> Result<PathBuf, Error> {
    let images = target_dir.join("images");
    fs::create_dir_all(&images).map_err(Error::file(&images))?;
    let image = images.join(name);
    // Renamed into place: another process may be running the image that was there.
    let partial = image.with_extension("partial");
    fs::copy(built, &partial).map_err(Error::file(built))?;
    fs::rename(&partial, &image).map_err(Error::file(&image))?;
    Ok(image)
}

/// A file name for each combination: tables are distinguished by what is in them.
fn image_name(
    board: Board,
    bin: &str,
    table: Option<&Path>,
    variant: &Variant,
) -> Result<String, Error> {
    let mut name = format!("{bin}-{board}");
    if !variant.name.is_empty() {
        name = format!("{name}-{}", variant.name);
    }
    if let Some(path) = table {
        let mut hasher = DefaultHasher::new();
        fs::read(path).map_err(Error::file(path))?.hash(&mut hasher);
        name = format!("{name}-{:016x}", hasher.finish());
    }
    Ok(name + ".elf")
}

fn cargo_for(board: Board, table: Option<&Path>, variant: &Variant, mut cargo: Command) -> Command {
    let rustflags = format!(
        r#"target.{}.rustflags=["-C","target-cpu={}"]"#,
        board.target(),
        board.cpu()
    );
    let board_feature = board.feature();
    let features = [&[board_feature.as_str()], variant.features].concat();
    cargo
        .args(["--target", board.target(), "--config", &rustflags])
        .args(["--no-default-features", "--features", &features.join(",")])
        .env("DEFMT_LOG", "info");
    if let Some(table) = table {
        cargo.env("TEMPCO_TABLE", table);
    }
    cargo
}

/// A command of cargo's in the workspace, without settings of the caller's environment that would
/// change what it builds.
pub fn clean_cargo(workspace: &Workspace, subcommand: &str, target_dir: &Path) -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    for (name, _) in env::vars_os().filter(|(name, _)| is_foreign(name)) {
        cargo.env_remove(name);
    }
    cargo
        .current_dir(workspace.root())
        .args([subcommand, "--target-dir"])
        .arg(target_dir);
    cargo
}

/// Builds one of the binaries, on a profile changed as the variant says.
fn cargo(workspace: &Workspace, target_dir: &Path, bin: &str, variant: &Variant) -> Command {
    let mut cargo = clean_cargo(workspace, "build", target_dir);
    cargo.args(["--package", package_of(bin), "--bin", bin]);
    for config in variant.config {
        cargo.args(["--config", config]);
    }
    cargo
}

fn package_of(bin: &str) -> &'static str {
    if TEST_IMAGES.contains(&bin) {
        "tempco-test-images"
    } else {
        "tempco-firmware"
    }
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
