//! Image `unit`: the application of gyro electronics. Needs the feature `application`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(all(target_os = "none", feature = "application")))]
fn main() -> std::process::ExitCode {
    tempco_firmware::host_main()
}

#[cfg(all(target_os = "none", feature = "application"))]
mod image {
    use core::cell::Cell;

    use cortex_m::peripheral::SYST;
    use cortex_m::{Peripherals, singleton};
    use cortex_m_rt::{entry, exception};
    use critical_section::Mutex;
    use tempco_firmware::board::chosen::{self, BoardGyro, REGIONS};
    use tempco_firmware::reset::{self, Reason};
    use tempco_firmware::sample_clock::SysTick;
    use tempco_firmware::stack;
    use tempco_firmware::unit::devices::{Gyro, ResetCause};
    use tempco_firmware::unit::exchange::{Counts, Exchange};
    use tempco_firmware::unit::fit::{UNITS, fits, scale};
    use tempco_firmware::unit::in_use::{InUse, PLACES, Place, Room};
    use tempco_firmware::unit::offsets::Offsets;
    use tempco_firmware::unit::rezero::Limits;
    use tempco_firmware::unit::storage::Storage;
    use tempco_firmware::unit::{
        AXES, CHANNELS, IMAGE_LEN, Next, Parts, SCHEDULE, Sampling, Unit, known_answer,
    };
    use tempco_image::AlignedBytes;

    type BoardSampling = Sampling<'static, BoardGyro, CHANNELS, AXES>;
    type Interrupt = (&'static mut BoardSampling, SYST);

    /// From the set-up to the interrupt.
    static INTERRUPT: Mutex<Cell<Option<Interrupt>>> = Mutex::new(Cell::new(None));
    static COUNTS: Counts = Counts::new();

    #[exception]
    fn SysTick() {
        static mut OWN: Option<Interrupt> = None;
        if OWN.is_none() {
            *OWN = critical_section::with(|cs| INTERRUPT.borrow(cs).take());
        }
        if let Some((sampling, timer)) = OWN {
            sampling.interrupt(timer.has_wrapped(), &SysTick);
        }
    }

    #[entry]
    fn main() -> ! {
        // `None` only if this were called twice.
        match run() {
            Some(reason) => reset::because(reason),
            None => reset::because(Reason::Crash(0)),
        }
    }

    fn run() -> Option<Reason> {
        // The board, and why it started.
        let mut core = Peripherals::take()?;
        let (mut devices, flash, gyro) = chosen::take(&mut core)?;
        let last = reset::last();
        let crash = match last {
            Some(Reason::Crash(place)) => Some(place),
            _ => None,
        };
        if last == Some(Reason::Watchdog) {
            devices.reset_cause = ResetCause::Watchdog;
        }

        // The tables of the active image. Without one, the unit runs and sends raw samples.
        type Buffer = AlignedBytes<IMAGE_LEN>;
        let buffer = singleton!(: Buffer = AlignedBytes([0; IMAGE_LEN]))?;
        let scratch = singleton!(: Buffer = AlignedBytes([0; IMAGE_LEN]))?;
        type Places = [Place<'static, CHANNELS, AXES>; PLACES];
        let places = singleton!(: Places = [const { None }; PLACES])?;
        let fits = fits::<BoardGyro, CHANNELS, AXES>(&UNITS);
        let mut room = Room::new(&mut buffer.0, places);
        let (storage, in_use) =
            Storage::boot(flash, REGIONS, &fits, &mut room, &mut scratch.0).ok()?;
        let table_crc = in_use.as_ref().map_or(0, InUse::crc);
        tempco_firmware::info!("unit with table {=u32:08x}", table_crc);

        // Sampling: ramps and queues, scale of the gyro, offsets of re-zero.
        let exchange = singleton!(: Exchange<CHANNELS, AXES> = Exchange::new())?;
        let (interrupt_ends, ends) = exchange.split(&COUNTS);
        let scale = scale::<BoardGyro, CHANNELS, AXES>(&UNITS, SCHEDULE.sample_rate_hz);
        let limits = Limits::of::<BoardGyro>(&UNITS);
        let kept = storage.offsets(table_crc);
        let offsets = Offsets::new(kept, limits);
        let sampling = Sampling::new(gyro, interrupt_ends, scale);
        // In its place before the first interrupt, which would else have to move it.
        let sampling = singleton!(: BoardSampling = sampling)?;

        // From here on the interrupt owns the sampling.
        let clock = SysTick::start(&mut core.SYST);
        sampling.start(&clock);
        critical_section::with(|cs| INTERRUPT.borrow(cs).set(Some((sampling, core.SYST))));
        // The main loop owns the rest, until a reset is commanded.
        let parts = Parts {
            storage,
            in_use,
            room,
            offsets,
            ends,
            clock,
            schedule: SCHEDULE,
            scale_factor_arcsec: <BoardGyro as Gyro<CHANNELS, AXES>>::SCALE_FACTOR_ARCSEC,
            stack_is_sound: stack::is_sound,
            knows_the_answer: known_answer::is_right,
        };
        let mut unit = Unit::new(parts, devices, crash);
        while unit.pass() == Next::GoOn {}
        Some(Reason::Commanded)
    }
}
