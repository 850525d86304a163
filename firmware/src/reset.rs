//! Resets of the application, and their reasons, which are kept in RAM.

use core::panic::PanicInfo;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};

/// Why the program resets the processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// A host has asked for it.
    Commanded,
    /// The watchdog's warning has come.
    Watchdog,
    /// A panic, at a line of its file, or a fault of the processor, at an address.
    Crash(u32),
}

const COMMANDED: u32 = 0x7e5e_0001;
const WATCHDOG: u32 = 0x7e5e_0002;
const CRASH: u32 = 0x7e5e_0003;

// SAFETY: the section is not loaded and keeps its contents over resets; any bits are an
// `AtomicU32`.
#[allow(unsafe_code)]
#[unsafe(link_section = ".uninit.RESET")]
static LEFT: [AtomicU32; 3] = [const { AtomicU32::new(0) }; 3];

/// Why the last reset was, as far as the program caused it. Once per start.
pub fn last() -> Option<Reason> {
    let [kind, place, check] = LEFT.each_ref().map(|word| word.load(Ordering::Relaxed));
    for word in &LEFT {
        word.store(0, Ordering::Relaxed);
    }
    match kind {
        // After power-on there is anything in it.
        _ if check != kind.rotate_left(7) ^ place => None,
        COMMANDED => Some(Reason::Commanded),
        WATCHDOG => Some(Reason::Watchdog),
        CRASH => Some(Reason::Crash(place)),
        _ => None,
    }
}

/// Resets the processor.
pub fn because(reason: Reason) -> ! {
    let (kind, place) = match reason {
        Reason::Commanded => (COMMANDED, 0),
        Reason::Watchdog => (WATCHDOG, 0),
        Reason::Crash(place) => (CRASH, place),
    };
    let words = [kind, place, kind.rotate_left(7) ^ place];
    for (left, word) in LEFT.iter().zip(words) {
        left.store(word, Ordering::Relaxed);
    }
    SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    because(Reason::Crash(
        info.location().map_or(0, |place| place.line()),
    ))
}

// SAFETY: the runtime calls this with the frame of the fault; the handler reads it and never
// returns, so neither the interrupted code nor its data is touched again.
#[allow(unsafe_code)]
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    because(Reason::Crash(frame.pc()))
}
