//! The main loop, one pass at a time.

use tempco::Schedule;
use tempco_image::{Image, Unit as AxisUnit};
use tempco_link::{Counters, Fault, Server};

use super::devices::{Devices, Flash, Gyro, Link, ResetCause, SampleClock, Thermometers, Watchdog};
use super::exchange::MainEnds;
use super::health::LiveNess;
use super::rezero::{GivenUp, Limits};
use super::service::Service;
use super::storage::Storage;
use super::{UnitTables, WATCHDOG_MS};

/// Time between two looks at everything that has no time of its own \[ms\].
const CARE_MS: u32 = 100;

/// Time over which the load is found \[ms\].
const LOAD_MS: u32 = 1000;

/// What comes after a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// The next pass.
    GoOn,
    /// A reset, as a host has asked for it.
    Reset,
}

/// The main loop's state.
pub struct Unit<'t, L, F, T, W, K, const C: usize, const A: usize> {
    link: L,
    watchdog: W,
    server: Server,
    service: Service<'t, F, T, K, C, A>,
    live_ness: LiveNess,
    /// Gyro samples at the last reading of the thermometers, and the number of readings.
    read_at: u32,
    readings: u32,
    told_ms: u32,
    cared_ms: u32,
    overruns: u32,
    /// Counts asleep since `load_from` periods of the sampling timer.
    asleep: u64,
    load_from: u32,
    /// Whether the stack keeps its distance from what lies below it.
    stack_is_sound: fn() -> bool,
}

/// What a unit is put together from, beside its board.
pub struct Parts<'t, F, K, const C: usize, const A: usize> {
    /// Booted.
    pub storage: Storage<'t, F>,
    /// Tables in use and their CRC; none where the unit runs uncompensated.
    pub tables: Option<(&'t UnitTables<'t, C, A>, u32)>,
    /// Constant biases of re-zero.
    pub offsets: [[f32; A]; C],
    /// The main loop's side of the interrupt.
    pub ends: MainEnds<'t, C, A>,
    /// The interrupt's timer.
    pub clock: K,
    /// Rates of both.
    pub schedule: Schedule,
    /// What re-zero may find.
    pub limits: Limits<C, A>,
    /// Scale factor of the gyro \[arcsec/pulse\].
    pub scale_factor_arcsec: f32,
    /// Whether the stack keeps its distance from what lies below it.
    pub stack_is_sound: fn() -> bool,
    /// Whether the processor computes what it should: [`known_answer`](super::known_answer).
    pub knows_the_answer: fn() -> bool,
}

