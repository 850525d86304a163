//! The sensors, on a bus that answers anything.

use core::hint::black_box;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::{i2c, spi};
use tempco_sensors::icm42688::{AntiAlias, ChipFault, Icm42688, OutputRate, Range, Settings};
use tempco_sensors::{
    Ads1220, ChipSelect, Divider, Filter, Gain, Input, Max31865, Platinum, Rate, SensorFault,
    Thermistor, Tmp117, Wires, for_core,
};

/// Reads each of the sensors and converts what it says; the gyro too.
#[inline(never)]
pub fn sensors() {
    _ = black_box(max31865().map(|temp_c| for_core(Ok(temp_c))));
    _ = black_box(ads1220());
    _ = black_box(tmp117());
    _ = black_box(chip_select());
    _ = black_box(icm42688());
    let platinum = Platinum {
        r0_ohm: black_box(100.0),
    };
    _ = black_box(platinum.temp_c(platinum.resistance_ohm(black_box(25.0))));
}

#[inline(never)]
fn max31865() -> Result<f32, SensorFault> {
    let (wires, filter) = black_box((Wires::Three, Filter::Hz50));
    let mut chip = Max31865::new(Bus, black_box(Platinum::PT100), 400.0, wires, filter);
    _ = black_box(chip.start(black_box(-40.0), black_box(85.0)));
    // A conversion with a fault-detection cycle after it, and the end of the cycle.
    _ = black_box(chip.read());
    let temp_c = chip.read();
    _ = black_box(chip.release());
    temp_c
}

#[inline(never)]
fn ads1220() -> Result<f32, SensorFault> {
    let mut chip = Ads1220::new(Bus);
    chip.reset()?;
    let (input, gain, rate) = black_box((Input::Ain0, Gain::X4, Rate::Sps20));
    _ = black_box(chip.configure(input, gain, rate));
    chip.start()?;
    _ = black_box(chip.read_share());
    let divider = Divider {
        fixed_ohm: black_box(10_000.0),
    };
    let thermistor = Thermistor::from_beta(black_box(10_000.0), black_box(3977.0));
    let temp_c = chip.read_thermistor(&divider, &thermistor);
    _ = black_box(chip.release());
    temp_c
}

#[inline(never)]
fn tmp117() -> Result<f32, SensorFault> {
    let mut chip = Tmp117::new(Bus, black_box(0x48));
    chip.start()?;
    chip.read()
}

#[inline(never)]
fn icm42688() -> Result<u16, ChipFault> {
    let settings = Settings {
        range: black_box(Range::Dps250),
        rate: black_box(OutputRate::Hz2000),
        filter: black_box(AntiAlias::Hz536),
        block: black_box(1),
    };
    let mut chip = Icm42688::new(Bus, settings);
    chip.reset()?;
    _ = black_box(chip.configure());
    _ = black_box(chip.check());
    let burst = chip.read(|counts| _ = black_box(counts))?;
    _ = black_box((
        settings.range.deg_per_s(),
        chip.is_settled(),
        chip.release(),
    ));
    Ok(burst.lost)
}

#[inline(never)]
fn chip_select() -> Result<(), digital::ErrorKind> {
    let mut select = ChipSelect::new(Bus, Bus, black_box(Max31865::<Bus>::SELECT_NS));
    select.set_low()?;
    select.set_high()
}

struct Bus;

/// What comes over a bus is anybody's guess.
fn answer(bytes: &mut [u8]) {
    bytes.iter_mut().for_each(|byte| *byte = black_box(0x5a));
}

impl DelayNs for Bus {
    fn delay_ns(&mut self, ns: u32) {
        _ = black_box(ns);
    }
}

impl digital::ErrorType for Bus {
    type Error = digital::ErrorKind;
}

impl OutputPin for Bus {
    fn set_low(&mut self) -> Result<(), digital::ErrorKind> {
        black_box(Ok(()))
    }

    fn set_high(&mut self) -> Result<(), digital::ErrorKind> {
        black_box(Ok(()))
    }
}

impl spi::ErrorType for Bus {
    type Error = spi::ErrorKind;
}

impl spi::SpiDevice for Bus {
    fn transaction(
        &mut self,
        operations: &mut [spi::Operation<'_, u8>],
    ) -> Result<(), spi::ErrorKind> {
        for operation in operations {
            match operation {
                spi::Operation::Read(bytes) => answer(bytes),
                other => _ = black_box(other),
            }
        }
        black_box(Ok(()))
    }
}

impl i2c::ErrorType for Bus {
    type Error = i2c::ErrorKind;
}

impl i2c::I2c for Bus {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [i2c::Operation<'_>],
    ) -> Result<(), i2c::ErrorKind> {
        _ = black_box(address);
        for operation in operations {
            match operation {
                i2c::Operation::Read(bytes) => answer(bytes),
                other => _ = black_box(other),
            }
        }
        black_box(Ok(()))
    }
}
