//! A chip without one, for tests on a host and for images that an emulator runs: registers, FIFO,
//! time stamps, and a clock that is as wrong as one likes.

use core::convert::Infallible;

use embedded_hal::spi::{ErrorType, Operation, SpiDevice};

use super::registers::{
    ALL_ON, DEVICE_CONFIG, FIFO_CONFIG, FIFO_CONFIG2, FIFO_CONFIG3, FIFO_DATA, FIFO_FLUSH,
    FIFO_FULL, GYRO_CONFIG0, HEADER, IDENTITY, INT_STATUS, PACKET, PWR_MGMT0, READ, REG_BANK_SEL,
    RESET_DONE, SIGNAL_PATH_RESET, SOFT_RESET, STOP_ON_FULL, WHO_AM_I,
};

/// Packets that the FIFO holds.
pub const DEPTH: usize = 128;

/// The chip. `T` is the time of what it is wired to, in counts that may wrap.
pub struct Simulated<T> {
    time: T,
    counts_per_ms: u32,
    error_ppm: i32,
    sample: fn(u32) -> [i16; 3],
    banks: [[u8; 128]; 2],
    bank: usize,
    status: u8,
    /// Sample numbers of the packets in the FIFO, oldest first.
    fifo: heapless::Deque<u32, DEPTH>,
    /// Time of the last sample, and the number of the next one.
    last: u32,
    number: u32,
    /// Until when a reset takes.
    ready: Option<u32>,
    /// Counts per sample; 0 while it does not measure.
    period: u32,
    /// It neither answers nor measures.
    pub is_away: bool,
    /// It measures nothing, although it is set up.
    pub is_stuck: bool,
    /// The next packet that is read has a wrong header.
    pub is_torn: bool,
    /// Bytes by which the count of the FIFO is wrong.
    pub excess: u8,
}

impl<T: FnMut() -> u32> Simulated<T> {
    /// A chip that was just switched on. Its clock is fast by `error_ppm`; sample number `n` of its
    /// gyros is `sample(n)`.
    pub const fn new(
        time: T,
        counts_per_ms: u32,
        error_ppm: i32,
        sample: fn(u32) -> [i16; 3],
    ) -> Self {
        Self {
            time,
            counts_per_ms,
            error_ppm,
            sample,
            banks: DELIVERED,
            bank: 0,
            status: RESET_DONE,
            fifo: heapless::Deque::new(),
            last: 0,
            number: 0,
            ready: None,
            period: 0,
            is_away: false,
            is_stuck: false,
            is_torn: false,
            excess: 0,
        }
    }

    /// Whether a block is ready, of which INT1 then says so with every sample.
    pub fn is_data_ready(&mut self) -> bool {
        self.advance();
        let block = [FIFO_CONFIG3, FIFO_CONFIG2].map(|register| self.register(register));
        self.period > 0 && self.fifo.len() * PACKET >= u16::from_be_bytes(block).into()
    }

    /// Counts of the time from one sample to the next at a rate of output; 0 where there is none.
    pub const fn period_at(&self, rate_hz: u16) -> u32 {
        let true_rate = rate_hz as u64 * (1_000_000 + self.error_ppm as i64) as u64;
        match (1_000_000_000 * self.counts_per_ms as u64).checked_div(true_rate) {
            Some(period) => period as u32,
            None => 0,
        }
    }

    /// Samples that were measured since power-on, the lost ones too.
    pub const fn samples(&self) -> u32 {
        self.number
    }

    /// A register of bank 0 takes another value by itself.
    pub fn upset(&mut self, address: u8, value: u8) {
        self.bank = 0;
        self.write(address, value);
    }

    /// The supply fails for a moment.
    pub fn restart(&mut self) {
        self.banks = DELIVERED;
        self.bank = 0;
        self.status = RESET_DONE;
        self.fifo.clear();
        self.ready = None;
        self.period = 0;
    }

    /// Lets samples be measured until now.
    fn advance(&mut self) {
        let now = (self.time)();
        if self.period == 0 || self.is_away || self.is_stuck {
            self.last = now;
            return;
        }
        while now.wrapping_sub(self.last) >= self.period {
            self.last = self.last.wrapping_add(self.period);
            _ = self.fifo.push_back(self.number);
            if self.fifo.is_full() {
                self.status |= FIFO_FULL;
            }
            self.number = self.number.wrapping_add(1);
        }
    }

    /// Whether a reset has ended.
    fn is_ready(&mut self) -> bool {
        let now = (self.time)();
        if let Some(ready) = self.ready
            && (now.wrapping_sub(ready) as i32) < 0
        {
            return false;
        }
        self.ready = None;
        true
    }

