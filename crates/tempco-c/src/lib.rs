//! The tempco core for C and C++: what `tempco.h` declares.
//!
//! Each function is a call into the core, and none computes anything itself. So a unit in C has the
//! bits of one in Rust. The header says to its users what each function does, in which context it
//! belongs, and what it costs; the documentation here is for who changes it.
//!
//! ```text
//! image, channel of table.h -> table -> objects that the caller owns -> axes: tempco1_, 2_, 3_, 6_
//!                              error    place: null, alignment, size     records: structures of C
//! ```
//!
//! - `axes`: the functions of each number of axes, made by one macro
//! - `common`: those that have no axes: status, errors, versions, what an image says of itself
//! - `table`: a table from an image or from the structure of `table.h`
//! - `place`: pointers of the caller, checked; `size`: how large the header makes its objects
//! - `memory`: copies of objects where there is no C library
//! - `records`: structures that C reads and writes; `error`: codes
//!
//! Set-up functions check each pointer. Functions of the thermal and the sample half take references:
//! their preconditions stand in the header.
#![no_std]
#![allow(unsafe_code, reason = "pointers of C, and names for its linker")]

mod axes;
mod common;
mod error;
#[cfg(all(target_os = "none", target_arch = "arm"))]
mod memory;
mod place;
mod records;
mod size;
mod table;

#[cfg(test)]
extern crate std;

pub use axes::{axes1, axes2, axes3, axes6};
pub use common::{abi_version, image_info, raw_status, status_name, strerror, validity};
pub use error::Error;
pub use records::{Axis, Channel, ImageInfo, Output, Point, Ramp};
pub use size::{INTERVAL_BYTES, OBJECTS, Object};

/// Version of the interface: it changes with the size of an object or the meaning of a function.
pub const ABI_VERSION: u32 = 1;

/// Calls what nobody defines: where a panic can be reached, the archive does not link.
#[cfg(all(feature = "panic-handler", panic = "abort"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    unsafe extern "C" {
        fn tempco_c_can_panic() -> !;
    }
    // SAFETY: there is no such function, so this is in no program.
    unsafe { tempco_c_can_panic() }
}
