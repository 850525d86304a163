//! The core cannot panic: an image that could would not link.

mod support;

use support::WORKSPACE;
use tempco_qemu::Board;
use tempco_qemu::guard::{VARIANTS, link, stack_used};

#[test]
fn the_core_links_without_panics_optimised_for_speed_and_size_with_and_without_checks() {
    let board = Board::Mps2An386;
    for variant in VARIANTS {
        let image = link(&WORKSPACE, board, &variant).unwrap_or_else(|error| panic!("{error}"));
        let stack = stack_used(&image, board).unwrap();
        println!("{}: {stack} bytes of stack", variant.name);
        assert!((100..4096).contains(&stack), "{stack}");
    }
}