    fn register(&self, address: u8) -> u8 {
        let register = self.banks[0].get(usize::from(address));
        register.copied().unwrap_or(0)
    }

    fn write(&mut self, address: u8, value: u8) {
        match (self.bank, address) {
            (_, REG_BANK_SEL) => self.bank = usize::from(value & 1),
            (0, DEVICE_CONFIG) if value & SOFT_RESET != 0 => {
                self.restart();
                let now = (self.time)();
                self.ready = Some(now.wrapping_add(self.counts_per_ms));
            }
            (0, SIGNAL_PATH_RESET) if value & FIFO_FLUSH != 0 => self.fifo.clear(),
            (bank, _) => {
                let register = self.banks.get_mut(bank);
                if let Some(register) = register.and_then(|all| all.get_mut(usize::from(address))) {
                    *register = value;
                }
                self.switch();
            }
        }
    }

    /// Begins or ends to measure, as the registers say.
    fn switch(&mut self) {
        let is_on =
            self.register(PWR_MGMT0) == ALL_ON && self.register(FIFO_CONFIG) == STOP_ON_FULL;
        let rate_hz = 8000 >> (self.register(GYRO_CONFIG0) & 0x0f).saturating_sub(3);
        self.period = if is_on { self.period_at(rate_hz) } else { 0 };
        self.last = (self.time)();
    }

    /// Reads registers from an address on, or packets once it has come to them.
    fn read(&mut self, address: u8, bytes: &mut [u8]) {
        let mut address = address;
        let mut rest = bytes.iter_mut();
        while address != FIFO_DATA || self.bank != 0 {
            let Some(byte) = rest.next() else { return };
            *byte = self.read_register(address);
            address = address.wrapping_add(1);
        }
        for chunk in rest.into_slice().chunks_mut(PACKET) {
            let packet = match self.fifo.front() {
                Some(number) => self.packet(*number),
                None => [0xff; PACKET],
            };
            for (byte, value) in chunk.iter_mut().zip(packet) {
                *byte = value;
            }
            // What was read in part is read again.
            if chunk.len() == PACKET {
                _ = self.fifo.pop_front();
            }
        }
    }

    fn read_register(&mut self, address: u8) -> u8 {
        const COUNT_HIGH: u8 = INT_STATUS + 1;
        const COUNT_LOW: u8 = INT_STATUS + 2;
        let count = (self.fifo.len() * PACKET) as u16 + u16::from(self.excess);
        let [high, low] = count.to_be_bytes();
        match (self.bank, address) {
            (0, INT_STATUS) => core::mem::take(&mut self.status),
            (0, COUNT_HIGH) => high,
            (0, COUNT_LOW) => low,
            (0, WHO_AM_I) => IDENTITY,
            (0, _) => self.register(address),
            (_, _) => self.banks[1]
                .get(usize::from(address))
                .copied()
                .unwrap_or(0),
        }
    }

    fn packet(&mut self, number: u32) -> [u8; PACKET] {
        let [x, y, z] = (self.sample)(number).map(i16::to_be_bytes);
        // The stamps are of the same clock as the samples: 468.75 counts at 2 kHz.
        let step_16ths = 1875_u32 << (self.register(GYRO_CONFIG0) & 0x0f).saturating_sub(3);
        let counts = u64::from(number) * u64::from(step_16ths) / 16;
        let [t1, t0] = (counts as u16).to_be_bytes();
        let header = if core::mem::take(&mut self.is_torn) {
            !HEADER
        } else {
            HEADER
        };
        [
            header, 0, 0, 0, 0, 0x08, 0, x[0], x[1], y[0], y[1], z[0], z[1], 0, t1, t0,
        ]
    }
}

/// Registers as they are after power-on, as far as they are used: the settings that must be written
/// are others.
const DELIVERED: [[u8; 128]; 2] = [[0; 128]; 2];

impl<T> ErrorType for Simulated<T> {
    type Error = Infallible;
}

impl<T: FnMut() -> u32> SpiDevice for Simulated<T> {
    fn transaction(&mut self, steps: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        self.advance();
        let is_there = !self.is_away && self.is_ready();
        let mut address = 0;
        for step in steps {
            match step {
                Operation::Write([first, values @ ..]) => {
                    address = first & !READ;
                    if is_there {
                        for (register, value) in (address..).zip(values.iter()) {
                            self.write(register, *value);
                        }
                    }
                }
                Operation::Read(bytes) if is_there => self.read(address, bytes),
                // Nobody drives the line.
                Operation::Read(bytes) => bytes.fill(0xff),
                _ => {}
            }
        }
        Ok(())
    }
}
