//! The core cannot panic: an image that could would not link.

mod support;

use support::WORKSPACE;
use tempco_qemu::Board;
use tempco_qemu::guard::{MISSING_SYMBOL, SEEDED, VARIANTS, link, stack_used};

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

/// Else the test above would say nothing.
#[test]
fn an_image_that_could_panic_does_not_link() {
    let error = link(&WORKSPACE, Board::Mps2An386, &SEEDED).unwrap_err();
    let error = error.to_string();
    assert!(
        error.contains("undefined symbol") && error.contains(MISSING_SYMBOL),
        "{error}"
    );
}
