//! A platinum resistor of 1000 ohm at a MAX31865 that may be missing, or come later.

use embedded_hal::spi::SpiDevice;
use tempco_sensors::{Filter, Max31865, Platinum, SensorFault, Wires};

/// The reference resistor next to the chip \[ohm\].
pub const REFERENCE_OHM: f64 = 4000.0;

/// Temperatures beyond which the chip reports a broken wire \[degC\].
const RANGE_C: (f64, f64) = (-80.0, 170.0);

/// The chip, which is started when it first answers.
pub struct Sensor<SPI> {
    chip: Max31865<SPI>,
    is_started: bool,
}

impl<SPI: SpiDevice> Sensor<SPI> {
    /// Nothing is sent yet.
    pub fn new(device: SPI) -> Self {
        Self {
            chip: Max31865::new(
                device,
                Platinum::PT1000,
                REFERENCE_OHM,
                Wires::TwoOrFour,
                Filter::Hz50,
            ),
            is_started: false,
        }
    }

    /// The last conversion \[degC\]. A chip that answers wrongly is started again, for one that has
    /// lost its supply for a moment no longer converts.
    ///
    /// # Errors
    /// As of [`Max31865::read`]; [`SensorFault::NotReady`] after the first start,
    /// [`SensorFault::Bus`] as long as a start fails.
    pub fn read(&mut self) -> Result<f32, SensorFault> {
        let reading = if self.is_started {
            self.chip.read()
        } else {
            Err(SensorFault::NotReady)
        };
        if !self.is_started || reading == Err(SensorFault::Bus) {
            let started = self.chip.start(RANGE_C.0, RANGE_C.1);
            self.is_started = started.is_ok();
            started?;
        }
        reading
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use embedded_hal::spi::{ErrorType, Operation};

    use super::*;

    /// The registers of a chip; without a supply it answers with ones.
    struct Chip {
        registers: [u8; 8],
        has_supply: bool,
        /// A wire of four, without which the resistance still looks good.
        has_wire: bool,
    }

    impl Chip {
        /// Carries out what was written, as far as it concerns faults.
        fn carry_out(&mut self) {
            let configuration = self.registers[0];
            if configuration & 0x02 != 0 {
                self.registers[7] = 0;
            }
            if configuration & 0x04 != 0 && !self.has_wire {
                self.registers[7] |= 0x20;
            }
            self.registers[0] &= !0x06;
        }
    }

    struct Bus<'a>(&'a RefCell<Chip>);

    impl ErrorType for Bus<'_> {
        type Error = core::convert::Infallible;
    }

    impl SpiDevice for Bus<'_> {
        fn transaction(&mut self, steps: &mut [Operation<'_, u8>]) -> Result<(), Self::Error> {
            let mut chip = self.0.borrow_mut();
            let mut address = 0;
            for step in steps {
                match step {
                    Operation::Write([first, values @ ..]) => {
                        address = usize::from(first & 0x7f);
                        if chip.has_supply {
                            chip.registers[address..][..values.len()].copy_from_slice(values);
                            chip.carry_out();
                        }
                    }
                    Operation::Read(bytes) if chip.has_supply => {
                        bytes.copy_from_slice(&chip.registers[address..][..bytes.len()]);
                    }
                    Operation::Read(bytes) => bytes.fill(0xff),
                    step => panic!("{step:?}"),
                }
            }
            Ok(())
        }
    }

    fn chip(has_supply: bool) -> RefCell<Chip> {
        let mut registers = [0; 8];
        // 1097.3 of 4000 ohm, in the upper 15 bits.
        let code = ((1097.3 / REFERENCE_OHM * 32_768.0) as u16) << 1;
        registers[1..3].copy_from_slice(&code.to_be_bytes());
        RefCell::new(Chip {
            registers,
            has_supply,
            has_wire: true,
        })
    }

    fn is_25_degc(reading: Result<f32, SensorFault>) -> bool {
        reading.is_ok_and(|temp_c| (temp_c - 25.0).abs() < 0.05)
    }

    #[test]
    fn a_chip_that_was_away_is_started_again() {
        let chip = chip(false);
        let mut sensor = Sensor::new(Bus(&chip));
        assert_eq!(sensor.read(), Err(SensorFault::Bus));
        chip.borrow_mut().has_supply = true;
        for _ in 0..2 {
            assert_eq!(sensor.read(), Err(SensorFault::NotReady));
        }
        assert!(is_25_degc(sensor.read()));

        // After a loss that nobody saw it is as after power-on: not converting.
        chip.borrow_mut().registers = [0; 8];
        assert_eq!(sensor.read(), Err(SensorFault::Bus));
        assert_eq!(chip.borrow().registers[0], 0xc1);

        chip.borrow_mut().has_supply = false;
        assert_eq!(sensor.read(), Err(SensorFault::Bus));
        chip.borrow_mut().registers = [0; 8];
        chip.borrow_mut().has_supply = true;
        assert_eq!(sensor.read(), Err(SensorFault::NotReady));
        assert_eq!(chip.borrow().registers[0], 0xc1);
    }

    /// Three seconds are 30 readings.
    #[test]
    fn an_open_wire_is_found_within_three_seconds_and_stays_open() {
        let chip = chip(true);
        let mut sensor = Sensor::new(Bus(&chip));
        assert!((0..3).any(|_| is_25_degc(sensor.read())));
        assert!((0..100).all(|_| is_25_degc(sensor.read())));

        chip.borrow_mut().has_wire = false;
        let unnoticed = (0..100).take_while(|_| is_25_degc(sensor.read())).count();
        assert!(unnoticed <= 31, "{unnoticed}");
        assert!((0..100).all(|_| sensor.read() == Err(SensorFault::Open)));

        chip.borrow_mut().has_wire = true;
        let healing = (0..100).take_while(|_| sensor.read().is_err()).count();
        assert!(healing <= 2, "{healing}");
        assert!((0..100).all(|_| is_25_degc(sensor.read())));
    }
}
