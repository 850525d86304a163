//! Logs in place of the gyro: rows through a compensator of their own, blocks through the sampling
//! interrupt.

use tempco::{Output, ThermalPoint};
use tempco_link::{
    BlockCrc, ChannelTelemetry, Channels, Outcome, OutcomeBlock, Refusal, Response, Sample,
    SampleBlock,
};
use tempco_replay::{ChannelOutcome, Outcome as Replayed, Replay, Sample as ReplayedSample};

use super::UnitThermal;
use super::devices::{Flash, SampleClock, Thermometers};
use super::exchange::{Reply, publish};
use super::in_use::InUse;
use super::service::{Service, constant};
use super::wire::{array, axes, per_axis};

impl<F, T, K, const C: usize, const A: usize> Service<'_, F, T, K, C, A>
where
    F: Flash,
    T: Thermometers<C>,
    K: SampleClock,
{
    /// The next sample or block is the first one after power-on.
    pub(super) fn restart(&mut self) {
        self.replay = None;
        let samples_per_update = self.schedule.samples_per_update;
        self.replay_thermal = self
            .in_use
            .as_ref()
            .map(|in_use| UnitThermal::new(in_use.tables(), samples_per_update));
        publish(
            self.ends.replay_ramps,
            &constant(self.replay_thermal.as_ref()),
        );
    }

    /// One row of any log.
    pub(super) fn step(&mut self, sample: &Sample) -> Response<'static> {
        let (Some(temps_c), Some(raw)) = (array(&sample.temps_c), per_axis(&sample.raw)) else {
            return Response::Refused(Refusal::Unknown);
        };
        let Some(tables) = self.in_use.as_ref().map(InUse::tables) else {
            return Response::Refused(Refusal::Unsupported);
        };
        let replay = self.replay.get_or_insert_with(|| Replay::new(tables));
        let outcome = replay.step(&ReplayedSample {
            update_s: sample.update_s,
            temps_c,
            raw,
        });
        let of = |part: fn(&tempco_replay::ChannelOutcome<A>) -> [f32; A]| {
            axes(&outcome.channels.each_ref().map(part))
        };
        Response::Outcome(Outcome {
            channels: states(&outcome),
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
        // All replies to former samples have come, so that the interrupt takes the ramps over with
        // the first sample of this block.
        if let (Some(temps_c), Some(thermal)) = (temps_c, &mut self.replay_thermal) {
            let ramps = thermal.update(self.schedule.update_interval_s(), &temps_c);
            publish(self.ends.replay_ramps, &ramps);
        }
        let samples = values.len() / (C * A);
        for _ in 0..samples {
            let raw = core::array::from_fn(|_| {
                core::array::from_fn(|_| values.next().unwrap_or(f32::NAN))
            });
            self.inject(raw);
        }
        let points = self.points(self.replay_thermal.as_ref());
        self.block.clear();
        let mut crc = BlockCrc::default();
        let mut last = None;
        for _ in 0..samples {
            let Some(reply) = self.reply(block.real_time) else {
                return Response::Refused(Refusal::Busy);
            };
            let outcome = outcome(&points, &reply);
            for channel in &outcome.channels {
                crc.add(channel.status, &channel.bias);
                for value in &channel.compensated {
                    // Cannot fail: there are as many as came in.
                    _ = self.block.extend_from_slice(&value.to_le_bytes());
                }
            }
            last = Some(outcome);
        }
        let Some(last) = last else {
            return Response::Refused(Refusal::Unknown);
        };
        Response::Block(OutcomeBlock {
            channels: states(&last),
            bias: axes(&last.channels.each_ref().map(|channel| channel.bias)),
            compensated: &self.block,
            crc: crc.finish(),
        })
    }

    /// Hands a sample to the interrupt. Out of line, since the compiler would make the loop of the
    /// caller twice, once for a queue of another length.
    #[inline(never)]
    fn inject(&mut self, raw: [[f32; A]; C]) {
        // Cannot fail: the queue has room for a block, and is empty between two.
        _ = self.ends.injected.enqueue(raw);
    }

    /// What the interrupt made of the next injected sample; none if it did not come in time.
    fn reply(&mut self, real_time: bool) -> Option<Reply<C, A>> {
        const LATEST: u32 = 4;
        let from = self.ends.counts.ticks();
        // Other interrupts end a sleep too, so it is the timer's that count.
        while self.ends.counts.ticks().wrapping_sub(from) < LATEST {
            if let Some(reply) = self.ends.replies.dequeue() {
                return Some(reply);
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

/// A reply with what the thermal half knows.
fn outcome<const C: usize, const A: usize>(
    points: &[ThermalPoint; C],
    reply: &Reply<C, A>,
) -> Replayed<C, A> {
    let channel = |channel: usize| Output {
        compensated: reply.compensated[channel],
        bias: reply.bias[channel],
        point: points[channel],
        status: reply.status[channel],
    };
    core::array::from_fn(channel).into()
}

/// The state of each channel.
fn states<const C: usize, const A: usize>(outcome: &Replayed<C, A>) -> Channels<ChannelTelemetry> {
    let state = |channel: &ChannelOutcome<A>| ChannelTelemetry {
        effective_c: channel.effective_c,
        rate_c_per_min: channel.rate_c_per_min,
        status: channel.flags().bits(),
    };
    outcome.channels.iter().map(state).collect()
}
