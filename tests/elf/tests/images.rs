//! The images as they are flashed: what the core consists of, and the stack it takes.

use tempco_elf::rules::{judge_image, judge_kernels, stack_without_failures};
use tempco_qemu::guard::{CORE, stack_used};
use tempco_qemu::{Board, Workspace, build, ensure_qemu, ensure_target};

const BOARD: Board = Board::Mps2An386;

fn workspace() -> Workspace {
    let workspace = Workspace::find().unwrap();
    ensure_target(&workspace).unwrap();
    ensure_qemu(&workspace).unwrap();
    workspace
}

/// The functions whose instructions `bench` counts, in the very image in which it counts them.
#[test]
fn steps_have_no_branch_on_data_no_loop_no_division_and_one_rounding_each() {
    let image = build(&workspace(), BOARD, "bench", None).unwrap();
    for judged in judge_kernels(&image).unwrap() {
        println!("{judged:#?}");
        assert_eq!(judged.faults, [""; 0], "{}", judged.kernel.name);
        assert!(judged.kernel.instructions > 20, "{}", judged.kernel.name);
        assert!(judged.kernel.stack <= 256, "{}", judged.kernel.name);
    }
}

#[test]
fn an_image_of_the_core_has_no_panic_no_formatting_no_soft_double_and_a_bounded_stack() {
    let workspace = workspace();
    for variant in CORE.variants {
        let image = CORE.link(&workspace, BOARD, &variant).unwrap();
        let judged = judge_image(&image).unwrap();
        let painted = stack_used(&image, BOARD).unwrap();
        println!("{}: {judged:#?}, painted {painted}", variant.name);
        assert_eq!(judged.faults, [""; 0], "{}", variant.name);
        assert!(painted <= judged.stack, "{painted} > {}", judged.stack);
        // A bound far from the truth would be of no use.
        assert!(
            judged.stack <= painted + 256,
            "{painted} << {}",
            judged.stack
        );
    }
}

/// An image that formats its panics is not mistaken for one that cannot panic.
#[test]
fn an_image_with_panics_is_told_apart() {
    let image = build(&workspace(), BOARD, "replay", None).unwrap();
    println!("{:?}", stack_without_failures(&image));
    let judged = judge_image(&image);
    assert!(judged.is_err() || !judged.unwrap().faults.is_empty());
}
