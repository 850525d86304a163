//! A simulated ICM-42688-P in place of the bench's gyro: the feature `gyro-simulated`.
//!
//! The chip is a model in this image, behind the same driver, reader and interrupts as a real one.
//! Its clock is off by 2 %, twice what the data sheet allows: fast at 2 kHz, slow at 8 kHz, where
//! it is read in blocks of four. Timer 0 is its data-ready line.

use core::cell::Cell;
use core::convert::Infallible;
use core::sync::atomic::Ordering;

use critical_section::Mutex;
use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use tempco::Status;
use tempco_sensors::icm42688::simulated::Simulated;
use tempco_sensors::icm42688::{AntiAlias, OutputRate, Range, Settings};

use super::bench::BenchGyro;
use super::interrupts::{Interrupt, interrupt};
use super::registers;
use crate::fifo_gyro::{self, Channel, INVALID_COUNT, Reader, Samples};
use crate::unit::devices::{AtRest, Clock, Count, Gyro, Lost};

const RATE_IS_8_KHZ: bool = cfg!(feature = "rate-8khz");

const SETTINGS: Settings = Settings {
    range: Range::Dps250,
    rate: if RATE_IS_8_KHZ {
        OutputRate::Hz8000
    } else {
        OutputRate::Hz2000
    },
    filter: AntiAlias::Hz997,
    block: if RATE_IS_8_KHZ { 4 } else { 1 },
};

const ERROR_PPM: i32 = if RATE_IS_8_KHZ { -20_000 } else { 20_000 };

/// Counts of timer 1 per millisecond.
const COUNTS_PER_MS: u32 = 25_000;

/// What the axes show: their means are 100.5, -200 and 300 counts.
fn sample(number: u32) -> [i16; 3] {
    [100 + (number & 1) as i16, -200, 300]
}

type ChipReader = Reader<'static, Timed>;

/// The chip, with notes of its samples and of the counts of timer 1 that the model of it takes: these
/// are no cost of a unit.
struct Timed(Simulated<fn() -> u32>);

impl ErrorType for Timed {
    type Error = Infallible;
}

impl SpiDevice for Timed {
    fn transaction(&mut self, steps: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        let start = registers::timer_counts();
        let result = self.0.transaction(steps);
        let took = registers::timer_counts().wrapping_sub(start);
        let [samples, counts] = registers::notes();
        samples.store(self.0.samples(), Ordering::Relaxed);
        counts.fetch_add(took, Ordering::Relaxed);
        result
    }
}

/// From the set-up to the interrupt.
static READER: Mutex<Cell<Option<ChipReader>>> = Mutex::new(Cell::new(None));

/// The chip's samples, as the sampling sees them, and the output of the bench's gyro.
pub struct Imu {
    samples: Samples<'static>,
    output: BenchGyro,
}

impl Imu {
    /// Starts the chip and its line; the interrupt is to be unmasked. Once.
    pub(super) fn start() -> Option<Self> {
        let channel = cortex_m::singleton!(: Channel = Channel::new())?;
        let chip = Simulated::new(
            registers::timer_counts as fn() -> u32,
            COUNTS_PER_MS,
            ERROR_PPM,
            sample,
        );
        let period = chip.period_at(SETTINGS.rate.hz());
        let (mut reader, samples) = channel.split(Timed(chip), SETTINGS);
        reader.start(&mut Timer1);
        critical_section::with(|cs| READER.borrow(cs).set(Some(reader)));
        registers::start_data_ready(period * u32::from(SETTINGS.block));
        Some(Self {
            samples,
            output: BenchGyro::new(),
        })
    }
}

impl<const C: usize, const A: usize> Gyro<C, A> for Imu {
    const CLOCK: Clock = fifo_gyro::clock(&SETTINGS);
    const COUNTS: [[Count; A]; C] = [[Count::Rate(SETTINGS.range.deg_per_s()); A]; C];
    const INVALID: Option<i32> = Some(INVALID_COUNT);
    const AT_REST: AtRest = AtRest {
        sigma: 1.0,
        max_bias: 1000.0,
    };
    const MAX_TABLE_BIAS: f32 = 1000.0;

    fn sample(&mut self) -> Option<[[i32; A]; C]> {
        self.samples.take()
    }

    fn lost(&mut self) -> Lost {
        self.samples.lost()
    }

    fn look(&mut self) {
        cortex_m::peripheral::NVIC::pend(Interrupt::TIMER0);
    }

    fn put(&mut self, compensated: &[[f32; A]; C], status: &[Status; C]) {
        self.output.put(compensated, status);
    }
}

#[interrupt]
fn TIMER0() {
    static mut OWN: Option<ChipReader> = None;
    if OWN.is_none() {
        *OWN = critical_section::with(|cs| READER.borrow(cs).take());
    }
    let Some(reader) = OWN else { return };
    if registers::take_data_ready() {
        reader.ready();
    } else {
        reader.look();
    }
    cortex_m::peripheral::SCB::set_pendst();
}

/// Waits by timer 1.
struct Timer1;

impl DelayNs for Timer1 {
    fn delay_ns(&mut self, ns: u32) {
        let counts = (ns / 1000).saturating_mul(COUNTS_PER_MS / 1000);
        let start = registers::timer_counts();
        while registers::timer_counts().wrapping_sub(start) < counts {}
    }
}
