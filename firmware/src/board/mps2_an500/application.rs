//! The least that the application needs of a board, in one file.

use core::cell::RefCell;
use core::convert::Infallible;
use core::sync::atomic::AtomicU32;

use cortex_m::Peripherals;
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;
use critical_section::Mutex;
use embedded_io::{ErrorType, Read, ReadReady, Write};
use tempco::Status;
use tempco_link::FaultSet;
use tempco_sensors::SensorFault;

use crate::board::mps2_an386::nor::{self, Nor};
use crate::queue::{Consumer, Producer, Queue};
use crate::reset::{self, Reason};
use crate::unit::devices::{AtRest, Count, Devices, Gyro, ResetCause, Thermometers, Watchdog};

/// The gyro.
pub type BoardGyro = Counter;
/// The flash that holds the store; a stretch of RAM stands in for it.
pub type BoardFlash = Nor<'static>;
/// Where the store is in the flash.
pub use nor::REGIONS;

/// On a chip of its own this is `cortex_m::asm::wfi`.
pub use crate::idle::stay_awake as idle;

/// Rate of [`free_running`], a multiple of the sample rate \[Hz\].
pub const FREE_RUNNING_HZ: u32 = CLOCK_HZ;
/// Its largest value.
pub const FREE_RUNNING_MAX: u32 = u32::MAX;

/// A counter that nothing stops, sleep included.
pub fn free_running() -> u32 {
    // It counts down.
    u32::MAX - Register::FreeValue.read()
}

/// Clock of the peripherals \[Hz\].
const CLOCK_HZ: u32 = 25_000_000;
const BAUD: u32 = 921_600;

/// Sets the board up. Once.
pub fn take(
    core: &mut Peripherals,
) -> Option<(
    Devices<Line, Thermometer, BoardWatchdog>,
    BoardFlash,
    BoardGyro,
)> {
    Register::FreeReload.write(u32::MAX);
    Register::FreeValue.write(u32::MAX);
    Register::FreeControl.write(1);
    let devices = Devices {
        link: Line::start(core)?,
        thermometers: Thermometer,
        watchdog: BoardWatchdog,
        // The board does not say. The program remembers its own resets.
        reset_cause: ResetCause::PowerOn,
        faults: FaultSet::NONE,
    };
    Some((devices, Nor(flash()), Counter::start()))
}

/// The gyro: a timer counts its pulses. Here these are the clock's own.
pub struct Counter {
    before: u32,
}

impl Counter {
    fn start() -> Self {
        Register::TimerReload.write(u32::MAX);
        Register::TimerControl.write(1);
        Self {
            before: Register::TimerValue.read(),
        }
    }
}

impl<const C: usize, const A: usize> Gyro<C, A> for Counter {
    const COUNTS: [[Count; A]; C] = [[Count::Pulses(1.0); A]; C];
    const SCALE_FACTOR_ARCSEC: f32 = 1.0;
    const AT_REST: AtRest = AtRest {
        sigma: 10.0,
        max_bias: 100.0,
    };
    /// Logs of any gyro are replayed here.
    const MAX_TABLE_BIAS: f32 = 1e6;

    fn sample(&mut self) -> Option<[[i32; A]; C]> {
        let now = Register::TimerValue.read();
        // It counts down, and wraps; so does the difference.
        let counts = self.before.wrapping_sub(now).cast_signed();
        self.before = now;
        Some([[counts; A]; C])
    }

    /// The lamps of the board stand for the output.
    fn put(&mut self, _: &[[f32; A]; C], status: &[Status; C]) {
        let bits = status.iter().map(|status| u32::from(status.bits()));
        Register::Lamps.write(bits.fold(0, |all, bits| all | bits));
    }
}

/// A thermometer that always says the same, since the board has none.
pub struct Thermometer;

impl<const C: usize> Thermometers<C> for Thermometer {
    const STUCK_AFTER: Option<u32> = None;

    fn read(&mut self) -> [Result<f32, SensorFault>; C] {
        [Ok(25.0); C]
    }
}

/// Resets by a non-maskable interrupt.
pub struct BoardWatchdog;

impl Watchdog for BoardWatchdog {
    fn start(&mut self, timeout_ms: u32) {
        Register::WatchdogLoad.write(timeout_ms * (CLOCK_HZ / 1000));
        // Interrupt and reset; the reset would come a timeout later.
        Register::WatchdogControl.write(3);
    }

    fn feed(&mut self) {
        Register::WatchdogClear.write(1);
    }
}

