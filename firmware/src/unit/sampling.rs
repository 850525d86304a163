//! All that the sampling interrupt does.

use core::sync::atomic::{AtomicU32, Ordering};

use tempco::Status;
use tempco_replay::{ChannelOutcome, Outcome, Schedule};

use super::devices::{Gyro, SampleClock};
use super::exchange::{Injected, InterruptEnds, Moment};
use super::{UnitStream, UnitTables};

/// The interrupt's own state. Nothing in it waits, and nothing depends on what a sample is.
pub struct Sampling<'t, G, const C: usize, const A: usize> {
    gyro: G,
    ends: InterruptEnds<'t, C, A>,
    schedule: Schedule,
    /// From counts to the unit of the axis.
    scale: [[f32; A]; C],
    /// Constant biases found by re-zero \[unit of the axis\].
    offsets: [[f32; A]; C],
    /// Without a table there is nothing to take out.
    gyro_stream: Option<UnitStream<'t, C, A>>,
    replay_stream: Option<UnitStream<'t, C, A>>,
    /// Before the first replay, so that each begins alike.
    fresh: Option<UnitStream<'t, C, A>>,
    /// Samples until the next temperatures are due.
    until_update: u16,
    has_temperatures: bool,
}

impl<'t, G: Gyro<C, A>, const C: usize, const A: usize> Sampling<'t, G, C, A> {
    /// The state before the first interrupt. `scale` turns counts into the unit of each axis.
    pub fn new(
        gyro: G,
        ends: InterruptEnds<'t, C, A>,
        tables: Option<&'t UnitTables<'t, C, A>>,
        schedule: Schedule,
        scale: [[f32; A]; C],
        offsets: [[f32; A]; C],
    ) -> Self {
        let fresh = tables.map(|tables| UnitStream::new(tables, &schedule));
        Self {
            gyro,
            ends,
            schedule,
            scale,
            offsets,
            gyro_stream: fresh.clone(),
            replay_stream: fresh.clone(),
            fresh,
            until_update: 0,
            has_temperatures: false,
        }
    }

    /// Carries out an interrupt: the gyro's sample if the timer `is_due`, and one that is replayed
    /// if there is one.
    pub fn interrupt(&mut self, is_due: bool, clock: &impl SampleClock) {
        let begun = clock.since_interrupt();
        if is_due {
            let counts = self.gyro.counts();
            let moment = self.measure(counts);
            self.gyro.put(&moment.outcome);
            let latency = clock.since_interrupt();
            raise(&self.ends.counts.latency, latency);
            let is_lost = self.ends.moments.enqueue(moment).is_err();
            self.count(is_lost);
            self.prepare();
        }
        self.replay();
        // The next period has begun: its sample comes late, or not at all.
        self.count(is_due && clock.since_interrupt() < begun);
    }

    fn measure(&mut self, counts: [[i32; A]; C]) -> Moment<C, A> {
        let each =
            |channel: usize, axis: usize| counts[channel][axis] as f32 * self.scale[channel][axis];
        let raw = core::array::from_fn(|channel| core::array::from_fn(|axis| each(channel, axis)));
        let mut outcome = sample(self.gyro_stream.as_mut(), &raw);
        for (channel, offsets) in outcome.channels.iter_mut().zip(&self.offsets) {
            for (value, offset) in channel.compensated.iter_mut().zip(offsets) {
                *value -= offset;
            }
        }
        let samples = &self.ends.counts.samples;
        samples.store(
            samples.load(Ordering::Relaxed).wrapping_add(1),
            Ordering::Relaxed,
        );
        Moment { raw, outcome }
    }

    /// All that the next sample needs and this one need not wait for: offsets, and on schedule
    /// temperatures; where the main loop has sent none in time, they count as missing.
    fn prepare(&mut self) {
        if let Some(offsets) = self.ends.offsets.dequeue() {
            self.offsets = offsets;
        }
        if !self.has_temperatures {
            // Half a period after the first ones were there, so that the main loop may be late by
            // as much with all that follow.
            self.has_temperatures = self.ends.temperatures.ready();
            self.until_update = self.schedule.samples_per_update / 2;
            return;
        }
        if let Some(left) = self.until_update.checked_sub(1) {
            self.until_update = left;
            return;
        }
        let found = self.ends.temperatures.dequeue();
        self.until_update = self.schedule.samples_per_update.saturating_sub(1);
        if let Some(stream) = &mut self.gyro_stream {
            stream.temperatures(&found.unwrap_or([f32::NAN; C]));
            self.ends
                .counts
                .rejected
                .store(stream.rejected(), Ordering::Relaxed);
        }
    }

    fn replay(&mut self) {
        while let Some(injected) = self.ends.injected.dequeue() {
            match injected {
                Injected::Restart => self.replay_stream.clone_from(&self.fresh),
                Injected::Temperatures(temps_c) => {
                    if let Some(stream) = &mut self.replay_stream {
                        stream.temperatures(&temps_c);
                    }
                }
                Injected::Sample(raw) => {
                    let outcome = sample(self.replay_stream.as_mut(), &raw);
                    let is_lost = self.ends.replies.enqueue(outcome).is_err();
                    self.count(is_lost);
                    // One sample per interrupt, as of the gyro.
                    return;
                }
            }
        }
    }

