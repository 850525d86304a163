//! Logs in place of the gyro: rows through a compensator of their own, blocks through the sampling
//! interrupt.

use tempco_link::{Outcome, OutcomeBlock, Refusal, Response, Sample, SampleBlock};
use tempco_replay::{Outcome as Replayed, Replay, Sample as ReplayedSample};

use super::devices::{Flash, SampleClock, Thermometers};
use super::exchange::Injected;
use super::service::Service;
use super::wire::{array, axes, channels, per_axis};

impl<F, T, K, const C: usize, const A: usize> Service<'_, F, T, K, C, A>
where
    F: Flash,
    T: Thermometers<C>,
    K: SampleClock,
{
    /// The next sample or block is the first one after power-on.
    pub(super) fn restart(&mut self) {
        self.replay = None;
        self.inject(Injected::Restart);
    }

    /// One row of any log.
    pub(super) fn step(&mut self, sample: &Sample) -> Response<'static> {
        let (Some(temps_c), Some(raw)) = (array(&sample.temps_c), per_axis(&sample.raw)) else {
            return Response::Refused(Refusal::Unknown);
        };
        let Some((tables, _)) = self.tables else {
            return Response::Refused(Refusal::Unsupported);
        };
        let replay = self.replay.get_or_insert_with(|| Replay::new(tables));
        let outcome = replay.step(&ReplayedSample {
            dt_s: sample.dt_s,
            temps_c,
            raw,
        });
        let of = |part: fn(&tempco_replay::ChannelOutcome<A>) -> [f32; A]| {
            axes(&outcome.channels.each_ref().map(part))
        };
        Response::Outcome(Outcome {
            channels: channels(&outcome),
            bias: of(|channel| channel.bias),
            compensated: of(|channel| channel.compensated),
        })
    }

    /// Samples at the gyro's rate, through the interrupt.
    pub(super) fn block(&mut self, block: &SampleBlock) -> Response<'_> {
        let temps_c = array(&block.temps_c);
        let has_temperatures = temps_c.is_some() || block.temps_c.is_empty();
        let values = block.values().filter(|values| {
            has_temperatures && values.len() > 0 && values.len().is_multiple_of(C * A)
        });
        let Some(mut values) = values else {
            return Response::Refused(Refusal::Unknown);
        };
        if let Some(temps_c) = temps_c {
            self.inject(Injected::Temperatures(temps_c));
        }
        let samples = values.len() / (C * A);
        for _ in 0..samples {
            let raw = core::array::from_fn(|_| {
                core::array::from_fn(|_| values.next().unwrap_or(f32::NAN))
            });
            self.inject(Injected::Sample(raw));
        }
        self.block.clear();
        let mut last = None;
        for _ in 0..samples {
            let Some(outcome) = self.reply(block.real_time) else {
                return Response::Refused(Refusal::Busy);
            };
            for value in outcome
                .channels
                .iter()
                .flat_map(|channel| &channel.compensated)
            {
                // Cannot fail: there are as many as came in.
                _ = self.block.extend_from_slice(&value.to_le_bytes());
            }
            last = Some(outcome);
        }
        let Some(last) = last else {
            return Response::Refused(Refusal::Unknown);
        };
        Response::Block(OutcomeBlock {
            channels: channels(&last),
            bias: axes(&last.channels.each_ref().map(|channel| channel.bias)),
            compensated: &self.block,
        })
    }

    /// Cannot fail: the queue has room for a block, and is empty between two.
    fn inject(&mut self, injected: Injected<C, A>) {
        _ = self.ends.injected.enqueue(injected);
    }

    /// What the interrupt made of the next injected sample; none if it did not come in time.
    fn reply(&mut self, real_time: bool) -> Option<Replayed<C, A>> {
        const LATEST: u32 = 4;
        let from = self.ends.counts.samples();
        // Other interrupts end a sleep too, so it is the gyro's samples that count.
        while self.ends.counts.samples().wrapping_sub(from) < LATEST {
            if let Some(outcome) = self.ends.replies.dequeue() {
                return Some(outcome);
            }
            if real_time {
                self.clock.sleep();
            } else {
                self.clock.interrupt_now();
            }
            self.drain();
        }
        None
    }
}
