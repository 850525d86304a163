//! Carries out the requests of the link.

use heapless::Vec;
use tempco::MAX_AXES;
use tempco_image::Fit;
use tempco_link::{Axes, Fault, Handler, MAX_CHUNK, Refusal, Request, Response};

use super::SERIAL;
use super::devices::{Flash, SampleClock, Thermometers};
use super::in_use::InUse;
use super::service::Service;
use super::storage::bank_of;
use super::wire::per_axis;

const FIRMWARE: &str = concat!("tempco ", env!("CARGO_PKG_VERSION"));

/// The longest averaging of a re-zero \[s\].
const MAX_AVERAGING_S: u16 = 3600;

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
        // An arm for each message. What can be refused answers with the refusal.
        match request {
            Request::Identify => Response::Identity {
                serial: SERIAL,
                firmware: FIRMWARE,
                channels: C as u8,
                axes: A as u8,
                sample_rate_hz: self.schedule.sample_rate_hz,
                samples_per_update: self.schedule.samples_per_update,
                bank: self.storage.active().map(|active| bank_of(active.slot)),
                spare: self.storage.spare(),
                table_crc: self.in_use.as_ref().map_or(0, InUse::crc),
                sequence: self.storage.active().map_or(0, |active| active.sequence),
                scale_factor_arcsec: self.scale_factor_arcsec,
                units: self.fits(|fit| fit.unit.code()),
                max_bias: self.fits(|fit| fit.max_bias),
            },
            Request::Telemetry { period_ms } => {
                self.begin_telemetry(period_ms);
                self.next_telemetry()
            }
            Request::Sample(sample) => self.step(&sample),
            Request::Restart => {
                self.restart();
                Response::Done
            }
            Request::Block(block) => self.block(&block),
            Request::Bit => Response::Bit {
                faults: self.test_on_command(),
            },
            Request::ReZero {
                averaging_s,
                expected,
            } => self.re_zero(averaging_s, &expected),
            Request::ClearOffsets => done(self.clear_offsets()),
            Request::Losses => Response::Losses(self.ends.counts.losses()),
            Request::Wear => Response::Wear(self.storage.wear()),
            // A table into the bank that is not in use: begin, chunks, commit. Then, or at any time,
            // it is activated.
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
            Request::Activate(bank) => {
                let selected = self.storage.select::<C, A>(bank);
                self.wants_reset = selected.is_ok();
                done(selected)
            }
            // A table back to the host.
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

impl<F, T, K, const C: usize, const A: usize> Service<'_, F, T, K, C, A>
where
    F: Flash,
    T: Thermometers<C>,
    K: SampleClock,
{
    /// What each axis of a table must fit, channel by channel.
    fn fits<V>(&self, of: fn(&Fit) -> V) -> Vec<V, MAX_AXES> {
        let mut values = Vec::new();
        for fit in self.storage.fits() {
            // There is room for every axis.
            _ = values.push(of(fit));
        }
        values
    }

    /// The state as soon as there is a sample, which there is unless the interrupt has stopped: a gyro
    /// with a clock of its own may have none for 10 ms, and then counts as silent.
    fn next_telemetry(&mut self) -> Response<'static> {
        let patience = 2 + self.schedule.sample_rate_hz as u32 / 50;
        let from = self.ends.counts.periods();
        loop {
            self.drain();
            if self.recent.has_news(self.time.now_ms()) {
                return Response::Telemetry(self.telemetry());
            }
            if self.ends.counts.periods().wrapping_sub(from) > patience {
                return Response::Refused(Refusal::Busy);
            }
            self.clock.sleep();
        }
    }

    fn re_zero(&mut self, averaging_s: u16, expected: &Axes) -> Response<'static> {
        let expected = if expected.is_empty() {
            Some([[0.0; A]; C])
        } else {
            per_axis(expected)
        };
        let is_finite =
            |expected: &[[f32; A]; C]| expected.as_flattened().iter().all(|v| v.is_finite());
        match expected.filter(is_finite) {
            Some(expected) if (1..=MAX_AVERAGING_S).contains(&averaging_s) => {
                if !self.can_change_offsets() || self.health.present().is_invalidating() {
                    return Response::Refused(Refusal::Busy);
                }
                let samples = f32::from(averaging_s) * self.schedule.sample_rate_hz;
                let short = self.schedule.samples_per_update.into();
                self.offsets.begin(samples as u32, expected, short);
                self.health.clear(Fault::ReZero);
                Response::Done
            }
            _ => Response::Refused(Refusal::Unknown),
        }
    }

    /// Whether offsets can be changed: no averaging is under way, and the interrupt takes out the
    /// ones before.
    fn can_change_offsets(&self) -> bool {
        !self.offsets.is_averaging() && !self.has_new_offsets
    }

    fn clear_offsets(&mut self) -> Result<(), Refusal> {
        if !self.can_change_offsets() {
            return Err(Refusal::Busy);
        }
        self.keep_offsets([[0.0; A]; C])?;
        self.health.clear(Fault::ReZero);
        Ok(())
    }
}
