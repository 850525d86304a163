//! The gyro: an ICM-42688-P on SPI2, in place of the counters. Feature `gyro-icm42688`.
//!
//! INT1 of the chip interrupts with every sample, at a priority below the sampling. The interrupt reads
//! the sample, which is 21 bytes on the bus and takes 16 us of them, and then lets the sampling
//! interrupt come.

use core::cell::RefCell;

use cortex_m::interrupt::{self as critical, Mutex};
use cortex_m::peripheral::{NVIC, SCB};
use embedded_hal_bus::spi::ExclusiveDevice;
use stm32f4xx_hal::gpio::{
    Edge, Input, Output, PB1, PB12, PB13, PB14, PB15, PC8, PinState, PushPull, Speed,
};
use stm32f4xx_hal::hal::spi::MODE_3;
use stm32f4xx_hal::pac::{EXTI, Interrupt, SPI2, SYSCFG, interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::spi::Spi;
use tempco::Status;
use tempco_sensors::ChipSelect;
use tempco_sensors::icm42688::{AntiAlias, Icm42688, OutputRate, Range, Settings};

use super::wait::Cycles;
use super::{frame, output};
use crate::fifo_gyro::{self, Channel, INVALID_COUNT, Reader, Samples};
use crate::unit::devices::{AtRest, Clock, Count, Gyro, Lost};

const SETTINGS: Settings = Settings {
    range: Range::Dps250,
    rate: OutputRate::Hz2000,
    filter: AntiAlias::Hz536,
    block: 1,
};

/// Of 16 levels of priority, one below the sampling.
const PRIORITY: u8 = 2 << 4;

type Device = ExclusiveDevice<Spi<SPI2>, ChipSelect<PB12<Output<PushPull>>, Cycles>, Cycles>;

/// What the interrupt works with.
struct Line {
    reader: Reader<'static, Device>,
    pin: PB1<Input>,
}

/// On its way to the interrupt.
static LINE: Mutex<RefCell<Option<Line>>> = Mutex::new(RefCell::new(None));

/// What the chip is wired to.
pub(super) struct Parts {
    pub(super) spi: SPI2,
    pub(super) clock: PB13,
    pub(super) input: PB14,
    pub(super) output: PB15,
    pub(super) select: PB12,
    pub(super) ready: PB1,
    pub(super) exti: EXTI,
    pub(super) syscfg: SYSCFG,
}

/// The chip's samples, and what they become.
pub struct Imu {
    samples: Samples<'static>,
    /// High from the moment a sample is handed out until its frame is on its way.
    data_ready: PC8<Output<PushPull>>,
    output: output::Output,
    number: u16,
}

impl Imu {
    /// Starts the chip, which takes 64 ms; a chip that does not answer is looked for again and again.
    /// `None` where it was made before.
    pub(super) fn new(
        parts: Parts,
        data_ready: PC8,
        output: output::Output,
        nvic: &mut NVIC,
        rcc: &mut Rcc,
    ) -> Option<Self> {
        let mut pin = parts.ready.into_input();
        let mut exti = parts.exti;
        pin.make_interrupt_source(&mut parts.syscfg.constrain(rcc));
        pin.trigger_on_edge(&mut exti, Edge::Rising);
        pin.enable_interrupt(&mut exti);

        let pins = (
            Some(parts.clock.into_alternate().speed(Speed::High)),
            Some(parts.input.into_alternate()),
            Some(parts.output.into_alternate().speed(Speed::High)),
        );
        // The bus is clocked by 42 MHz: a quarter of them.
        let spi = Spi::new(parts.spi, pins, MODE_3, 10_500.kHz(), rcc);
        let select = parts.select.into_push_pull_output_in_state(PinState::High);
        let select = ChipSelect::new(select, Cycles, Icm42688::<Device>::SELECT_NS);
        let Ok(device) = ExclusiveDevice::new(spi, select, Cycles);

        let channel = cortex_m::singleton!(: Channel = Channel::new())?;
        let (mut reader, samples) = channel.split(device, SETTINGS);
        reader.start(&mut Cycles);
        critical::free(|cs| LINE.borrow(cs).replace(Some(Line { reader, pin })));
        // SAFETY: the handler is below, has what it needs, and no critical section depends on
        // priorities.
        #[allow(unsafe_code)]
        unsafe {
            nvic.set_priority(Interrupt::EXTI1, PRIORITY);
            NVIC::unmask(Interrupt::EXTI1);
        }
        Some(Self {
            samples,
            data_ready: data_ready.into_push_pull_output(),
            output,
            number: 0,
        })
    }
}

impl<const C: usize, const A: usize> Gyro<C, A> for Imu {
    const CLOCK: Clock = fifo_gyro::clock(&SETTINGS);

    const COUNTS: [[Count; A]; C] = [[Count::Rate(SETTINGS.range.deg_per_s()); A]; C];

    const INVALID: Option<i32> = Some(INVALID_COUNT);

    /// The noise of the data sheet, 0.0028 deg/s per root of Hz, is 0.006 deg/s in means over 0.1 s;
    /// here ten times as much. Of constant bias 1 deg/s, twice what the data sheet states.
    const AT_REST: AtRest = AtRest {
        sigma: 8.0,
        max_bias: 131.0,
    };

    /// 5 deg/s.
    const MAX_TABLE_BIAS: f32 = 655.0;

    fn sample(&mut self) -> Option<[[i32; A]; C]> {
        let counts = self.samples.take()?;
        self.data_ready.set_high();
        Some(counts)
    }

    fn lost(&mut self) -> Lost {
        self.samples.lost()
    }

    fn look(&mut self) {
        NVIC::pend(Interrupt::EXTI1);
    }

    fn put(&mut self, compensated: &[[f32; A]; C], status: &[Status; C]) {
        self.output
            .send(frame::encode(self.number, compensated, status));
        self.number = self.number.wrapping_add(1);
        self.data_ready.set_low();
    }
}

#[interrupt]
fn EXTI1() {
    static mut OWN: Option<Line> = None;

    if OWN.is_none() {
        *OWN = critical::free(|cs| LINE.borrow(cs).take());
    }
    let Some(Line { reader, pin }) = OWN else {
        return;
    };
    if pin.check_interrupt() {
        pin.clear_interrupt_pending_bit();
        reader.ready();
    } else {
        reader.look();
    }
    SCB::set_pendst();
}
