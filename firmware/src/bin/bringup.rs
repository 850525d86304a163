//! Image `bringup`: sets the board up and shows what it finds, for the first hours of a new board.
//!
//! Logs the clock, the reset cause, the flash and the sensors; then sends back what comes on the
//! link until a zero comes, while the sampling interrupt reads the counters at 2 kHz; before and
//! after, it logs what was counted, and in the end what the link has lost. It erases nothing.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    tempco_firmware::host_main()
}

#[cfg(target_os = "none")]
mod image {
    use core::cell::RefCell;
    use core::sync::atomic::{AtomicI32, AtomicU32, Ordering};

    use cortex_m::interrupt::{self, Mutex};
    use cortex_m::peripheral::SYST;
    use cortex_m::peripheral::syst::SystClkSource;
    use cortex_m_rt::exception;
    use embedded_io::{Read as _, Write as _};
    use embedded_storage::nor_flash::ReadNorFlash;
    use tempco::Status;
    use tempco_firmware::board::BOARD;
    use tempco_firmware::board::stm32f405::{
        self, AXES, BoardGyro, REGIONS, SENSORS, Stm32f405, Usart,
    };
    use tempco_firmware::target::{banner, exit};
    use tempco_firmware::unit::devices::{Gyro, Thermometers, Watchdog};
    use tempco_firmware::unit::exchange::add;

    const SAMPLE_RATE_HZ: u32 = 2000;
    /// Readings of the sensors: they are started, their wires are checked, a temperature comes.
    const READINGS: u32 = 3;
    /// Periods of the timer from one reading to the next: 100 ms.
    const TICKS_PER_READING: u32 = SAMPLE_RATE_HZ / 10;
    const WATCHDOG_MS: u32 = 10_000;

    static GYRO: Mutex<RefCell<Option<(BoardGyro, SYST)>>> = Mutex::new(RefCell::new(None));
    static TICKS: AtomicU32 = AtomicU32::new(0);
    static SAMPLES: AtomicU32 = AtomicU32::new(0);
    static COUNTS: [AtomicI32; AXES] = [const { AtomicI32::new(0) }; AXES];

    #[cortex_m_rt::entry]
    fn main() -> ! {
        banner("bringup");
        let Some(mut core) = cortex_m::Peripherals::take() else {
            exit(false)
        };
        let Some(Stm32f405 {
            mut devices,
            mut flash,
            gyro,
            clock,
        }) = stm32f405::set_up(&mut core)
        else {
            exit(false)
        };
        defmt::info!("clock {}, reset by {}", clock, devices.reset_cause);
        let [a, b] = REGIONS.slots;
        for region in [a, b, REGIONS.faults, REGIONS.offsets] {
            let mut first = [0; 4];
            let read = flash.read(region.start, &mut first);
            let (read, first) = (read.is_ok(), u32::from_le_bytes(first));
            defmt::info!("flash {}: {=bool} {=u32:08x}", region, read, first);
        }

        devices.watchdog.start(WATCHDOG_MS);
        core.SYST.set_clock_source(SystClkSource::Core);
        core.SYST.set_reload(BOARD.systick_hz / SAMPLE_RATE_HZ - 1);
        core.SYST.clear_current();
        core.SYST.enable_interrupt();
        core.SYST.enable_counter();
        interrupt::free(|cs| GYRO.borrow(cs).replace(Some((gyro, core.SYST))));

        for _ in 0..READINGS {
            log_temperatures(&mut devices.thermometers);
            let start = TICKS.load(Ordering::Relaxed);
            while TICKS.load(Ordering::Relaxed).wrapping_sub(start) < TICKS_PER_READING {
                cortex_m::asm::wfi();
            }
        }
        log_counts();

        echo(&mut devices.link, &mut devices.watchdog);
        log_counts();
        defmt::info!("link {}", devices.link.errors());
        exit(true)
    }

    /// `NotReady` the first times, and what is wrong with a sensor that does not answer.
    fn log_temperatures(sensors: &mut impl Thermometers<SENSORS>) {
        for (sensor, reading) in sensors.read().into_iter().enumerate() {
            defmt::info!("sensor {=usize}: {}", sensor, reading);
        }
    }

    /// Counts since the start, which wrap.
    fn log_counts() {
        let (counts, samples) = interrupt::free(|_| {
            let counts = COUNTS.each_ref().map(|count| count.load(Ordering::Relaxed));
            (counts, samples())
        });
        defmt::info!("counts {} in {=u32} samples", counts, samples);
    }

    /// Sends back what comes, the zero at the end included.
    fn echo(link: &mut Usart, watchdog: &mut impl Watchdog) {
        defmt::info!("echo");
        loop {
            watchdog.feed();
            let mut bytes = [0; 64];
            let Ok(count) = link.read(&mut bytes);
            let received = &bytes[..count];
            _ = link.write_all(received);
            if received.contains(&0) {
                return;
            }
            if received.is_empty() {
                cortex_m::asm::wfi();
            }
        }
    }

    fn samples() -> u32 {
        SAMPLES.load(Ordering::Relaxed)
    }

    /// The timer's, or that of a gyro which has a sample.
    #[exception]
    fn SysTick() {
        static mut MINE: Option<(BoardGyro, SYST)> = None;

        if MINE.is_none() {
            *MINE = interrupt::free(|cs| GYRO.borrow(cs).take());
        }
        let Some((gyro, timer)) = MINE else { return };
        if timer.has_wrapped() {
            add(&TICKS, 1);
        }
        let Some(counts): Option<[[i32; AXES]; 1]> = gyro.sample() else {
            return;
        };
        for (sum, count) in COUNTS.iter().zip(counts[0]) {
            sum.store(
                sum.load(Ordering::Relaxed).wrapping_add(count),
                Ordering::Relaxed,
            );
        }
        let output = counts.map(|counts| counts.map(|count| count as f32));
        gyro.put(&output, &[Status::OK]);
        add(&SAMPLES, 1);
    }
}