impl<'t, L, F, T, W, K, const C: usize, const A: usize> Unit<'t, L, F, T, W, K, C, A>
where
    L: Link,
    F: Flash,
    T: Thermometers<C>,
    W: Watchdog,
    K: SampleClock,
{
    /// Runs the test after power-on and starts the watchdog. `crash` is what is left of a program
    /// that ended in a panic or a fault: where it was.
    pub fn new(
        parts: Parts<'t, F, K, C, A>,
        devices: Devices<L, T, W>,
        crash: Option<u32>,
    ) -> Self {
        let Devices {
            link,
            thermometers,
            mut watchdog,
            reset_cause,
            faults,
        } = devices;
        let first_session = parts.storage.boot_number() << 16;
        let stack_is_sound = parts.stack_is_sound;
        let stored = parts
            .storage
            .offsets(parts.tables.map_or(0, |(_, crc)| crc));
        let refused = parts.limits.beyond(&stored);
        let mut service = Service::new(parts, thermometers);
        if let Some(place) = crash {
            service.note(Fault::Crash, place);
        }
        match reset_cause {
            ResetCause::Watchdog => service.note(Fault::WatchdogReset, 0),
            ResetCause::BrownOut => service.note(Fault::BrownOut, 0),
            ResetCause::PowerOn | ResetCause::Commanded => {}
        }
        for fault in faults.iter() {
            service.note(fault, 0);
        }
        if let Some(axis) = refused {
            service.note(Fault::ReZero, GivenUp::Bias(axis).detail());
        }
        service.check_known_answer();
        watchdog.start(WATCHDOG_MS);
        Self {
            link,
            watchdog,
            server: Server::new(first_session),
            service,
            live_ness: LiveNess::new(),
            read_at: 0,
            readings: 0,
            told_ms: 0,
            cared_ms: 0,
            overruns: 0,
            asleep: 0,
            load_from: 0,
            stack_is_sound,
        }
    }

    /// Does what there is to do, and sleeps until the next interrupt if that is nothing.
    pub fn pass(&mut self) -> Next {
        self.service.drain();
        self.read_thermometers();
        let was_busy = self.serve();
        if self.service.wants_reset {
            // What was counted is worth more than why it could not be written.
            _ = self.service.storage.flush();
            _ = self.link.flush();
            return Next::Reset;
        }
        self.tell();
        self.care();
        if !was_busy {
            self.asleep += u64::from(self.service.clock.sleep());
        }
        Next::GoOn
    }

    /// On the interrupt's schedule, so that its next temperatures are there in time.
    fn read_thermometers(&mut self) {
        let period = u32::from(self.service.schedule.samples_per_update).max(1);
        let samples = self.service.ends.counts.samples();
        if samples.wrapping_sub(self.read_at) >= period {
            // After a long stall the readings that were missed are not made up for.
            let late = samples.wrapping_sub(self.read_at) / period;
            self.read_at = self.read_at.wrapping_add(late * period);
            self.service.read_thermometers();
            self.readings = self.readings.wrapping_add(1);
        }
    }

    /// Takes what the host has sent; whether there was anything.
    fn serve(&mut self) -> bool {
        let mut bytes = [0; 64];
        if !matches!(self.link.read_ready(), Ok(true)) {
            return false;
        }
        let count = self.link.read(&mut bytes).unwrap_or(0);
        for byte in bytes.iter().take(count) {
            if let Some(answer) = self.server.receive(*byte, &mut self.service) {
                // A wire that fails loses an answer, which the host then asks for again.
                _ = self.link.write_all(answer);
            }
        }
        count > 0
    }

    fn tell(&mut self) {
        let now_ms = self.service.now_ms();
        let period_ms = self.service.period_ms;
        if period_ms == 0 || now_ms.wrapping_sub(self.told_ms) < period_ms {
            return;
        }
        if !self.service.has_news() {
            return;
        }
        self.told_ms = now_ms;
        let telemetry = self.service.telemetry();
        if let Some(frame) = self.server.telemetry(telemetry) {
            _ = self.link.write_all(frame);
        }
    }

    /// The continuous built-in test, and the watchdog.
    fn care(&mut self) {
        let now_ms = self.service.now_ms();
        if now_ms.wrapping_sub(self.cared_ms) < CARE_MS {
            return;
        }
        self.cared_ms = now_ms;
        self.service.dropped_frames = dropped(self.server.counters());
        self.service.care();
        let overruns = self.service.overruns();
        if overruns != self.overruns {
            self.overruns = overruns;
            self.service.note(Fault::Overrun, overruns);
        }
        if !(self.stack_is_sound)() {
            self.service.note(Fault::Stack, 0);
        }
        match self.live_ness.look(now_ms, self.readings) {
            Some(true) => self.watchdog.feed(),
            Some(false) => self.service.note(Fault::Starved, 0),
            None => {}
        }
        self.find_load();
    }

    fn find_load(&mut self) {
        let service = &mut self.service;
        let periods = service.ends.counts.periods().wrapping_sub(self.load_from);
        if (periods as f32) < service.schedule.sample_rate_hz * (LOAD_MS / 1000) as f32 {
            return;
        }
        let all = u64::from(periods) * u64::from(service.clock.period());
        let busy = all.saturating_sub(self.asleep);
        service.load_permille = (busy * 1000).checked_div(all).unwrap_or(0) as u16;
        self.load_from = self.load_from.wrapping_add(periods);
        self.asleep = 0;
    }
}

fn dropped(counters: &Counters) -> u32 {
    counters.long.saturating_add(counters.damaged)
}

/// From counts per sample to the unit of each axis of an image, or to pulses per second without
/// one.
pub fn scale<G: Gyro<C, A>, const C: usize, const A: usize>(
    image: Option<&Image>,
    sample_rate_hz: f32,
) -> [[f32; A]; C] {
    let unit = |channel, axis| -> Option<AxisUnit> {
        *image?.channel(channel).ok()?.units.get::<usize>(axis)?
    };
    core::array::from_fn(|channel| {
        core::array::from_fn(|axis| {
            let per_pulse = match unit(channel, axis) {
                // One arc second per second is one degree per hour.
                Some(AxisUnit::Dph) => G::SCALE_FACTOR_ARCSEC,
                Some(AxisUnit::Dps) => G::SCALE_FACTOR_ARCSEC / 3600.0,
                Some(AxisUnit::Radps) => G::SCALE_FACTOR_ARCSEC * core::f32::consts::PI / 648_000.0,
                _ => 1.0,
            };
            G::PULSES_PER_COUNT * per_pulse * sample_rate_hz
        })
    })
}
