//! The main loop, one pass at a time.

use tempco_link::{Counters, Fault, Server};

use super::WATCHDOG_MS;
use super::devices::{Devices, Flash, Link, ResetCause, SampleClock, Thermometers, Watchdog};
use super::health::LiveNess;
use super::parts::Parts;
use super::service::Service;

/// Time between two self-tests \[ms\].
const TEST_MS: u32 = 100;

/// What comes after a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// The next pass.
    GoOn,
    /// A reset, as a host has asked for it.
    Reset,
}

/// The main loop: the wire and the watchdog, and between them the service, which does the work.
pub struct Unit<'t, L, F, T, W, K, const C: usize, const A: usize> {
    link: L,
    server: Server,
    watchdog: W,
    live_ness: LiveNess,
    service: Service<'t, F, T, K, C, A>,
    /// Time of the last self-test.
    tested_ms: u32,
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
        let mut service = Service::new(parts, thermometers);
        if let Some(place) = crash {
            service.record_fault(Fault::Crash, place);
        }
        match reset_cause {
            ResetCause::Watchdog => service.record_fault(Fault::WatchdogReset, 0),
            ResetCause::BrownOut => service.record_fault(Fault::BrownOut, 0),
            ResetCause::PowerOn | ResetCause::Commanded => {}
        }
        for fault in faults.iter() {
            service.record_fault(fault, 0);
        }
        let was_unwanted = crash.is_some() || reset_cause == ResetCause::Watchdog;
        let first_session = service.note_boot(was_unwanted);
        service.hold_off();
        service.test_at_power_on();
        watchdog.start(WATCHDOG_MS);
        Self {
            link,
            server: Server::new(first_session),
            watchdog,
            live_ness: LiveNess::new(),
            service,
            tested_ms: 0,
        }
    }

    /// Does what there is to do, and sleeps until the next interrupt if that is nothing.
    pub fn pass(&mut self) -> Next {
        self.service.drain();
        self.service.read_thermometers();
        let was_busy = self.serve();
        if was_busy {
            self.service.promise_sessions(self.server.next_session());
        }
        if self.service.wants_reset {
            // What was counted is worth more than why it could not be written.
            _ = self.service.storage.flush();
            _ = self.link.flush();
            return Next::Reset;
        }
        self.send_telemetry();
        self.self_test();
        if !was_busy {
            self.service.sleep();
        }
        Next::GoOn
    }

    /// Takes what the host has sent; whether there was anything.
    fn serve(&mut self) -> bool {
        if !matches!(self.link.read_ready(), Ok(true)) {
            return false;
        }
        let mut bytes = [0; 64];
        let count = self.link.read(&mut bytes).unwrap_or(0);
        for byte in bytes.iter().take(count) {
            if let Some(answer) = self.server.receive(*byte, &mut self.service) {
                // A wire that fails loses an answer, which the host then asks for again.
                _ = self.link.write_all(answer);
            }
        }
        count > 0
    }

    /// Sends the telemetry that is due without being asked for.
    fn send_telemetry(&mut self) {
        let Some(telemetry) = self.service.due_telemetry() else {
            return;
        };
        if let Some(frame) = self.server.telemetry(telemetry) {
            _ = self.link.write_all(frame);
        }
    }

    /// The continuous self-test, and the watchdog.
    fn self_test(&mut self) {
        let now_ms = self.service.time.now_ms();
        if now_ms.wrapping_sub(self.tested_ms) < TEST_MS {
            return;
        }
        self.tested_ms = now_ms;
        self.service.dropped_frames = dropped(self.server.counters());
        self.service.self_test();
        let readings = self.service.thermometry.readings();
        match self.live_ness.look(now_ms, readings) {
            Some(true) => self.watchdog.feed(),
            Some(false) => self.service.record_fault(Fault::Starved, 0),
            None => {}
        }
    }
}

fn dropped(counters: &Counters) -> u32 {
    counters.long.saturating_add(counters.damaged)
}
