//! The work of the main loop: the thermal half, samples from the interrupt, the faults that they
//! show, and the state that telemetry gives.

use core::sync::atomic::Ordering;

use heapless::Vec;
use tempco::{BiasRamp, PLAYS, Schedule, Status, ThermalPoint};
use tempco_link::{Channels, Fault, Losses, MAX_BLOCK, Outcome, Refusal, Telemetry};
use tempco_replay::Replay;

use super::UnitThermal;
use super::devices::{Flash, SampleClock, Thermometers};
use super::exchange::{Known, MainEnds, Moment, publish};
use super::health::{Health, faults_of};
use super::in_use::{InUse, Room};
use super::load::Load;
use super::offsets::Offsets;
use super::parts::Parts;
use super::recent::{Means, Recent};
use super::sampling::difference;
use super::storage::Storage;
use super::thermometry::Thermometry;
use super::time::Time;
use super::wire::{axes, channels};

/// A message waits so much longer for its samples than its period and an eighth \[ms\].
const LATE_MS: u32 = 2;

/// Where the models are evaluated without a table.
const NOWHERE: ThermalPoint = ThermalPoint {
    effective_c: f32::NAN,
    rate_c_per_min: f32::NAN,
    lag2_c: f32::NAN,
    plays_c: [f32::NAN; PLAYS],
    status: Status::TEMPERATURE_LOST,
};

/// All of the main loop but the wire and the watchdog.
pub(super) struct Service<'t, F, T, K, const C: usize, const A: usize> {
    pub(super) storage: Storage<'t, F>,
    pub(super) thermometry: Thermometry<T, C>,
    pub(super) health: Health,
    pub(super) ends: MainEnds<'t, C, A>,
    pub(super) clock: K,
    pub(super) schedule: Schedule,
    pub(super) time: Time,
    pub(super) load: Load,
    pub(super) in_use: Option<InUse<'t, C, A>>,
    pub(super) room: Room<'t, C, A>,
    /// The thermal halves of all channels, for the gyro and for a replay.
    pub(super) thermal: Option<UnitThermal<'t, C, A>>,
    pub(super) replay_thermal: Option<UnitThermal<'t, C, A>>,
    /// Periods of the sampling timer when it was given the last temperatures.
    updated_at: u32,
    pub(super) offsets: Offsets<C, A>,
    /// Offsets that the interrupt does not take out yet.
    pub(super) has_new_offsets: bool,
    pub(super) recent: Recent<C, A>,
    pub(super) scale_factor_arcsec: f32,
    pub(super) stack_is_sound: fn() -> bool,
    pub(super) knows_the_answer: fn() -> bool,
    pub(super) wants_reset: bool,
    /// The tables in use were damaged and could not be loaded again.
    pub(super) has_lost_table: bool,
    /// Interrupts of the timer when there were the first temperatures.
    started_at: Option<u32>,
    /// What was lost, came without a word or did not come until the last self-test.
    pub(super) known: Known,
    pub(super) dropped_frames: u32,
    telemetry_index: u32,
    /// Period of the telemetry that is sent without being asked for; none where it is 0.
    period_ms: u32,
    /// Time of the last message that was sent so, or when the first one was asked for.
    unasked_ms: u32,
    /// Samples of such a message.
    message_samples: u32,
    pub(super) replay: Option<Replay<'t, C, A>>,
    /// Compensated samples of the last block.
    pub(super) block: Vec<u8, MAX_BLOCK>,
}

