//! Carries out the requests of the link.

use core::sync::atomic::Ordering;

use heapless::Vec;
use tempco::{Schedule, Status};
use tempco_image::{MAX_PLAYS, MAX_SLOW_PARTS};
use tempco_link::{
    Axes, Channels, Fault, FaultSet, Handler, Losses, MAX_BLOCK, MAX_CHUNK, Outcome, Refusal,
    Request, Response, Telemetry,
};
use tempco_replay::Replay;

use super::devices::{Flash, SampleClock, Thermometers};
use super::exchange::{MainEnds, Moment};
use super::health::{Health, faults_of};
use super::main_loop::Parts;
use super::replays::{axes, channels, per_axis};
use super::rezero::{GivenUp, Limits, Mean, ReZero};
use super::storage::{Storage, bank_of};
use super::thermometry::Thermometry;
use super::{SERIAL, UnitTables};

const FIRMWARE: &str = concat!("tempco ", env!("CARGO_PKG_VERSION"));

/// The longest averaging of a re-zero \[s\].
const MAX_AVERAGING_S: u16 = 3600;

/// All of the main loop but the wire.
pub struct Service<'t, F, T, K, const C: usize, const A: usize> {
    pub(super) storage: Storage<'t, F>,
    pub(super) thermometry: Thermometry<T, C>,
    pub(super) health: Health,
    pub(super) ends: MainEnds<'t, C, A>,
    pub(super) clock: K,
    pub(super) schedule: Schedule,
    /// Tables in use and their CRC.
    pub(super) tables: Option<(&'t UnitTables<'t, C, A>, u32)>,
    pub(super) offsets: [[f32; A]; C],
    limits: Limits<C, A>,
    scale_factor_arcsec: f32,
    knows_the_answer: fn() -> bool,
    pub(super) load_permille: u16,
    pub(super) dropped_frames: u32,
    pub(super) period_ms: u32,
    pub(super) wants_reset: bool,
    pub(super) replay: Option<Replay<'t, C, A, MAX_PLAYS, MAX_SLOW_PARTS>>,
    rezero: Option<ReZero<C, A>>,
    raw: Mean<C, A>,
    bias: Mean<C, A>,
    compensated: Mean<C, A>,
    last: Option<Moment<C, A>>,
    /// Gyro samples when the first temperatures were sent to the interrupt.
    started_at: Option<u32>,
    telemetry_index: u32,
    /// Time of the last message.
    told_ms: Option<u32>,
    /// Periods of the sampling timer and time since power-on, as of the last look.
    periods: u64,
    now_ms: u32,
    /// Compensated samples of the last block.
    pub(super) block: Vec<u8, MAX_BLOCK>,
}

/// A thing per axis, channel by channel.
pub(super) type PerAxis<const C: usize, const A: usize> = [[f32; A]; C];

