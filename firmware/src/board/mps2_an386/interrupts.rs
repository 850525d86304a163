//! The interrupts of the AN386, as a peripheral access crate would name them.
//!
//! A handler is `#[interrupt] fn UARTRX0()` with `interrupt` in scope. What has none ends in the
//! default handler.

use cortex_m::interrupt::InterruptNumber;
pub use cortex_m_rt::interrupt;

/// Lines to the interrupt controller of the FPGA image.
const LINES: usize = 32;

/// An interrupt that can have a handler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Interrupt {
    /// UART 0 has received a byte.
    UARTRX0 = 0,
    /// UART 1 has received a byte.
    UARTRX1 = 2,
    /// Timer 0 has come to its end.
    TIMER0 = 8,
}

// The name under which `#[interrupt]` looks for the number.
pub use Interrupt as interrupt;

// SAFETY: the values are different and constant.
#[allow(unsafe_code)]
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

// SAFETY: these are handlers, or the default handler under their names (`mps2-an386.device.x`); they
// are not called from here but entered by the processor through the table.
#[allow(unsafe_code)]
unsafe extern "C" {
    fn UARTRX0();
    fn UARTRX1();
    fn TIMER0();
    fn DefaultHandler();
}

/// What the linker puts behind the exceptions in the vector table.
// SAFETY: the linker script of the runtime asks for a symbol of this name and section, and nothing
// else defines it where the runtime's feature `device` is on; it is laid out as the vectors are.
#[allow(unsafe_code)]
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); LINES] = {
    let mut table = [DefaultHandler as unsafe extern "C" fn(); LINES];
    table[Interrupt::UARTRX0 as usize] = UARTRX0;
    table[Interrupt::UARTRX1 as usize] = UARTRX1;
    table[Interrupt::TIMER0 as usize] = TIMER0;
    table
};