// SAFETY: the handler writes atomics and resets the processor; it returns to nothing.
#[allow(unsafe_code)]
#[exception]
unsafe fn NonMaskableInt() -> ! {
    reset::because(Reason::Watchdog)
}

/// Bytes that may wait for the main loop: 5 ms at 921600 baud.
const WAITING: usize = 512;

/// From the interrupt to the main loop.
static RECEIVED: Mutex<RefCell<Option<Producer<'static, u8, WAITING>>>> =
    Mutex::new(RefCell::new(None));

/// The link: a UART that is received by interrupt.
pub struct Line(Consumer<'static, u8, WAITING>);

/// The UART's receive interrupt.
#[derive(Clone, Copy)]
struct ReceiveInterrupt;

// SAFETY: it is the number of one interrupt, and constant.
#[allow(unsafe_code)]
unsafe impl InterruptNumber for ReceiveInterrupt {
    fn number(self) -> u16 {
        0
    }
}

impl Line {
    fn start(core: &mut Peripherals) -> Option<Self> {
        let queue = cortex_m::singleton!(: Queue<u8, WAITING> = Queue::new())?;
        let (producer, consumer) = queue.split();
        critical_section::with(|cs| RECEIVED.replace(cs, Some(producer)));
        Register::UartDivider.write(CLOCK_HZ / BAUD);
        // Transmit, receive, receive interrupt.
        Register::UartControl.write(0b1011);
        // SAFETY: nothing relies on this interrupt's being masked, and no critical section on
        // priorities. The sampling interrupt keeps the highest, 0.
        #[allow(unsafe_code)]
        unsafe {
            core.NVIC.set_priority(ReceiveInterrupt, 0x80);
            NVIC::unmask(ReceiveInterrupt);
        }
        Some(Self(consumer))
    }
}

// SAFETY: the handler keeps to its own device and a queue behind a critical section. One interrupt
// is unmasked; with a peripheral access crate it would have a handler of its own by `#[interrupt]`.
#[allow(unsafe_code)]
#[exception]
unsafe fn DefaultHandler(_: i16) {
    Register::UartInterrupt.write(2);
    critical_section::with(|cs| {
        let mut producer = RECEIVED.borrow_ref_mut(cs);
        while Register::UartState.read() & 2 != 0 {
            let byte = Register::UartData.read() as u8;
            // A byte that finds no place is lost, and its frame with it, which the link sees.
            _ = producer.as_mut().map(|producer| producer.enqueue(byte));
        }
    });
}

impl ErrorType for Line {
    type Error = Infallible;
}

impl ReadReady for Line {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.ready())
    }
}

impl Read for Line {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let mut count = 0;
        while let Some(place) = bytes.get_mut(count)
            && let Some(byte) = self.0.dequeue()
        {
            *place = byte;
            count += 1;
        }
        Ok(count)
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for byte in bytes {
            self.flush()?;
            Register::UartData.write((*byte).into());
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        while Register::UartState.read() & 1 != 0 {}
        Ok(())
    }
}

/// The registers in use, by their addresses in Arm's Application Note AN500.
#[derive(Clone, Copy)]
enum Register {
    TimerControl = 0x4000_0000,
    TimerValue = 0x4000_0004,
    TimerReload = 0x4000_0008,
    FreeControl = 0x4000_1000,
    FreeValue = 0x4000_1004,
    FreeReload = 0x4000_1008,
    UartData = 0x4000_4000,
    UartState = 0x4000_4004,
    UartControl = 0x4000_4008,
    UartInterrupt = 0x4000_400c,
    UartDivider = 0x4000_4010,
    WatchdogLoad = 0x4000_8000,
    WatchdogControl = 0x4000_8008,
    WatchdogClear = 0x4000_800c,
    Lamps = 0x4002_8000,
}

impl Register {
    fn read(self) -> u32 {
        // SAFETY: the address is that of a register of 32 bits, mapped for ever.
        #[allow(unsafe_code)]
        unsafe {
            core::ptr::with_exposed_provenance::<u32>(self as usize).read_volatile()
        }
    }

    fn write(self, value: u32) {
        // SAFETY: as above; none of these devices writes to memory.
        #[allow(unsafe_code)]
        unsafe {
            core::ptr::with_exposed_provenance_mut::<u32>(self as usize).write_volatile(value);
        }
    }
}

fn flash() -> &'static [AtomicU32; nor::WORDS] {
    // SAFETY: the start of the PSRAM, which is RAM that the linker does not use; aligned, mapped
    // for ever, and any bits are an `AtomicU32`.
    #[allow(unsafe_code)]
    unsafe {
        &*core::ptr::with_exposed_provenance(0x6000_0000)
    }
}