impl<'t, F, T, K, const C: usize, const A: usize> Service<'t, F, T, K, C, A>
where
    F: Flash,
    T: Thermometers<C>,
    K: SampleClock,
{
    pub(super) fn new(parts: Parts<'t, F, K, C, A>, thermometers: T) -> Self {
        let Parts {
            storage,
            tables,
            offsets,
            ends,
            clock,
            schedule,
            limits,
            scale_factor_arcsec,
            knows_the_answer,
            ..
        } = parts;
        Self {
            storage,
            thermometry: Thermometry::new(thermometers),
            health: Health::new(),
            ends,
            clock,
            schedule,
            tables,
            offsets,
            limits,
            scale_factor_arcsec,
            knows_the_answer,
            load_permille: 0,
            dropped_frames: 0,
            period_ms: 0,
            wants_reset: false,
            replay: None,
            rezero: None,
            raw: Mean::default(),
            bias: Mean::default(),
            compensated: Mean::default(),
            last: None,
            started_at: None,
            telemetry_index: 0,
            told_ms: None,
            periods: 0,
            now_ms: 0,
            block: Vec::new(),
        }
    }

    /// Time since power-on by the sampling interrupt, at the last look at it; it begins again after
    /// 49 days \[ms\].
    pub(super) const fn now_ms(&self) -> u32 {
        self.now_ms
    }

    fn look_at_time(&mut self) {
        // The interrupt counts 32 bits, of which these are the continuation.
        let since = self.ends.counts.periods().wrapping_sub(self.periods as u32);
        self.periods += u64::from(since);
        let per_s = (self.schedule.sample_rate_hz as u64).max(1);
        self.now_ms = (self.periods * 1000 / per_s) as u32;
    }

    /// Notes a fault, in the log too if it is new.
    pub(super) fn note(&mut self, fault: Fault, detail: u32) {
        let now_ms = self.now_ms();
        if !self.health.note(fault, now_ms) {
            return;
        }
        crate::warn!("fault {}: {=u32}", fault, detail);
        let uptime_s = (self.periods as f32 / self.schedule.sample_rate_hz) as u32;
        let recorded = self.storage.record(fault, uptime_s, detail);
        if recorded.is_err() && fault != Fault::Flash {
            self.health.note(Fault::Flash, now_ms);
        }
    }

    /// Takes a moment of the gyro.
    pub(super) fn take(&mut self, moment: &Moment<C, A>) {
        let channels = &moment.outcome.channels;
        let bias = channels.each_ref().map(|channel| &channel.bias);
        let compensated = channels.each_ref().map(|channel| &channel.compensated);
        self.raw.add(moment.raw.each_ref());
        self.bias.add(bias);
        self.compensated.add(compensated);
        let mut status = Status::OK;
        for channel in channels {
            status |= channel.flags();
        }
        self.average(compensated, status);
        self.last = Some(*moment);
        if !self.is_started() {
            return;
        }
        for fault in faults_of(status).iter() {
            // Without a table the status says that there is no temperature, but there may be.
            if self.tables.is_some() || fault != Fault::TemperatureLost {
                self.note(fault, u32::from(status.bits()));
            }
        }
    }

    /// Whether the interrupt has had temperatures for two updates; before, it is no fault that
    /// there are none.
    fn is_started(&self) -> bool {
        let samples = self.ends.counts.samples();
        let two_updates = 2 * u32::from(self.schedule.samples_per_update);
        self.started_at
            .is_some_and(|start| samples.wrapping_sub(start) > two_updates)
    }

    /// Gives a sample to the re-zero that is under way.
    fn average(&mut self, compensated: [&[f32; A]; C], status: Status) {
        let Some(rezero) = &mut self.rezero else {
            return;
        };
        let result = match rezero.add(compensated, status) {
            Ok(None) => return,
            Ok(Some(found)) => self.set_offsets(&found),
            Err(reason) => Err(reason),
        };
        self.rezero = None;
        if let Err(reason) = result {
            self.note(Fault::ReZero, reason.detail());
        }
    }

    /// What was found at rest comes on top of what was taken out already.
    fn set_offsets(&mut self, found: &PerAxis<C, A>) -> Result<(), GivenUp> {
        let mut offsets = self.offsets;
        for (offsets, found) in offsets.iter_mut().zip(found) {
            for (offset, found) in offsets.iter_mut().zip(found) {
                *offset += found;
            }
        }
        match self.limits.beyond(&offsets) {
            Some(axis) => Err(GivenUp::Bias(axis)),
            None => {
                // A failing flash is a fault of its own.
                _ = self.keep_offsets(offsets);
                Ok(())
            }
        }
    }

    /// Offsets take effect once they are kept.
    fn keep_offsets(&mut self, offsets: PerAxis<C, A>) -> Result<(), Refusal> {
        let table_crc = self.tables.map_or(0, |(_, crc)| crc);
        if let Err(error) = self.storage.set_offsets(table_crc, &offsets) {
            crate::warn!("offsets: {}", error);
            self.note(Fault::Flash, 0);
            return Err(Refusal::Store);
        }
        self.offsets = offsets;
        // Cannot fail: who changes them makes sure that the interrupt has taken the ones before.
        _ = self.ends.offsets.enqueue(offsets);
        crate::info!("offsets: {}", offsets);
        Ok(())
    }

    /// Whether offsets can be changed: no averaging is under way, and the interrupt has taken the
    /// ones before.
    fn can_change_offsets(&self) -> bool {
        self.rezero.is_none() && self.ends.offsets.ready()
    }

    fn clear_offsets(&mut self) -> Result<(), Refusal> {
        if !self.can_change_offsets() {
            return Err(Refusal::Busy);
        }
        self.keep_offsets([[0.0; A]; C])?;
        self.health.clear(Fault::ReZero);
        Ok(())
    }

    /// Reads the thermometers, and sends their temperatures to the interrupt.
    pub(super) fn read_thermometers(&mut self) {
        if let Some(temps_c) = self.thermometry.read() {
            self.started_at.get_or_insert(self.ends.counts.samples());
            // A full queue means that the interrupt does not come; the watchdog's matter.
            _ = self.ends.temperatures.enqueue(temps_c);
        }
        let faults: Vec<(Fault, u32), C> = self.thermometry.faults().collect();
        for (fault, channel) in faults {
            self.note(fault, channel);
        }
    }

    /// Whether there is a sample, and a later time, since the message before.
    pub(super) fn has_news(&self) -> bool {
        self.raw.count() > 0 && self.told_ms != Some(self.now_ms)
    }

    /// The state now, and means since the message before.
    pub(super) fn telemetry(&mut self) -> Telemetry {
        self.told_ms = Some(self.now_ms);
        let channels = match &self.last {
            Some(moment) => channels(&moment.outcome),
            None => Channels::new(),
        };
        let losses = self.ends.counts.losses();
        let counts = self.ends.counts;
        let mean = |mean: &mut Mean<C, A>| axes(&core::mem::take(mean).means());
        let latency = u64::from(counts.latency.load(Ordering::Relaxed));
        self.telemetry_index = self.telemetry_index.wrapping_add(1);
        Telemetry {
            index: self.telemetry_index,
            uptime_ms: self.now_ms,
            temps_c: self.thermometry.temps_c().into_iter().collect(),
            raw: mean(&mut self.raw),
            outcome: Outcome {
                channels,
                bias: mean(&mut self.bias),
                compensated: mean(&mut self.compensated),
            },
            offset: axes(&self.offsets),
            samples: counts.samples(),
            rejected: counts.rejected.load(Ordering::Relaxed),
            overruns: sum(&losses),
            dropped_frames: self.dropped_frames,
            faults: self.health.present(),
            load_permille: self.load_permille,
            latency_ns: (latency * u64::from(K::COUNT_NS)) as u32,
        }
    }

    /// The state as soon as there is a sample to tell of, which there is unless the interrupt has
    /// stopped.
    fn next_telemetry(&mut self) -> Response<'static> {
        let patience = 2 + self.schedule.sample_rate_hz as u32 / 1000;
        let from = self.ends.counts.periods();
        loop {
            self.drain();
            if self.has_news() {
                return Response::Telemetry(self.telemetry());
            }
            if self.ends.counts.periods().wrapping_sub(from) > patience {
                return Response::Refused(Refusal::Busy);
            }
            self.clock.sleep();
        }
    }

    /// Whether this processor still computes what it should.
    pub(super) fn check_known_answer(&mut self) {
        if (self.knows_the_answer)() {
            self.health.clear(Fault::KnownAnswer);
        } else {
            self.note(Fault::KnownAnswer, 0);
        }
    }

    /// The test on command, which is the one after power-on and the whole store besides.
    fn built_in_test(&mut self) -> FaultSet {
        self.check_known_answer();
        // What could not be written before is written now, if it can be.
        match self.storage.flush() {
            Ok(()) => self.health.clear(Fault::Flash),
            Err(_) => self.note(Fault::Flash, 0),
        }
        self.storage.check_all();
        self.note_tables();
        self.health.present()
    }

    /// The continuous test: the next stretch of the store, and faults that are gone.
    pub(super) fn care(&mut self) {
        self.storage.check();
        self.note_tables();
        self.health.heal(self.now_ms());
    }

    fn note_tables(&mut self) {
        if let Some(slot) = self.storage.damaged() {
            self.note(Fault::SpareTable, slot);
        }
        if self.tables.is_none() {
            self.note(Fault::NoTable, 0);
        }
    }

    /// Samples that were missed and outcomes that were lost.
    pub(super) fn overruns(&self) -> u32 {
        sum(&self.ends.counts.losses())
    }

    /// Takes what the interrupt has measured.
    pub(super) fn drain(&mut self) {
        self.look_at_time();
        while let Some(moment) = self.ends.moments.dequeue() {
            self.take(&moment);
        }
    }

    fn re_zero(&mut self, averaging_s: u16, expected: &Axes) -> Response<'static> {
        let expected = if expected.is_empty() {
            Some([[0.0; A]; C])
        } else {
            per_axis(expected)
        };
        let is_finite =
            |expected: &PerAxis<C, A>| expected.as_flattened().iter().all(|v| v.is_finite());
        match expected.filter(is_finite) {
            Some(expected) if (1..=MAX_AVERAGING_S).contains(&averaging_s) => {
                if !self.can_change_offsets() || self.health.present().is_invalidating() {
                    return Response::Refused(Refusal::Busy);
                }
                let samples = f32::from(averaging_s) * self.schedule.sample_rate_hz;
                let short = self.schedule.samples_per_update.into();
                let rezero = ReZero::new(samples as u32, expected, short, self.limits);
                self.rezero = Some(rezero);
                self.health.clear(Fault::ReZero);
                Response::Done
            }
            _ => Response::Refused(Refusal::Unknown),
        }
    }
}

