//! Temperatures: platinum resistors of 1000 ohm at MAX31865 on SPI1, one chip select each.

use core::cell::RefCell;

use embedded_hal_bus::spi::RefCellDevice;
use stm32f4xx_hal::gpio::{ErasedPin, Output, PA5, PA6, PA7};
use stm32f4xx_hal::hal::spi::MODE_1;
use stm32f4xx_hal::pac::SPI1;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::spi::Spi;
use tempco_sensors::{ChipSelect, Max31865, SensorFault};

use super::SENSORS;
use super::sensor::Sensor;
use super::wait::Cycles;
use crate::unit::devices::Thermometers;

type Select = ChipSelect<ErasedPin<Output>, Cycles>;
type Device = RefCellDevice<'static, Spi<SPI1>, Select, Cycles>;

/// The sensors; channel by channel the first, second and third.
pub struct Sensors([Sensor<Device>; SENSORS]);

impl Sensors {
    /// `None` where they were made before.
    pub(super) fn new(
        spi: SPI1,
        (clock, input, output): (PA5, PA6, PA7),
        selects: [ErasedPin<Output>; SENSORS],
        rcc: &mut Rcc,
    ) -> Option<Self> {
        let pins = (Some(clock), Some(input), Some(output));
        let spi = Spi::new(spi, pins, MODE_1, 1.MHz(), rcc);
        let bus: &'static RefCell<_> =
            cortex_m::singleton!(: RefCell<Spi<SPI1>> = RefCell::new(spi))?;
        Some(Self(selects.map(|select| {
            let select = ChipSelect::new(select, Cycles, Max31865::<Device>::SELECT_NS);
            let Ok(device) = RefCellDevice::new(bus, select, Cycles);
            Sensor::new(device)
        })))
    }
}

impl<const C: usize> Thermometers<C> for Sensors {
    /// A step of the chip is 0.03 degC, more than its noise.
    const STUCK_AFTER: Option<u32> = None;

    fn read(&mut self) -> [Result<f32, SensorFault>; C] {
        const { assert!(C <= SENSORS, "the board has three temperature sensors") };
        let mut sensors = self.0.iter_mut();
        core::array::from_fn(|_| sensors.next().map_or(Err(SensorFault::Bus), Sensor::read))
    }
}
