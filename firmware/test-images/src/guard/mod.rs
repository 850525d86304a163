//! Stands in for `tempco_firmware::target` in the images `guard` and `guard_unit`: the proof that what they call
//! cannot panic.
//!
//! The panic handler calls a function that is nowhere defined. If the optimiser leaves any path to
//! a panic in the image, the linker refuses it and names the function; if the image links, there
//! is none. Nothing else may be in the image that could panic, so it neither logs nor formats.

mod flash;
mod link;
mod sensors;
mod store;

pub use link::links;
pub use sensors::sensors;
pub use store::stores;

use core::panic::PanicInfo;

use semihosting::sys::arm_compat::sys_writec;

use tempco_firmware::stack;

// Linked for what it defines: the critical section.
use cortex_m as _;

// SAFETY: nothing is ever called through this: an image with a call of the function does not link.
#[allow(unsafe_code)]
unsafe extern "C" {
    /// Defined nowhere, on purpose.
    safe fn tempco_link_guard_this_image_could_panic() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    tempco_link_guard_this_image_could_panic()
}

/// Writes the bytes of stack used so far to semihosting's console, as a line of eight hexadecimal
/// digits, and ends the program: 0 if all went well, else 1. Files, and even decimal digits, could
/// panic as they are made.
pub fn report_and_exit(success: bool) -> ! {
    let used = stack::used();
    for place in (0..8).rev() {
        let digit = (used >> (4 * place)) as u8 & 0xf;
        sys_writec(if digit < 10 {
            b'0' + digit
        } else {
            b'a' - 10 + digit
        });
    }
    sys_writec(b'\n');
    semihosting::process::exit(if success { 0 } else { 1 })
}
