//! Images of the firmware for an emulated board.

use std::path::PathBuf;

use anyhow::Result;
use tempco_qemu::{Board, Variant, Workspace, build_variant, ensure_qemu, ensure_target_of};
use tempco_set::files::ScratchFolder;
use tempco_set::{CoefficientSet, table_rs};

/// Builds an image for a set, or with the example table.
pub(super) fn build(
    set: Option<&CoefficientSet>,
    board: Board,
    bin: &str,
    variant: &Variant,
) -> Result<PathBuf> {
    let workspace = Workspace::find()?;
    ensure_target_of(&workspace, board)?;
    ensure_qemu(&workspace)?;
    let folder = ScratchFolder::new()?;
    let table = folder.path().join("table.rs");
    if let Some(set) = set {
        std::fs::write(&table, table_rs(set))?;
    }
    let table = set.is_some().then_some(table.as_path());
    Ok(build_variant(&workspace, board, bin, table, variant)?)
}
