//! Neither the core nor what a unit calls besides can panic: an image that could would not link.

mod support;

use support::WORKSPACE;
use tempco_qemu::Board;
use tempco_qemu::guard::{CORE, Guard, MISSING_SYMBOL, SEEDED, UNIT, stack_used};

const BOARD: Board = Board::Mps2An386;

/// Links and runs every variant, which ends well only if all it calls did what it should.
fn link_all(guard: &Guard, stack_limit: u32) {
    for variant in guard.variants {
        let image = guard.link(&WORKSPACE, BOARD, &variant);
        let image = image.unwrap_or_else(|error| panic!("{error}"));
        let stack = stack_used(&image, BOARD).unwrap_or_else(|error| panic!("{error}"));
        println!("{}: {stack} bytes of stack", variant.name);
        assert!((100..stack_limit).contains(&stack), "{stack}");
    }
}

#[test]
fn the_core_links_without_panics_optimised_for_speed_and_size_with_and_without_checks() {
    link_all(&CORE, 4096);
}

/// More stack, most of it for what would be static in a unit: flash, buffers, both ends of a link.
#[test]
fn store_link_and_sensors_link_without_panics_likewise() {
    link_all(&UNIT, 32_768);
}

/// Else the tests above would say nothing.
#[test]
fn an_image_that_could_panic_does_not_link() {
    for guard in [CORE, UNIT] {
        let error = guard.link(&WORKSPACE, BOARD, &SEEDED).unwrap_err();
        let error = error.to_string();
        assert!(
            error.contains("undefined symbol") && error.contains(MISSING_SYMBOL),
            "{error}"
        );
    }
}