impl<'t, F, T, K, const C: usize, const A: usize> Service<'t, F, T, K, C, A>
where
    F: Flash,
    T: Thermometers<C>,
    K: SampleClock,
{
    pub(super) fn new(parts: Parts<'t, F, K, C, A>, thermometers: T) -> Self {
        let Parts {
            storage,
            in_use,
            room,
            offsets,
            ends,
            clock,
            schedule,
            scale_factor_arcsec,
            stack_is_sound,
            knows_the_answer,
        } = parts;
        let thermal = in_use
            .as_ref()
            .map(|in_use| UnitThermal::new(in_use.tables(), schedule.samples_per_update));
        let constant = constant(thermal.as_ref());
        let service = Self {
            storage,
            thermometry: Thermometry::new(thermometers),
            health: Health::new(),
            ends,
            clock,
            schedule,
            time: Time::new(schedule.sample_rate_hz),
            load: Load::default(),
            in_use,
            room,
            replay_thermal: thermal.clone(),
            thermal,
            updated_at: 0,
            offsets,
            has_new_offsets: false,
            recent: Recent::default(),
            scale_factor_arcsec,
            stack_is_sound,
            knows_the_answer,
            wants_reset: false,
            has_lost_table: false,
            started_at: None,
            known: Known::default(),
            dropped_frames: 0,
            telemetry_index: 0,
            period_ms: 0,
            unasked_ms: 0,
            message_samples: u32::MAX,
            replay: None,
            block: Vec::new(),
        };
        publish(service.ends.replay_ramps, &constant);
        service.publish(constant);
        service
    }

    /// Records a fault, in the log too if it is new. Out of line, since there are many callers.
    #[inline(never)]
    pub(super) fn record_fault(&mut self, fault: Fault, detail: u32) {
        let now_ms = self.time.now_ms();
        if !self.health.record(fault, now_ms) {
            return;
        }
        crate::warn!("fault {}: {=u32}", fault, detail);
        let recorded = self.storage.record(fault, self.time.uptime_s(), detail);
        if recorded.is_err() && fault != Fault::Flash {
            self.health.record(Fault::Flash, now_ms);
        }
    }

    /// Takes what the interrupt has measured, up to the end of the message that is under way.
    pub(super) fn drain(&mut self) {
        self.time.look(self.ends.counts.periods());
        while (self.recent.samples() < self.message_samples || self.is_late())
            && let Some(moment) = self.ends.moments.dequeue()
        {
            self.take(&moment);
        }
    }

    /// Sends telemetry without being asked for it from now on, every period \[ms\]; not where it is 0.
    pub(super) fn begin_telemetry(&mut self, period_ms: u32) {
        self.period_ms = period_ms;
        self.unasked_ms = self.time.now_ms();
        // As many as a period has, so that means of pulses have no jitter.
        let samples = period_ms as f32 / 1000.0 * self.schedule.sample_rate_hz;
        self.message_samples = match samples as u32 {
            0 => u32::MAX,
            samples => samples,
        };
    }

    /// Whether a message does not wait for its samples any more: a gyro with a clock of its own may be
    /// slow or silent, and a line too slow for the period.
    fn is_late(&self) -> bool {
        let since_ms = self.time.now_ms().wrapping_sub(self.unasked_ms);
        since_ms > self.period_ms.saturating_add(self.period_ms / 8 + LATE_MS)
    }

    /// Takes a moment of the gyro: into the means, the re-zero that is under way, and the faults.
    fn take(&mut self, moment: &Moment<C, A>) {
        self.recent.add(moment);
        let status = moment
            .status
            .iter()
            .fold(Status::OK, |all, status| all | *status);
        if self.offsets.is_averaging() {
            self.average(moment, status);
        }
        // Most samples, also of a unit that still settles, show no fault.
        if Status::SETTLING.contains(status) {
            return;
        }
        if !self.is_started() {
            return;
        }
        for fault in faults_of(status).iter() {
            // Without a table the status says that there is no temperature, but there may be.
            if self.in_use.is_some() || fault != Fault::TemperatureLost {
                self.record_fault(fault, u32::from(status.bits()));
            }
        }
    }

    /// Gives a moment to the re-zero that is under way.
    fn average(&mut self, moment: &Moment<C, A>, status: Status) {
        let compensated = difference(&moment.raw, &moment.bias);
        match self.offsets.add(&compensated, status) {
            // A failing flash is a fault of its own.
            Some(Ok(offsets)) => _ = self.keep_offsets(offsets),
            Some(Err(reason)) => self.record_fault(Fault::ReZero, reason.detail()),
            None => {}
        }
    }

    /// Whether there have been temperatures for two updates; before, it is no fault that there are
    /// none.
    fn is_started(&self) -> bool {
        let ticks = self.ends.counts.ticks();
        let two_updates = 2 * u32::from(self.schedule.samples_per_update);
        self.started_at
            .is_some_and(|start| ticks.wrapping_sub(start) > two_updates)
    }

    /// Offsets take effect once they are kept, with the next ramp.
    pub(super) fn keep_offsets(&mut self, offsets: [[f32; A]; C]) -> Result<(), Refusal> {
        let table_crc = self.in_use.as_ref().map_or(0, InUse::crc);
        if let Err(error) = self.storage.set_offsets(table_crc, &offsets) {
            crate::warn!("offsets: {}", error);
            self.record_fault(Fault::Flash, 0);
            return Err(Refusal::Store);
        }
        self.offsets.set(offsets);
        self.has_new_offsets = true;
        crate::info!("offsets: {}", offsets);
        Ok(())
    }

    /// Reads the thermometers when it is time, and makes ramps of what they show. The time is the
    /// timer's: a gyro with a clock of its own may be fast, slow, or silent.
    pub(super) fn read_thermometers(&mut self) {
        let ticks = self.ends.counts.ticks();
        let period = self.schedule.samples_per_update;
        if !self.thermometry.is_due(ticks, period) {
            return;
        }
        if let Some(temps_c) = self.thermometry.read() {
            self.started_at.get_or_insert(ticks);
            self.update(&temps_c);
        }
        let faults: Vec<(Fault, u32), C> = self.thermometry.faults().collect();
        for (fault, channel) in faults {
            self.record_fault(fault, channel);
        }
    }

    /// The thermal half of each channel. Time passes in whole update periods, so that a main loop
    /// that is a little late changes nothing.
    fn update(&mut self, temps_c: &[f32; C]) {
        let now = self.ends.counts.periods();
        let since = now.wrapping_sub(core::mem::replace(&mut self.updated_at, now));
        let period = u32::from(self.schedule.samples_per_update).max(1);
        let updates = (since.saturating_add(period / 2) / period).max(1);
        let dt_s = updates as f32 * self.schedule.update_interval_s();
        let ramps = match &mut self.thermal {
            Some(thermal) => thermal.update(dt_s, temps_c),
            None => [no_bias(); C],
        };
        self.publish(ramps);
        self.has_new_offsets = false;
    }

    /// Hands ramps to the interrupt, with the offsets that it takes out too.
    fn publish(&self, mut ramps: [BiasRamp<A>; C]) {
        for (ramp, offsets) in ramps.iter_mut().zip(self.offsets.in_use()) {
            for (end, offset) in ramp.end.iter_mut().zip(offsets) {
                *end += offset;
            }
        }
        publish(self.ends.ramps, &ramps);
    }

    /// Sleeps until the next interrupt.
    pub(super) fn sleep(&mut self) {
        self.load.slept(self.clock.sleep());
    }

    /// The telemetry that is due without being asked for.
    pub(super) fn due_telemetry(&mut self) -> Option<Telemetry> {
        let now_ms = self.time.now_ms();
        if self.period_ms == 0 || !self.recent.has_news(now_ms) {
            return None;
        }
        if self.recent.samples() < self.message_samples && !self.is_late() {
            return None;
        }
        self.unasked_ms = now_ms;
        Some(self.telemetry())
    }

    /// The state now, and means since the last message.
    pub(super) fn telemetry(&mut self) -> Telemetry {
        let counts = self.ends.counts;
        let latency = u64::from(counts.latency.load(Ordering::Relaxed));
        let Means { raw, bias, status } = self.recent.take(self.time.now_ms());
        let offsets = self.offsets.in_use();
        let each = |of: &dyn Fn(usize, usize) -> f32| {
            axes::<C, A>(&core::array::from_fn(|channel| {
                core::array::from_fn(|axis| of(channel, axis))
            }))
        };
        let outcome = Outcome {
            channels: match status {
                Some(status) => channels(&self.points(self.thermal.as_ref()), &status),
                None => Channels::new(),
            },
            bias: each(&|channel, axis| bias[channel][axis] - offsets[channel][axis]),
            compensated: each(&|channel, axis| raw[channel][axis] - bias[channel][axis]),
        };
        self.telemetry_index = self.telemetry_index.wrapping_add(1);
        Telemetry {
            index: self.telemetry_index,
            uptime_ms: self.time.now_ms(),
            temps_c: self.thermometry.temps_c().into_iter().collect(),
            raw: axes(&raw),
            outcome,
            offset: axes(offsets),
            samples: counts.samples(),
            rejected: self.thermal.as_ref().map_or(0, UnitThermal::rejected),
            overruns: self.overruns(),
            dropped_frames: self.dropped_frames,
            faults: self.health.present(),
            load_permille: self.load.permille(),
            latency_ns: (latency * u64::from(K::COUNT_NS)) as u32,
        }
    }

    /// Where the models were evaluated last; without a table, nowhere.
    pub(super) fn points(&self, thermal: Option<&UnitThermal<'_, C, A>>) -> [ThermalPoint; C] {
        thermal.map_or([NOWHERE; C], UnitThermal::points)
    }

    /// Samples that were missed and outcomes that were lost.
    pub(super) fn overruns(&self) -> u32 {
        let Losses {
            missed_samples,
            moments,
            replies,
        } = self.ends.counts.losses();
        missed_samples
            .saturating_add(moments)
            .saturating_add(replies)
    }
}

/// What there is to take out before the first temperatures.
pub(super) fn constant<const C: usize, const A: usize>(
    thermal: Option<&UnitThermal<'_, C, A>>,
) -> [BiasRamp<A>; C] {
    thermal.map_or([no_bias(); C], UnitThermal::constant)
}

/// What there is to take out without a table: nothing, and the sample is marked as not to be used.
const fn no_bias<const A: usize>() -> BiasRamp<A> {
    BiasRamp {
        end: [0.0; A],
        slope: [0.0; A],
        samples: 0,
        status: Status::TEMPERATURE_LOST,
    }
}
