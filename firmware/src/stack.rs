//! How deep the stack has been: the start-up code paints it.

use cortex_m_rt::STACK_PAINT_VALUE;

// SAFETY: symbols of cortex-m-rt's linker script, of which only the address is used.
#[allow(unsafe_code)]
unsafe extern "C" {
    static _stack_start: u32;
    static _stack_end: u32;
}

/// Bytes above the end of the stack that must never have been used.
const MARGIN: usize = 1024;

/// Bytes between the start of the stack and the deepest word that was written since the start-up
/// code painted all of it.
pub fn used() -> u32 {
    let start = (&raw const _stack_start).addr();
    let mut word = &raw const _stack_end;
    // SAFETY: the linker script places `_stack_end` below `_stack_start`, both aligned to words,
    // and the RAM between them is the stack: mapped, painted by the start-up code, and read here
    // as plain words. Reading is volatile, since the compiler sees no object there.
    #[allow(unsafe_code)]
    unsafe {
        while word.addr() < start && word.read_volatile() == STACK_PAINT_VALUE {
            word = word.add(1);
        }
    }
    start.wrapping_sub(word.addr()) as u32
}

/// Whether the stack has kept its distance from what lies below it.
pub fn is_sound() -> bool {
    let word = (&raw const _stack_end).wrapping_byte_add(MARGIN);
    // SAFETY: as above; the stack is longer than the margin, which the linker script's RAM sees to.
    #[allow(unsafe_code)]
    let value = unsafe { word.read_volatile() };
    value == STACK_PAINT_VALUE
}