    fn count(&self, is_overrun: bool) {
        let overruns = &self.ends.counts.overruns;
        let count = overruns.load(Ordering::Relaxed);
        overruns.store(count.saturating_add(is_overrun.into()), Ordering::Relaxed);
    }
}

/// Load and store suffice: there is one writer.
fn raise(highest: &AtomicU32, value: u32) {
    highest.store(
        highest.load(Ordering::Relaxed).max(value),
        Ordering::Relaxed,
    );
}

/// Without a table the sample goes out as it is, and is marked as not to be used.
fn sample<const C: usize, const A: usize>(
    stream: Option<&mut UnitStream<'_, C, A>>,
    raw: &[[f32; A]; C],
) -> Outcome<C, A> {
    match stream {
        Some(stream) => stream.sample(raw),
        None => Outcome {
            channels: raw.map(|raw| ChannelOutcome {
                effective_c: f32::NAN,
                rate_c_per_min: f32::NAN,
                status: u32::from((Status::TEMPERATURE_LOST | Status::of_raw(&raw)).bits()),
                bias: [0.0; A],
                compensated: raw,
            }),
        },
    }
}

#[cfg(test)]
mod tests {
    use core::cell::Cell;

    use tempco::{Table, Terms, Thermal, ThermalSettings};

    use super::super::exchange::{Counts, Queues};
    use super::*;

    struct Still;

    impl Gyro<1, 1> for Still {
        const PULSES_PER_COUNT: f32 = 1.0;

        fn counts(&mut self) -> [[i32; 1]; 1] {
            [[0]]
        }

        fn put(&mut self, _: &Outcome<1, 1>) {}
    }

    /// Advances by what it is told at every look.
    struct Clock {
        now: Cell<u32>,
        step: u32,
    }

    impl SampleClock for Clock {
        const COUNT_NS: u32 = 1;

        fn since_interrupt(&self) -> u32 {
            self.now.set((self.now.get() + self.step) % self.period());
            self.now.get()
        }

        fn period(&self) -> u32 {
            1000
        }

        fn sleep(&self) -> u32 {
            0
        }

        fn interrupt_now(&self) {}
    }

    #[test]
    fn temperatures_that_do_not_come_count_as_missing() {
        const CELLS: [[Terms; 1]; 1] = [[Terms {
            a: [1.0, 0.0, 0.0],
            r: [0.0, 0.0],
        }]];
        let thermal = Thermal::new(ThermalSettings::DEFAULT).unwrap();
        let table = Table::new(thermal, -40.0, 80.0, &CELLS).unwrap();
        let none = tempco::Play {
            half_width_c: 0.0,
            gain: [0.0],
        };
        let slow = tempco::SlowPart {
            tau_s: 600.0,
            limit_c: 0.0,
            gain: [0.0],
        };
        let tables = [table.with_history([none; 2], [slow]).unwrap()];
        let schedule = Schedule {
            sample_rate_hz: 100.0,
            samples_per_update: 10,
        };
        let counts = Counts::new();
        let mut queues = Queues::new();
        let (ends, mut main) = queues.split(&counts);
        let (unit, zero) = ([[1.0]], [[0.0]]);
        let mut sampling = Sampling::new(Still, ends, Some(&tables), schedule, unit, zero);
        let clock = Clock {
            now: Cell::new(0),
            step: 0,
        };
        let mut status = |count: u32| {
            let mut last = Status::OK;
            for _ in 0..count {
                sampling.interrupt(true, &clock);
                last = main.moments.dequeue().unwrap().outcome.channels[0].flags();
            }
            last
        };
        // The schedule begins half a period after the first temperatures.
        assert!(status(35).contains(Status::TEMPERATURE_LOST));
        main.temperatures.enqueue([25.0]).unwrap();
        assert!(status(5).contains(Status::TEMPERATURE_LOST));
        assert!(!status(5).intersects(Status::TEMPERATURE_LOST | Status::TEMPERATURE_INVALID));
        assert!(status(10).contains(Status::TEMPERATURE_INVALID));
        assert_eq!(counts.overruns.load(Ordering::Relaxed), 0);
    }

    #[test]
    fn an_interrupt_that_takes_more_than_its_period_is_an_overrun() {
        let schedule = Schedule {
            sample_rate_hz: 100.0,
            samples_per_update: 10,
        };
        for (step, is_due, overruns) in [(10, true, 0), (400, true, 1), (600, false, 0)] {
            let counts = Counts::new();
            let mut queues = Queues::new();
            let (ends, _main) = queues.split(&counts);
            let mut sampling = Sampling::new(Still, ends, None, schedule, [[1.0]], [[0.0]]);
            let clock = Clock {
                now: Cell::new(0),
                step,
            };
            sampling.interrupt(is_due, &clock);
            assert_eq!(
                counts.overruns.load(Ordering::Relaxed),
                overruns,
                "{step} {is_due}"
            );
        }
    }
}
