//! Sets everything up.

use cortex_m::Peripherals;
use cortex_m::peripheral::scb::SystemHandler;
use stm32f4xx_hal::gpio::PinState;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::prelude::*;
use tempco_link::{Fault, FaultSet};

use super::clocks::{self, Source};
use super::flash::Sectors;
use super::free_running;
#[cfg(not(feature = "gyro-icm42688"))]
use super::gyro::{self, Counters};
#[cfg(feature = "gyro-icm42688")]
use super::imu::{self, Imu};
use super::link::Usart;
use super::output::Output;
use super::reset;
use super::sensors::Sensors;
use super::watchdog::{Feeder, IndependentWatchdog};
use crate::unit::devices::Devices;

/// Of 16 levels of priority, the one below the highest.
const SAMPLING: u8 = 1 << 4;

/// The gyro.
#[cfg(not(feature = "gyro-icm42688"))]
pub type BoardGyro = Counters;
/// The gyro.
#[cfg(feature = "gyro-icm42688")]
pub type BoardGyro = Imu;
/// The flash that holds the store.
pub type BoardFlash = Sectors;

/// What the board has.
pub struct Stm32f405 {
    /// What the main loop works with.
    pub devices: Devices<Usart, Sensors, IndependentWatchdog>,
    /// Where the store is.
    pub flash: Sectors,
    /// What the sampling interrupt works with.
    pub gyro: BoardGyro,
    /// Where the clock comes from.
    pub clock: Source,
}

/// Sets the board up for the application. Once.
pub fn take(
    core: &mut Peripherals,
) -> Option<(
    Devices<Usart, Sensors, IndependentWatchdog>,
    BoardFlash,
    BoardGyro,
)> {
    let board = set_up(core)?;
    Some((board.devices, board.flash, board.gyro))
}

/// Sets the board up; once, then `None`. The sampling interrupt is SysTick, and gets a priority
/// below the link's.
pub fn set_up(core: &mut Peripherals) -> Option<Stm32f405> {
    let chip = pac::Peripherals::take()?;
    let reset_cause = reset::cause(chip.RCC.csr().read().bits());
    chip.RCC.csr().modify(|_, w| w.rmvf().clear());
    let (mut rcc, clock) = clocks::start(chip.RCC);
    let rcc = &mut rcc;

    let a = chip.GPIOA.split(rcc);
    let b = chip.GPIOB.split(rcc);
    let c = chip.GPIOC.split(rcc);

    // SAFETY: no critical section depends on priorities.
    #[allow(unsafe_code)]
    unsafe {
        core.SCB.set_priority(SystemHandler::SysTick, SAMPLING);
    }

    free_running::start(chip.TIM7, rcc);
    let feeder = Feeder::new(chip.IWDG, &chip.DBGMCU)?;
    let selects = [
        a.pa4.into_push_pull_output_in_state(PinState::High).erase(),
        c.pc4.into_push_pull_output_in_state(PinState::High).erase(),
        c.pc5.into_push_pull_output_in_state(PinState::High).erase(),
    ];
    let output = Output::new(chip.USART6, c.pc6, chip.DMA2, rcc)?;
    #[cfg(not(feature = "gyro-icm42688"))]
    let gyro = {
        let parts = gyro::Parts {
            x: (
                chip.TIM2,
                a.pa15.into_floating_input(),
                b.pb3.into_floating_input(),
            ),
            y: (chip.TIM5, a.pa0, a.pa1),
            z: (chip.TIM4, b.pb6, b.pb7),
            data_ready: c.pc8,
            output,
        };
        Counters::new(parts, rcc)
    };
    #[cfg(feature = "gyro-icm42688")]
    let gyro = {
        let parts = imu::Parts {
            spi: chip.SPI2,
            clock: b.pb13,
            input: b.pb14,
            output: b.pb15,
            select: b.pb12,
            ready: b.pb1,
            exti: chip.EXTI,
            syscfg: chip.SYSCFG,
        };
        Imu::new(parts, c.pc8, output, &mut core.NVIC, rcc)?
    };
    Some(Stm32f405 {
        gyro,
        flash: Sectors::new(chip.FLASH, feeder),
        clock,
        devices: Devices {
            link: Usart::new(chip.USART1, a.pa9, a.pa10, rcc)?,
            thermometers: Sensors::new(chip.SPI1, (a.pa5, a.pa6, a.pa7), selects, rcc)?,
            watchdog: IndependentWatchdog::new(feeder),
            reset_cause,
            faults: match clock {
                Source::Internal => Fault::Clock.into(),
                Source::Crystal | Source::Fixed => FaultSet::NONE,
            },
        },
    })
}
