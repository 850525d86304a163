//! A chip select that gives the chip time.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, OutputPin};

/// A chip select, low active, that waits before and after it ends a selection and after it begins
/// one.
///
/// So the first clock does not come too early, and neither does the end of a selection after the
/// last clock, nor the next selection. It goes where an SPI device takes a pin:
/// `RefCellDevice::new(&bus, ChipSelect::new(pin, delay, ns), delay)`.
pub struct ChipSelect<P, D> {
    pin: P,
    delay: D,
    ns: u32,
}

impl<P, D> ChipSelect<P, D> {
    /// A pin, and the time that the chip asks for around its edges \[ns\].
    pub const fn new(pin: P, delay: D, ns: u32) -> Self {
        Self { pin, delay, ns }
    }

    /// Gives the pin back.
    pub fn release(self) -> P {
        self.pin
    }
}

impl<P: OutputPin, D> ErrorType for ChipSelect<P, D> {
    type Error = P::Error;
}

impl<P: OutputPin, D: DelayNs> OutputPin for ChipSelect<P, D> {
    fn set_low(&mut self) -> Result<(), P::Error> {
        self.pin.set_low()?;
        self.delay.delay_ns(self.ns);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), P::Error> {
        self.delay.delay_ns(self.ns);
        self.pin.set_high()?;
        self.delay.delay_ns(self.ns);
        Ok(())
    }
}
