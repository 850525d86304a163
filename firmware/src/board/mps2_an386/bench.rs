//! The test bench on UART1, in place of sensors and gyro.
//!
//! A message is 8 bytes: `0xa5`, a letter, a number, `0`, and 4 bytes of a value, low byte first.
//!
//! | letter | number | value |
//! |---|---|---|
//! | `T` | channel | its temperature from now on, `f32`, with noise of the lowest bit \[degC\] |
//! | `C` | channel | the same without noise, as of a sensor that is stuck |
//! | `E` | channel | its fault from now on: 0 bus, 1 open, 2 short, 3 rail, 4 not ready |
//! | `G` | axis | its counts per sample from now on, `i32` |
//! | `S` | 0 | stops the main loop, as a defect would |

use core::sync::atomic::{AtomicI32, Ordering};

use embedded_io::Read as _;
use tempco::Status;
use tempco_sensors::SensorFault;

use super::played;
use super::uart::Uart;
use crate::unit::devices::{AtRest, Count, Gyro, Thermometers};

const BEGIN: u8 = 0xa5;
const MAX: usize = 6;

/// Counts per sample of each axis.
static COUNTS: [AtomicI32; MAX] = [const { AtomicI32::new(0) }; MAX];

/// The sensors.
pub struct BenchThermometers {
    line: Uart,
    message: heapless::Vec<u8, 8>,
    readings: [Result<f32, SensorFault>; MAX],
    /// Bits that change from reading to reading.
    noise: [u32; MAX],
}

impl BenchThermometers {
    pub(super) fn new(line: Uart) -> Self {
        Self {
            line,
            message: heapless::Vec::new(),
            readings: [Ok(25.0); MAX],
            noise: [1; MAX],
        }
    }

    fn receive(&mut self, byte: u8) {
        if self.message.is_empty() && byte != BEGIN {
            return;
        }
        // Cannot fail: it is emptied when full.
        _ = self.message.push(byte);
        let Ok(message) = self.message.clone().into_array::<8>() else {
            return;
        };
        self.message.clear();
        let [_, letter, number, _, value @ ..] = message;
        let code = u32::from_le_bytes(value);
        let number = usize::from(number);
        match (letter, self.readings.get_mut(number)) {
            (b'T' | b'C', Some(reading)) => {
                *reading = Ok(f32::from_bits(code));
                if let Some(noise) = self.noise.get_mut(number) {
                    *noise = u32::from(letter == b'T');
                }
            }
            (b'E', Some(reading)) => {
                *reading = Err(match code {
                    1 => SensorFault::Open,
                    2 => SensorFault::Short,
                    3 => SensorFault::Rail,
                    4 => SensorFault::NotReady,
                    _ => SensorFault::Bus,
                });
            }
            (b'G', _) => {
                if let Some(counts) = COUNTS.get(number) {
                    counts.store(code as i32, Ordering::Relaxed);
                }
            }
            (b'S', _) => loop {
                cortex_m::asm::nop();
            },
            _ => {}
        }
    }
}

impl<const C: usize> Thermometers<C> for BenchThermometers {
    /// Ten seconds.
    const STUCK_AFTER: Option<u32> = Some(100);

    fn read(&mut self) -> [Result<f32, SensorFault>; C] {
        let mut bytes = [0; 64];
        while let Ok(count @ 1..) = self.line.read(&mut bytes) {
            for byte in bytes.iter().take(count) {
                self.receive(*byte);
            }
        }
        for (reading, noise) in self.readings.iter_mut().zip(self.noise) {
            *reading = reading.map(|temp_c| f32::from_bits(temp_c.to_bits() ^ noise));
        }
        core::array::from_fn(|channel| {
            self.readings
                .get(channel)
                .copied()
                .unwrap_or(Err(SensorFault::Bus))
        })
    }
}

/// The gyro.
pub struct BenchGyro(());

impl BenchGyro {
    pub(super) const fn new() -> Self {
        Self(())
    }
}

impl<const C: usize, const A: usize> Gyro<C, A> for BenchGyro {
    const COUNTS: [[Count; A]; C] = [[Count::Pulses(1.0); A]; C];
    const SCALE_FACTOR_ARCSEC: f32 = 1.0;
    const AT_REST: AtRest = played::AT_REST;
    const MAX_TABLE_BIAS: f32 = played::MAX_TABLE_BIAS;

    fn sample(&mut self) -> Option<[[i32; A]; C]> {
        let mut counts = COUNTS.iter().map(|counts| counts.load(Ordering::Relaxed));
        let each = |_| core::array::from_fn(|_| counts.next().unwrap_or(0));
        Some(core::array::from_fn(each))
    }

    fn put(&mut self, compensated: &[[f32; A]; C], status: &[Status; C]) {
        played::put(compensated, status);
    }
}
