//! Sends frames on USART6 without the processor.

use stm32f4xx_hal::dma::config::DmaConfig;
use stm32f4xx_hal::dma::{DMAError, MemoryToPeripheral, Stream6, StreamsTuple, Transfer};
use stm32f4xx_hal::gpio::PC6;
use stm32f4xx_hal::pac::{DMA2, USART6};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Config, Tx, config};

use super::frame;

const BAUD: u32 = 921_600;

type Buffer = &'static mut [u8; frame::LEN];

/// The transmitter.
pub(super) struct Output {
    transfer: Transfer<Stream6<DMA2>, 5, Tx<USART6>, MemoryToPeripheral, Buffer>,
    /// The buffer that is not being sent.
    spare: Option<Buffer>,
    is_sending: bool,
}

impl Output {
    /// `None` where it was made before, or the clock is too slow for it.
    pub(super) fn new(usart: USART6, pin: PC6, dma: DMA2, rcc: &mut Rcc) -> Option<Self> {
        let config = Config::default()
            .baudrate(BAUD.bps())
            .dma(config::DmaConfig::Tx);
        let tx = usart.tx(pin, config, rcc).ok()?;
        let first = cortex_m::singleton!(: [u8; frame::LEN] = [0; frame::LEN])?;
        let spare = cortex_m::singleton!(: [u8; frame::LEN] = [0; frame::LEN])?;
        let transfer = Transfer::init_memory_to_peripheral(
            StreamsTuple::new(dma, rcc).6,
            tx,
            first,
            None,
            DmaConfig::default().memory_increment(true),
        );
        Some(Self {
            transfer,
            spare: Some(spare),
            is_sending: false,
        })
    }

    /// Begins to send a frame, unless the last one is still on its way; then it is left out.
    pub(super) fn send(&mut self, frame: [u8; frame::LEN]) {
        let flags = self.transfer.flags();
        if self.is_sending && !flags.is_transfer_complete() && !flags.is_transfer_error() {
            return;
        }
        // The chip starts no transfer while there is a flag of the last one.
        self.transfer.clear_all_flags();
        let Some(buffer) = self.spare.take() else {
            return;
        };
        *buffer = frame;
        // Either way one of the two comes back.
        self.spare = Some(match self.transfer.next_transfer(buffer) {
            Ok((sent, _)) => {
                self.is_sending = true;
                sent
            }
            Err(
                DMAError::NotReady(kept) | DMAError::SmallBuffer(kept) | DMAError::Overrun(kept),
            ) => kept,
        });
    }
}
