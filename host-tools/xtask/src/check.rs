//! What the linked images consist of.

use anyhow::{Result, ensure};
use tempco_elf::rules::{judge_image, judge_kernels, stack_without_failures};
use tempco_qemu::guard::{CORE, UNIT, stack_used};
use tempco_qemu::{Board, Workspace, build, ensure_qemu, ensure_target};

const BOARD: Board = Board::Mps2An386;

pub(crate) fn run() -> Result<()> {
    let workspace = Workspace::find()?;
    ensure_target(&workspace)?;
    ensure_qemu(&workspace)?;
    let faults = [kernels(&workspace)?, images(&workspace)?].concat();
    for fault in &faults {
        println!("FAULT  {fault}");
    }
    ensure!(faults.is_empty(), "{} faults", faults.len());
    println!("\nno faults");
    Ok(())
}

/// The functions that run per sample, in the image in which their instructions are counted.
fn kernels(workspace: &Workspace) -> Result<Vec<String>> {
    let image = build(workspace, BOARD, "bench", None)?;
    println!("functions that run per sample ({BOARD}, image bench), with all they call");
    println!(
        "{:20} {:>12} {:>10} {:>8} {:>5} {:>6} {:>5} {:>7} {:>6} {:>7}",
        "function",
        "instructions",
        "predicated",
        "branches",
        "loops",
        "divide",
        "fused",
        "chained",
        "double",
        "stack"
    );
    let mut faults = Vec::new();
    for judged in judge_kernels(&image)? {
        let kernel = &judged.kernel;
        println!(
            "{:20} {:>12} {:>10} {:>8} {:>5} {:>6} {:>5} {:>7} {:>6} {:>5} B",
            kernel.name,
            kernel.instructions,
            kernel.predicated,
            kernel.branches.len(),
            kernel.loops.len(),
            kernel.divisions.len(),
            kernel.fused.len(),
            kernel.chained.len(),
            kernel.doubles.len(),
            kernel.stack
        );
        faults.extend(judged.faults);
    }
    Ok(faults)
}

/// The images that link only without panics, and the stack from reset on.
fn images(workspace: &Workspace) -> Result<Vec<String>> {
    println!("\nimages that link only if nothing can panic ({BOARD}, image guard)");
    println!(
        "{:20} {:>10} {:>10} {:>14} {:>15}",
        "variant", "links", "functions", "stack, static", "stack, painted"
    );
    let mut faults = Vec::new();
    for variant in CORE.variants {
        let image = CORE.link(workspace, BOARD, &variant)?;
        let judged = judge_image(&image)?;
        let painted = stack_used(&image, BOARD)?;
        println!(
            "{:20} {:>10} {:>10} {:>12} B {:>13} B",
            variant.name, "yes", judged.functions, judged.stack, painted
        );
        if painted > judged.stack {
            faults.push(format!(
                "{}: more stack used than there can be",
                variant.name
            ));
        }
        faults.extend(judged.faults);
    }
    println!("what a unit calls besides the core (image guard_unit)");
    for variant in UNIT.variants {
        let painted = stack_used(&UNIT.link(workspace, BOARD, &variant)?, BOARD)?;
        println!("{:20} {:>10} {:>40} B", variant.name, "yes", painted);
    }
    let replay = stack_without_failures(&build(workspace, BOARD, "replay", None)?)?;
    println!("image replay, static, but for its failure paths: {replay} B");
    Ok(faults)
}