const fn sum(losses: &Losses) -> u32 {
    let Losses {
        missed_samples,
        moments,
        replies,
    } = *losses;
    missed_samples
        .saturating_add(moments)
        .saturating_add(replies)
}

impl<F, T, K, const C: usize, const A: usize> Handler for Service<'_, F, T, K, C, A>
where
    F: Flash,
    T: Thermometers<C>,
    K: SampleClock,
{
    fn handle(&mut self, request: Request<'_>) -> Response<'_> {
        crate::debug!("{}", request);
        let done = |result: Result<(), Refusal>| match result {
            Ok(()) => Response::Done,
            Err(refusal) => Response::Refused(refusal),
        };
        match request {
            Request::Identify => Response::Identity {
                serial: SERIAL,
                firmware: FIRMWARE,
                channels: C as u8,
                axes: A as u8,
                sample_rate_hz: self.schedule.sample_rate_hz,
                samples_per_update: self.schedule.samples_per_update,
                bank: self.storage.active().map(|active| bank_of(active.slot)),
                table_crc: self.tables.map_or(0, |(_, crc)| crc),
                sequence: self.storage.active().map_or(0, |active| active.sequence),
            },
            Request::Telemetry { period_ms } => {
                self.period_ms = period_ms;
                self.next_telemetry()
            }
            Request::Sample(sample) => self.step(&sample),
            Request::Restart => {
                self.restart();
                Response::Done
            }
            Request::Block(block) => self.block(&block),
            Request::Bit => Response::Bit {
                faults: self.built_in_test(),
            },
            Request::ReZero {
                averaging_s,
                expected,
            } => self.re_zero(averaging_s, &expected),
            Request::ClearOffsets => done(self.clear_offsets()),
            Request::ScaleFactor => Response::ScaleFactor {
                arcsec: self.scale_factor_arcsec,
            },
            Request::Losses => Response::Losses(self.ends.counts.losses()),
            Request::SelectBank(bank) => done(self.storage.select::<C, A>(bank)),
            Request::UploadBegin { len } => match self.storage.upload_begin(len) {
                Ok(()) => Response::Expected { offset: 0 },
                Err(refusal) => Response::Refused(refusal),
            },
            Request::UploadChunk { bytes, .. } if bytes.len() > MAX_CHUNK => {
                Response::Refused(Refusal::Unknown)
            }
            Request::UploadChunk { offset, bytes } => {
                match self.storage.upload_chunk(offset, bytes) {
                    Ok(offset) => Response::Expected { offset },
                    Err(refusal) => Response::Refused(refusal),
                }
            }
            Request::UploadCommit { len, crc } => {
                done(self.storage.upload_commit::<C, A>(len, crc))
            }
            Request::Activate => {
                self.wants_reset = true;
                Response::Done
            }
            Request::Download { len, .. } if usize::from(len) > MAX_CHUNK => {
                Response::Refused(Refusal::Unknown)
            }
            Request::Download { bank, offset, len } => {
                match self.storage.download(bank, offset, len) {
                    Ok(bytes) => Response::Chunk { offset, bytes },
                    Err(refusal) => Response::Refused(refusal),
                }
            }
            Request::Faults { from_code } => Response::Faults(self.storage.faults(from_code)),
            _ => Response::Refused(Refusal::Unknown),
        }
    }
}
