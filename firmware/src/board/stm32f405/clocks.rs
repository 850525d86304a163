//! 168 MHz, from the crystal or without it.

use cortex_m::asm;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

/// Where the clock comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum Source {
    /// The crystal of 8 MHz.
    Crystal,
    /// The internal oscillator, of 1 % at 25 degC and 8 % at worst, as the crystal did not start.
    /// Samples and rates are wrong by as much.
    Internal,
    /// Nothing can be set, as in QEMU.
    Fixed,
}

/// Frequency of the crystal \[MHz\].
const CRYSTAL_MHZ: u32 = 8;

/// Looks at the crystal, 10 us apart at the 16 MHz of before: 100 ms, where a good one takes 2 ms.
const LOOKS: u32 = 10_000;
const CYCLES_PER_LOOK: u32 = 160;

/// Sets the clocks.
///
/// The HAL waits without end for a crystal, and a unit that stays dark for a broken one is worse
/// than one whose time is off; so the crystal is tried here before the HAL hears of it. A PLL locks
/// whenever its input runs; for that, the HAL's wait stays.
pub(super) fn start(rcc: pac::RCC) -> (Rcc, Source) {
    // The processor runs from this oscillator now. Where it is not ready, nothing ever will be.
    if rcc.cr().read().hsirdy().is_not_ready() {
        return (rcc.constrain(), Source::Fixed);
    }
    if crystal_starts(&rcc) {
        let rcc = rcc.freeze(Config::hse(CRYSTAL_MHZ.MHz()).sysclk(168.MHz()));
        // From now on a crystal that stops is a non-maskable interrupt.
        rcc.cr().modify(|_, w| w.csson().on());
        (rcc, Source::Crystal)
    } else {
        rcc.cr().modify(|_, w| w.hseon().off());
        let rcc = rcc.freeze(Config::hsi().sysclk(168.MHz()));
        (rcc, Source::Internal)
    }
}

/// The crystal has stopped, and the processor runs from the internal oscillator at 16 MHz: nothing
/// is on time any more. After the reset it is at 168 MHz again.
// SAFETY: the handler writes atomics and resets the processor; it returns to nothing.
#[cfg(feature = "application")]
#[allow(unsafe_code)]
#[cortex_m_rt::exception]
unsafe fn NonMaskableInt() -> ! {
    crate::reset::because(crate::reset::Reason::Crash(line!()))
}

fn crystal_starts(rcc: &pac::RCC) -> bool {
    rcc.cr().modify(|_, w| w.hseon().on());
    (0..LOOKS).any(|_| {
        asm::delay(CYCLES_PER_LOOK);
        rcc.cr().read().hserdy().is_ready()
    })
}
