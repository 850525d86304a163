//! The self-tests: after power-on, on command, and all the time.

use core::sync::atomic::Ordering;

use tempco_link::{Fault, FaultSet};

use super::devices::{Flash, SampleClock, Thermometers};
use super::exchange::{Known, publish};
use super::in_use::{InUse, RESET_AFTER_S};
use super::service::{Service, constant};

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

    /// On command: the processor, the whole store, and all of the tables in use.
    pub(super) fn test_on_command(&mut self) -> FaultSet {
        self.check_known_answer();
        // What could not be written before is written now, if it can be.
        match self.storage.flush() {
            Ok(()) => self.health.clear(Fault::Flash),
            Err(_) => self.record_fault(Fault::Flash, 0),
        }
        self.storage.check_all();
        for _ in 0..self
            .in_use
            .as_ref()
            .map_or(0, |in_use| in_use.sums().steps())
        {
            self.check_in_use();
        }
        self.check_tables();
        self.health.present()
    }

    /// All the time: the next stretch of the store and of the tables in use, faults that are gone,
    /// samples that were lost, the stack and the load.
    pub(super) fn self_test(&mut self) {
        self.storage.check();
        let now_ms = self.time.now_ms();
        if let Some(in_use) = &mut self.in_use
            && in_use.is_due(now_ms)
        {
            self.check_in_use();
        }
        self.note_well();
        self.wants_reset |= self.has_lost_table && self.time.uptime_s() >= RESET_AFTER_S;
        self.check_tables();
        if self.storage.is_worn() {
            self.record_fault(Fault::LogWorn, self.storage.wear().faults);
        }
        self.health.heal(now_ms);
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

    /// The next step of the check of the tables in use. Damaged ones are loaded again, and the thermal
    /// halves go on with them from the next temperature on. Where they cannot be loaded, the unit
    /// runs without a table.
    fn check_in_use(&mut self) {
        let Some(Err(step)) = self.in_use.as_mut().map(InUse::check) else {
            return;
        };
        self.in_use = self.storage.reload(&mut self.room);
        match (&self.in_use, &mut self.thermal) {
            (Some(in_use), Some(thermal)) => thermal.move_to(in_use.tables()),
            _ => {
                self.thermal = None;
                self.has_lost_table = true;
                self.offsets.set([[0.0; A]; C]);
                publish(self.ends.ramps, &constant::<C, A>(None));
            }
        }
        // A replay that is under way has used the damaged ones.
        self.restart();
        self.record_fault(Fault::TableUpset, step);
    }

    fn check_tables(&mut self) {
        if let Some(reason) = self.storage.bad() {
            self.record_fault(Fault::SpareTable, reason);
        }
        if self.in_use.is_none() {
            self.record_fault(Fault::NoTable, 0);
        }
    }
}
