//! The link: USART1, 921600 baud, 8 data bits, no parity, one stop bit.
//!
//! A replay at the pace of the gyro gives 2000 outcomes of 36 bytes a second, 72 kbyte/s: 115200 baud
//! carry 11, 921600 baud 92, which every usual USB adapter knows and 84 MHz make to 0.2 %.
//!
//! The USART holds one byte, and the next comes 11 us later. So its interrupt has the highest
//! priority, the sampling interrupt included, and does nothing but fill a queue.

use core::cell::RefCell;
use core::convert::Infallible;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::interrupt::{self as critical, Mutex};
use cortex_m::peripheral::NVIC;
use embedded_io::{ErrorType, Read, ReadReady, Write};
use stm32f4xx_hal::block;
use stm32f4xx_hal::gpio::{PA9, PA10};
use stm32f4xx_hal::nb;
use stm32f4xx_hal::pac::{Interrupt, USART1, interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Config, Error, Rx, Serial, Tx};

use crate::queue::{Consumer, Producer, Queue};

const BAUD: u32 = 921_600;

/// Room for the bytes that come while the main loop is busy: 11 ms of a line that is never idle.
const QUEUE: usize = 1024;

/// Bytes that were lost, by reason, since power-on. They wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, defmt::Format)]
pub struct Errors {
    /// No stop bit, or the line was not at one level for the middle of a bit.
    pub line: u32,
    /// The interrupt came too late.
    pub overrun: u32,
    /// The main loop came too late.
    pub full: u32,
}

static LINE: AtomicU32 = AtomicU32::new(0);
static OVERRUN: AtomicU32 = AtomicU32::new(0);
static FULL: AtomicU32 = AtomicU32::new(0);

/// What the interrupt works with, on its way there.
static RECEIVER: Mutex<RefCell<Option<Receiver>>> = Mutex::new(RefCell::new(None));

struct Receiver {
    rx: Rx<USART1>,
    queue: Producer<'static, u8, QUEUE>,
}

/// The main loop's end of the link.
pub struct Usart {
    tx: Tx<USART1>,
    queue: Consumer<'static, u8, QUEUE>,
}

impl Usart {
    /// `None` where it was made before, or the clock is too slow for it.
    pub(super) fn new(usart: USART1, tx: PA9, rx: PA10, rcc: &mut Rcc) -> Option<Self> {
        let config = Config::default().baudrate(BAUD.bps());
        let (tx, mut rx) = Serial::new(usart, (tx, rx), config, rcc).ok()?.split();
        let queue = cortex_m::singleton!(: Queue<u8, QUEUE> = Queue::new())?;
        let (producer, consumer) = queue.split();
        rx.listen();
        let receiver = Receiver {
            rx,
            queue: producer,
        };
        critical::free(|cs| RECEIVER.borrow(cs).replace(Some(receiver)));
        // SAFETY: the handler is below, has what it needs, and breaks no critical section: it is
        // masked by them as any other.
        #[allow(unsafe_code)]
        unsafe {
            NVIC::unmask(Interrupt::USART1);
        }
        Some(Self {
            tx,
            queue: consumer,
        })
    }

    /// Bytes that were lost.
    pub fn errors(&self) -> Errors {
        Errors {
            line: LINE.load(Ordering::Relaxed),
            overrun: OVERRUN.load(Ordering::Relaxed),
            full: FULL.load(Ordering::Relaxed),
        }
    }
}

#[interrupt]
fn USART1() {
    static mut MINE: Option<Receiver> = None;

    if MINE.is_none() {
        *MINE = critical::free(|cs| RECEIVER.borrow(cs).take());
    }
    let Some(Receiver { rx, queue }) = MINE else {
        return;
    };
    match rx.read() {
        Ok(byte) => {
            if queue.enqueue(byte).is_err() {
                count(&FULL);
            }
        }
        Err(nb::Error::Other(Error::Overrun)) => count(&OVERRUN),
        Err(nb::Error::Other(_)) => count(&LINE),
        Err(nb::Error::WouldBlock) => {}
    }
}

/// Load and store suffice: there is one writer.
fn count(errors: &AtomicU32) {
    errors.store(
        errors.load(Ordering::Relaxed).wrapping_add(1),
        Ordering::Relaxed,
    );
}

impl ErrorType for Usart {
    type Error = Infallible;
}

impl Read for Usart {
    /// Takes what has come, be it nothing, and does not wait.
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let mut count = 0;
        for (byte, received) in bytes
            .iter_mut()
            .zip(core::iter::from_fn(|| self.queue.dequeue()))
        {
            *byte = received;
            count += 1;
        }
        Ok(count)
    }
}

impl ReadReady for Usart {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(self.queue.ready())
    }
}

impl Write for Usart {
    /// Waits for the line: 11 us per byte.
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for byte in bytes {
            // A transmitter has no errors.
            _ = block!(self.tx.write(*byte));
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        _ = block!(self.tx.flush());
        Ok(())
    }
}
