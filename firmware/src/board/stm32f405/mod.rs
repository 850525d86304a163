//! STM32F405RG, a Cortex-M4F with 1 MiB of flash and 128 KiB of RAM, at 168 MHz.
//!
//! A unit of its own: three quadrature counters read the gyro, three MAX31865 the temperatures,
//! USART1 is the link, USART6 sends every sample on, and the program's flash holds the tables.
//! Wiring, memory and how to flash it are in `docs/board-stm32f405.md`. Set up by the HAL
//! `stm32f4xx-hal`, one module per device:
//!
//! - `clocks`: 168 MHz from the crystal, from the internal oscillator where that does not start
//! - `link`: USART1 with a receive interrupt
//! - `free_running`: timer 7, by which missed samples are counted
//! - `flash`, [`store`]: six sectors for tables and logs
//! - `gyro`: counters and the data-ready pin; or with the feature `gyro-icm42688` `imu`: an
//!   ICM-42688-P on SPI2
//! - `output`, [`frame`]: every sample to USART6 by DMA
//! - `sensors`, [`sensor`]: platinum resistors on SPI1
//! - `wait`: waits of microseconds and less
//! - `watchdog`: the independent watchdog
//! - [`reset`]: why the chip started
//!
//! # When the flash is erased
//! The chip has one bank of flash. While a sector is erased nothing can be fetched from it, so the
//! processor stands still, interrupts and all: 2 s typically, 4 s at most, with the parallelism of
//! 8 bits that the HAL uses. There are no samples for so long. Hence these rules:
//!
//! - A table is loaded, and the fault log turned, only where the unit may be without output. That is
//!   the application's to decide; nothing here can.
//! - The watchdog is fed before every sector, and its timeout is longer than an erasure at the
//!   fastest it can run. `watchdog` raises shorter ones.
//! - The counters count on, so no angle is lost, as long as none moves by more than its half:
//!   32767 counts on axis z, which has 16 bits.
//! - Bytes from the host are lost, and counted as overruns; the link's protocol repeats.
//!
//! Programming goes byte by byte, each of which stops the processor for 16 us, at most 100 us. Samples
//! come late by as much, and none is lost.
//!
//! # In QEMU
//! Machine `netduinoplus2` has USART, SPI and flash, timers that count time instead of pulses, and
//! neither clock control, pins, DMA, watchdog nor a way to program its flash. All of it is set up
//! as on silicon and nothing waits for what is not there: `clocks` finds that there is no clock
//! control, frames of the output never end, and sensors report [`SensorFault::Bus`].
//!
//! [`SensorFault::Bus`]: tempco_sensors::SensorFault::Bus

pub mod frame;
pub mod reset;
pub mod sensor;
pub mod store;

#[cfg(all(target_os = "none", feature = "board-stm32f405"))]
mod clocks;
#[cfg(all(target_os = "none", feature = "board-stm32f405"))]
mod flash;
#[cfg(all(target_os = "none", feature = "board-stm32f405"))]
mod free_running;
#[cfg(all(
    target_os = "none",
    feature = "board-stm32f405",
    not(feature = "gyro-icm42688")
))]
mod gyro;
#[cfg(all(
    target_os = "none",
    feature = "board-stm32f405",
    feature = "gyro-icm42688"
))]
mod imu;
#[cfg(all(target_os = "none", feature = "board-stm32f405"))]
mod link;
#[cfg(all(target_os = "none", feature = "board-stm32f405"))]
mod output;
#[cfg(all(target_os = "none", feature = "board-stm32f405"))]
mod sensors;
#[cfg(all(target_os = "none", feature = "board-stm32f405"))]
mod take;
#[cfg(all(target_os = "none", feature = "board-stm32f405"))]
mod wait;
#[cfg(all(target_os = "none", feature = "board-stm32f405"))]
mod watchdog;

#[cfg(all(target_os = "none", feature = "board-stm32f405"))]
pub use {
    clocks::Source,
    cortex_m::asm::wfi as idle,
    flash::Sectors,
    free_running::{FREE_RUNNING_HZ, FREE_RUNNING_MAX, free_running},
    link::{Errors, Usart},
    sensors::Sensors,
    take::{BoardFlash, BoardGyro, Stm32f405, set_up, take},
    watchdog::IndependentWatchdog,
};

pub use store::REGIONS;

use super::Board;

/// The board.
pub const BOARD: Board = Board {
    name: "stm32f405",
    systick_hz: 168_000_000,
};

/// Axes that can be wired to it.
pub const AXES: usize = 3;

/// Temperature sensors that can be wired to it.
pub const SENSORS: usize = 3;
