//! Why the chip started, from the flags of its reset and clock control (`RCC_CSR`).

use crate::unit::devices::ResetCause;

const BROWN_OUT: u32 = 1 << 25;
const POWER_ON: u32 = 1 << 27;
const SOFTWARE: u32 = 1 << 28;
const INDEPENDENT_WATCHDOG: u32 = 1 << 29;
const WINDOW_WATCHDOG: u32 = 1 << 30;
const PIN: u32 = 1 << 26;

/// The cause behind flags that add up: every reset also pulls the pin, and power-on looks like a
/// brown-out too.
pub const fn cause(csr: u32) -> ResetCause {
    if csr & POWER_ON != 0 {
        ResetCause::PowerOn
    } else if csr & BROWN_OUT != 0 {
        ResetCause::BrownOut
    } else if csr & (INDEPENDENT_WATCHDOG | WINDOW_WATCHDOG) != 0 {
        ResetCause::Watchdog
    } else if csr & (SOFTWARE | PIN) != 0 {
        ResetCause::Commanded
    } else {
        ResetCause::PowerOn
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of the register as the reference manual says that each reset leaves it.
    #[test]
    fn each_reset_is_told_from_the_others() {
        for (csr, expected) in [
            (0x0e00_0000, ResetCause::PowerOn),
            (0x0600_0000, ResetCause::BrownOut),
            (0x2400_0000, ResetCause::Watchdog),
            (0x4400_0000, ResetCause::Watchdog),
            (0x1400_0000, ResetCause::Commanded),
            (0x0400_0000, ResetCause::Commanded),
            (0x0000_0003, ResetCause::PowerOn),
        ] {
            assert_eq!(cause(csr), expected, "{csr:#010x}");
        }
    }
}
