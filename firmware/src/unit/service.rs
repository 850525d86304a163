//! Carries out the requests of the link.

use core::sync::atomic::Ordering;

use heapless::Vec;
use tempco::Status;
use tempco_image::{MAX_PLAYS, MAX_SLOW_PARTS};
use tempco_link::{
    Axes, Channels, Fault, FaultSet, Handler, MAX_BLOCK, MAX_CHUNK, Outcome, Refusal, Request,
    Response, Telemetry,
};
use tempco_replay::{Replay, Schedule};

use super::devices::{Flash, SampleClock, Thermometers};
use super::exchange::{MainEnds, Moment};
use super::health::{Health, faults_of};
use super::known_answer;
use super::main_loop::Parts;
use super::replays::{axes, channels, per_axis};
use super::rezero::{Mean, ReZero};
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
    /// Gyro samples and time since power-on, as of the last look.
    samples: u64,
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
            samples: 0,
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
        let since = self.ends.counts.samples().wrapping_sub(self.samples as u32);
        self.samples += u64::from(since);
        let per_s = (self.schedule.sample_rate_hz as u64).max(1);
        self.now_ms = (self.samples * 1000 / per_s) as u32;
    }

    /// Notes a fault, in the log too if it is new.
    pub(super) fn note(&mut self, fault: Fault, detail: u32) {
        let now_ms = self.now_ms();
        if !self.health.note(fault, now_ms) {
            return;
        }
        crate::warn!("fault {}: {=u32}", fault, detail);
        let uptime_s = (self.samples as f32 / self.schedule.sample_rate_hz) as u32;
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
        if let Some(rezero) = &mut self.rezero
            && let Some(found) = rezero.add(compensated)
        {
            self.rezero = None;
            self.set_offsets(found);
        }
        let mut status = Status::OK;
        for channel in channels {
            status |= channel.flags();
        }
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

    /// What was found at rest comes on top of what was taken out already. It takes effect once it
    /// is kept.
    fn set_offsets(&mut self, found: PerAxis<C, A>) {
        let mut offsets = self.offsets;
        for (offsets, found) in offsets.iter_mut().zip(&found) {
            for (offset, found) in offsets.iter_mut().zip(found) {
                *offset += found;
            }
        }
        let table_crc = self.tables.map_or(0, |(_, crc)| crc);
        match self.storage.set_offsets(table_crc, &offsets) {
            Ok(()) => {
                self.offsets = offsets;
                // Cannot fail: the interrupt has long taken the ones before.
                _ = self.ends.offsets.enqueue(offsets);
                crate::info!("re-zero: {}", offsets);
            }
            Err(error) => {
                crate::warn!("re-zero: {}", error);
                self.note(Fault::Flash, 0);
            }
        }
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

    /// The state now; means begin anew.
    pub(super) fn telemetry(&mut self) -> Telemetry {
        let (channels, faults) = match &self.last {
            Some(moment) => (channels(&moment.outcome), self.health.present()),
            None => (Channels::new(), self.health.present()),
        };
        let counts = self.ends.counts;
        let mean = |mean: &mut Mean<C, A>| axes(&core::mem::take(mean).means());
        let latency = u64::from(counts.latency.load(Ordering::Relaxed));
        self.telemetry_index = self.telemetry_index.wrapping_add(1);
        Telemetry {
            index: self.telemetry_index,
            uptime_ms: self.now_ms(),
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
            overruns: counts.overruns.load(Ordering::Relaxed),
            dropped_frames: self.dropped_frames,
            faults,
            load_permille: self.load_permille,
            latency_ns: (latency * u64::from(K::COUNT_NS)) as u32,
        }
    }

    /// The test on command, which is the one after power-on and the whole store besides.
    fn built_in_test(&mut self) -> FaultSet {
        if !known_answer::is_right() {
            self.note(Fault::KnownAnswer, 0);
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

    /// Outcomes that were lost and interrupts that came too early.
    pub(super) fn overruns(&self) -> u32 {
        self.ends.counts.overruns.load(Ordering::Relaxed)
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
                if self.rezero.is_some() || self.health.present().is_invalidating() {
                    return Response::Refused(Refusal::Busy);
                }
                let samples = f32::from(averaging_s) * self.schedule.sample_rate_hz;
                self.rezero = Some(ReZero::new(samples as u32, expected));
                Response::Done
            }
            _ => Response::Refused(Refusal::Unknown),
        }
    }
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
                Response::Telemetry(self.telemetry())
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
