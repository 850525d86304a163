//! An image of the firmware with the table of a set, for an emulated board.

use std::path::PathBuf;

use anyhow::Result;
use tempco_qemu::{Board, Variant, Workspace, build_variant, ensure_qemu, ensure_target_of};
use tempco_set::files::ScratchFolder;
use tempco_set::table_rs;

use super::Replay;

/// Builds an image of the firmware for the set.
pub(super) fn build(put: &Replay, board: Board, bin: &str, variant: &Variant) -> Result<PathBuf> {
    let workspace = Workspace::find()?;
    ensure_target_of(&workspace, board)?;
    ensure_qemu(&workspace)?;
    let folder = ScratchFolder::new()?;
    let table = folder.path().join("table.rs");
    std::fs::write(&table, table_rs(put.set))?;
    Ok(build_variant(
        &workspace,
        board,
        bin,
        Some(&table),
        variant,
    )?)
}
