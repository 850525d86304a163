//! The self-tests: after power-on, on command, and all the time.

use core::sync::atomic::Ordering;

use tempco_link::{Fault, FaultSet};

use super::devices::{Flash, SampleClock, Thermometers};
use super::exchange::Known;
use super::service::Service;

impl<F, T, K, const C: usize, const A: usize> Service<'_, F, T, K, C, A>
where
    F: Flash,
    T: Thermometers<C>,
    K: SampleClock,
{
    /// After power-on: the offsets that were kept, and the processor.
    pub(super) fn test_at_power_on(&mut self) {
        if let Some(reason) = self.offsets.refused() {
            self.record_fault(Fault::ReZero, reason.detail());
        }
        self.check_known_answer();
    }

    /// On command: the processor, and the whole store.
    pub(super) fn test_on_command(&mut self) -> FaultSet {
        self.check_known_answer();
        // What could not be written before is written now, if it can be.
        match self.storage.flush() {
            Ok(()) => self.health.clear(Fault::Flash),
            Err(_) => self.record_fault(Fault::Flash, 0),
        }
        self.storage.check_all();
        self.check_tables();
        self.health.present()
    }

    /// All the time: the next stretch of the store, faults that are gone, samples that were lost,
    /// the stack and the load.
    pub(super) fn self_test(&mut self) {
        self.storage.check();
        self.check_tables();
        self.health.heal(self.time.now_ms());
        let now = Known {
            overruns: self.overruns(),
            data_ready: self.ends.counts.data_ready.load(Ordering::Relaxed),
            silent: self.ends.counts.silent.load(Ordering::Relaxed),
        };
        let known = core::mem::replace(&mut self.known, now);
        for (fault, before, now) in [
            (Fault::Overrun, known.overruns, now.overruns),
            (Fault::DataReady, known.data_ready, now.data_ready),
            (Fault::GyroSilent, known.silent, now.silent),
        ] {
            if before != now {
                self.record_fault(fault, now);
            }
        }
        if !(self.stack_is_sound)() {
            self.record_fault(Fault::Stack, 0);
        }
        let (periods, counts) = (self.ends.counts.periods(), self.clock.period());
        self.load
            .find(periods, counts, self.schedule.sample_rate_hz);
    }

    /// Whether this processor still computes what it should.
    fn check_known_answer(&mut self) {
        if (self.knows_the_answer)() {
            self.health.clear(Fault::KnownAnswer);
        } else {
            self.record_fault(Fault::KnownAnswer, 0);
        }
    }

    fn check_tables(&mut self) {
        if let Some(reason) = self.storage.bad() {
            self.record_fault(Fault::SpareTable, reason);
        }
        if self.tables.is_none() {
            self.record_fault(Fault::NoTable, 0);
        }
    }
}
