//! What happens when something went wrong beyond repair: it is reported, and the program ends.
//!
//! The images run under a debugger or an emulator; in an instrument the same places would reset.

use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m_rt::{ExceptionFrame, exception};

use super::exit;

/// Set by the first report, so that a failure while reporting does not report itself.
static FAILED: AtomicBool = AtomicBool::new(false);

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    if first() {
        defmt::error!("panicked: {}", defmt::Display2Format(info));
    }
    exit(false)
}

// SAFETY: the runtime calls this with the frame of the fault; the handler reads it and never
// returns, so neither the interrupted code nor its data is touched again.
#[allow(unsafe_code)]
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    if first() {
        defmt::error!("hard fault at {=u32:#010x}", frame.pc());
    }
    exit(false)
}

// SAFETY: an interrupt that nobody enabled is a defect; the handler only reports it and ends.
#[allow(unsafe_code)]
#[exception]
unsafe fn DefaultHandler(number: i16) -> ! {
    if first() {
        defmt::error!("unexpected interrupt {=i16}", number);
    }
    exit(false)
}

/// Whether this is the first failure. Load and store suffice: the failures of one core nest.
fn first() -> bool {
    let first = !FAILED.load(Ordering::Relaxed);
    FAILED.store(true, Ordering::Relaxed);
    first
}
