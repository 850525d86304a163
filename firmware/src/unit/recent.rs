//! The samples since the last message of telemetry.

use tempco_link::{Axes, Channels, Outcome};

use super::exchange::Moment;
use super::mean::Mean;
use super::wire::{axes, channels};

/// Means since the last message, and the last sample.
#[derive(Default)]
pub(super) struct Recent<const C: usize, const A: usize> {
    raw: Mean<C, A>,
    bias: Mean<C, A>,
    compensated: Mean<C, A>,
    last: Option<Moment<C, A>>,
    /// Time of the last message.
    sent_ms: Option<u32>,
}

impl<const C: usize, const A: usize> Recent<C, A> {
    /// Takes a sample.
    pub(super) fn add(&mut self, moment: &Moment<C, A>) {
        let channels = moment.outcome.channels.each_ref();
        self.raw.add(moment.raw.each_ref());
        self.bias.add(channels.map(|channel| &channel.bias));
        self.compensated
            .add(channels.map(|channel| &channel.compensated));
        self.last = Some(*moment);
    }

    /// Whether there is a sample, and a later time, since the last message.
    pub(super) fn has_news(&self, now_ms: u32) -> bool {
        self.raw.count() > 0 && self.sent_ms != Some(now_ms)
    }

    /// The means of the samples and of their outcomes, for a message that is sent now.
    pub(super) fn take(&mut self, now_ms: u32) -> (Axes, Outcome) {
        self.sent_ms = Some(now_ms);
        let mean = |mean: &mut Mean<C, A>| axes(&core::mem::take(mean).means());
        let outcome = Outcome {
            channels: match &self.last {
                Some(moment) => channels(&moment.outcome),
                None => Channels::new(),
            },
            bias: mean(&mut self.bias),
            compensated: mean(&mut self.compensated),
        };
        (mean(&mut self.raw), outcome)
    }
}
