//! Chooses the board's memory and the coefficient table, and says how images are linked.
//!
//! All link arguments are here and nowhere else: a `.cargo/config.toml` depends on the folder
//! cargo is started in, and `RUSTFLAGS` replaces what it says. Either way the result would be an
//! image that links and does not boot.
//!
//! The memory of a board is in `boards/<board>.x`. A board whose interrupts have names, and no
//! peripheral access crate that names them, has `boards/<board>.device.x` too.

use std::path::{Path, PathBuf};
use std::{env, fs};

/// The environment variable that names the coefficient table to build in (an absolute path).
const TABLE: &str = "TEMPCO_TABLE";

fn main() {
    let package = PathBuf::from(variable("CARGO_MANIFEST_DIR"));
    table(&package);
    if variable("CARGO_CFG_TARGET_OS") == "none" {
        memory(&package);
        for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
    println!("cargo:rerun-if-changed=build.rs");
}

fn table(package: &Path) {
    println!("cargo:rerun-if-env-changed={TABLE}");
    let table = match env::var_os(TABLE) {
        Some(path) => PathBuf::from(path),
        None => package.join("tables/example.rs"),
    };
    assert!(
        table.is_absolute() && table.is_file(),
        "{TABLE} must be the absolute path of a table written by `tempco fit`, not {table:?}"
    );
    println!("cargo:rerun-if-changed={}", table.display());
    println!("cargo:rustc-env=TEMPCO_TABLE_RS={}", table.display());
}

/// Copies the chosen board's memory file to where the `INCLUDE` of the workspace's `memory.x`
/// finds it, and the names of its interrupts to where `link.x` does.
fn memory(package: &Path) {
    let boards: Vec<String> = env::vars()
        .filter_map(|(name, _)| name.strip_prefix("CARGO_FEATURE_BOARD_").map(board_name))
        .collect();
    let [board] = boards.as_slice() else {
        panic!("exactly one board-* feature must be chosen for an image, not {boards:?}");
    };
    let out = PathBuf::from(variable("OUT_DIR"));
    let boards = package.join("boards");
    copy(
        &boards.join(format!("{board}.x")),
        &out.join("tempco-board.x"),
    );
    let device = boards.join(format!("{board}.device.x"));
    if device.is_file() {
        copy(&device, &out.join("device.x"));
    }

    let workspace = package.join("..");
    println!("cargo:rerun-if-changed={}", boards.display());
    println!(
        "cargo:rerun-if-changed={}",
        workspace.join("memory.x").display()
    );
    println!("cargo:rustc-link-search={}", out.display());
    // For a linker that is not started in the workspace's root.
    println!("cargo:rustc-link-search={}", workspace.display());
}

fn copy(from: &Path, to: &Path) {
    fs::copy(from, to).unwrap_or_else(|error| panic!("{}: {error}", from.display()));
}

/// Cargo passes the feature `board-mps2-an386` as `CARGO_FEATURE_BOARD_MPS2_AN386`.
fn board_name(feature: &str) -> String {
    feature.to_lowercase().replace('_', "-")
}

fn variable(name: &str) -> String {
    env::var(name).unwrap_or_else(|_| panic!("cargo sets {name}"))
}
