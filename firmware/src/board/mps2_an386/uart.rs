//! The CMSDK APB UART, received by interrupt.

use core::cell::Cell;
use core::convert::Infallible;

use critical_section::Mutex;
use embedded_io::{ErrorType, Read, ReadReady, Write};

use super::interrupts::interrupt;
use super::registers::{self, UartRegisters};
use crate::queue::{Consumer, Producer, Queue};

/// Bytes that may wait for the main loop: 5 ms at 921600 baud.
const RECEIVED: usize = 512;

const BAUD: u32 = 921_600;

/// Clock of the peripherals \[Hz\].
const CLOCK_HZ: u32 = 25_000_000;

const TX_FULL: u32 = 1;
const RX_FULL: u32 = 2;
const TX_ENABLE: u32 = 1;
const RX_ENABLE: u32 = 2;
const RX_INTERRUPT: u32 = 8;
const RX_INTERRUPT_CLEAR: u32 = 2;

/// A UART, as the main loop sees it.
pub struct Uart {
    registers: &'static UartRegisters,
    received: Consumer<'static, u8, RECEIVED>,
}

/// The receiving side, in its interrupt.
struct Receiver {
    /// A function, since a reference to registers cannot be handed to an interrupt.
    registers: fn() -> &'static UartRegisters,
    received: Producer<'static, u8, RECEIVED>,
}

type Slot = Mutex<Cell<Option<Receiver>>>;

/// From the set-up to the interrupts.
static RECEIVERS: [Slot; 2] = [const { Mutex::new(Cell::new(None)) }; 2];

impl Uart {
    /// UART0, the link. Once.
    pub fn link() -> Option<Self> {
        let queue = cortex_m::singleton!(: Queue<u8, RECEIVED> = Queue::new())?;
        Some(Self::new(0, registers::uart0, queue))
    }

    /// UART1, the test bench. Once.
    pub fn bench() -> Option<Self> {
        let queue = cortex_m::singleton!(: Queue<u8, RECEIVED> = Queue::new())?;
        Some(Self::new(1, registers::uart1, queue))
    }

    fn new(
        number: usize,
        at: fn() -> &'static UartRegisters,
        queue: &'static mut Queue<u8, RECEIVED>,
    ) -> Self {
        let (producer, consumer) = queue.split();
        let registers = at();
        let receiver = Receiver {
            registers: at,
            received: producer,
        };
        critical_section::with(|cs| {
            if let Some(slot) = RECEIVERS.get(number) {
                slot.borrow(cs).set(Some(receiver));
            }
        });
        // SAFETY: writing these registers has no effect on memory; the module owns the device.
        #[allow(unsafe_code)]
        unsafe {
            registers.baud_divider.write(CLOCK_HZ / BAUD);
            registers
                .control
                .write(TX_ENABLE | RX_ENABLE | RX_INTERRUPT);
        }
        Self {
            registers,
            received: consumer,
        }
    }
}

impl Receiver {
    fn interrupt(&mut self) {
        let registers = (self.registers)();
        // SAFETY: as above.
        #[allow(unsafe_code)]
        unsafe {
            registers.interrupt.write(RX_INTERRUPT_CLEAR);
        }
        while registers.state.read() & RX_FULL != 0 {
            // A byte that finds no place is lost, and its frame with it, which the link sees.
            _ = self.received.enqueue(registers.data.read() as u8);
        }
    }
}

fn take(number: usize) -> Option<Receiver> {
    critical_section::with(|cs| RECEIVERS.get(number)?.borrow(cs).take())
}

#[interrupt]
fn UARTRX0() {
    static mut RECEIVER: Option<Receiver> = None;
    if RECEIVER.is_none() {
        *RECEIVER = take(0);
    }
    if let Some(receiver) = RECEIVER {
        receiver.interrupt();
    }
}

#[interrupt]
fn UARTRX1() {
    static mut RECEIVER: Option<Receiver> = None;
    if RECEIVER.is_none() {
        *RECEIVER = take(1);
    }
    if let Some(receiver) = RECEIVER {
        receiver.interrupt();
    }
}

impl ErrorType for Uart {
    type Error = Infallible;
}

impl ReadReady for Uart {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(self.received.ready())
    }
}

impl Read for Uart {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let mut count = 0;
        for place in bytes {
            let Some(byte) = self.received.dequeue() else {
                break;
            };
            *place = byte;
            count += 1;
        }
        Ok(count)
    }
}

impl Write for Uart {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for byte in bytes {
            while self.registers.state.read() & TX_FULL != 0 {}
            // SAFETY: as above.
            #[allow(unsafe_code)]
            unsafe {
                self.registers.data.write(u32::from(*byte));
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        while self.registers.state.read() & TX_FULL != 0 {}
        Ok(())
    }
}
