//! The samples since the last message of telemetry.

use tempco::Status;

use super::exchange::Moment;
use super::mean::Mean;

/// Means over the valid samples since the last message, and the last sample's flags.
#[derive(Default)]
pub(super) struct Recent<const C: usize, const A: usize> {
    raw: Mean<C, A>,
    bias: Mean<C, A>,
    samples: u32,
    status: Option<[Status; C]>,
    /// Time of the last message.
    sent_ms: Option<u32>,
}

/// What a message says of them.
pub(super) struct Means<const C: usize, const A: usize> {
    /// NaN where no sample was valid.
    pub(super) raw: [[f32; A]; C],
    pub(super) bias: [[f32; A]; C],
    /// None before the first sample.
    pub(super) status: Option<[Status; C]>,
}

impl<const C: usize, const A: usize> Recent<C, A> {
    /// Takes a sample.
    pub(super) fn add(&mut self, moment: &Moment<C, A>) {
        let mut flags = moment.status.iter();
        if !flags.any(|status| status.intersects(Status::RAW_INVALID)) {
            self.raw.add(&moment.raw);
            self.bias.add(&moment.bias);
        }
        self.samples = self.samples.saturating_add(1);
        self.status = Some(moment.status);
    }

    /// Samples since the last message, valid or not.
    pub(super) const fn samples(&self) -> u32 {
        self.samples
    }

    /// Whether there is a sample, and a later time, since the last message.
    pub(super) fn has_news(&self, now_ms: u32) -> bool {
        self.samples > 0 && self.sent_ms != Some(now_ms)
    }

    /// The means for a message that is sent now.
    pub(super) fn take(&mut self, now_ms: u32) -> Means<C, A> {
        self.sent_ms = Some(now_ms);
        self.samples = 0;
        let is_valid = self.raw.count() > 0;
        let mean = |mean: &mut Mean<C, A>| core::mem::take(mean).means();
        let raw = mean(&mut self.raw);
        Means {
            raw: if is_valid { raw } else { [[f32::NAN; A]; C] },
            bias: mean(&mut self.bias),
            status: self.status,
        }
    }
}
