//! All that the sampling interrupt does.

use core::sync::atomic::{AtomicU32, Ordering};

use tempco::{Schedule, Status};
use tempco_replay::{ChannelOutcome, Outcome};

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
    /// The free-running counter at the last sample, and when the period of that began.
    free: u32,
    begun: u32,
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
            free: 0,
            begun: 0,
            until_update: 0,
            has_temperatures: false,
        }
    }

    /// Remembers the time of the clock, which has just been started.
    pub fn start(&mut self, clock: &impl SampleClock) {
        self.free = clock.free_running();
        self.begun = self.free;
    }

    /// Carries out an interrupt: the gyro's sample if the timer `is_due`, and one that is replayed
    /// if there is one.
    pub fn interrupt<K: SampleClock>(&mut self, is_due: bool, clock: &K) {
        // Now, so that a period that begins between the two readings changes nothing below.
        let free = clock.free_running();
        let entry = clock.since_interrupt();
        if is_due {
            let counts = self.gyro.counts();
            let moment = self.measure(counts);
            self.gyro.put(&moment.outcome);
            let output = clock.since_interrupt();
            // The timer may have come round meanwhile.
            let round = if output < entry { clock.period() } else { 0 };
            raise(&self.ends.counts.latency, output + round);
            if self.ends.moments.enqueue(moment).is_err() {
                add(&self.ends.counts.lost_moments, 1);
            }
            self.count_missed::<K>(free, entry, clock.period());
            self.prepare();
        }
        self.replay();
    }

    /// Counts the periods since the last sample in which none was taken: the interrupts of several
    /// periods that could not come are one. A counter that stands still, such as one that an
    /// emulator lacks, counts none.
    fn count_missed<K: SampleClock>(&mut self, free: u32, since_interrupt: u32, period: u32) {
        let per_period = K::FREE_PER_PERIOD;
        let begun = free.wrapping_sub(since_interrupt * per_period / period);
        let elapsed = begun.wrapping_sub(self.begun);
        self.begun = begun;
        if core::mem::replace(&mut self.free, free) == free {
            return;
        }
        // To the nearest whole number: either counter may be a count ahead of the other.
        let periods = (elapsed.wrapping_add(per_period / 2) & K::FREE_MAX) / per_period;
        add(&self.ends.counts.missed, periods.saturating_sub(1));
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
        add(&self.ends.counts.samples, 1);
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
                    if self.ends.replies.enqueue(outcome).is_err() {
                        add(&self.ends.counts.lost_replies, 1);
                    }
                    // One sample per interrupt, as of the gyro.
                    return;
                }
            }
        }
    }
}

/// Load and store suffice: there is one writer.
fn add(count: &AtomicU32, more: u32) {
    let sum = count.load(Ordering::Relaxed).wrapping_add(more);
    count.store(sum, Ordering::Relaxed);
}

/// As [`add`].
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
        Some(stream) => stream.sample(raw).into(),
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
    use std::rc::Rc;

    use tempco::{Table, Terms, Thermal, ThermalSettings};

    use super::super::devices::AtRest;
    use super::super::exchange::{Counts, Queues};
    use super::*;

    const PERIOD: u32 = 1000;

    /// A gyro whose output takes time.
    struct Slow {
        now: Rc<Cell<u32>>,
        takes: Rc<Cell<u32>>,
    }

    impl Gyro<1, 1> for Slow {
        const PULSES_PER_COUNT: f32 = 1.0;
        const SCALE_FACTOR_ARCSEC: f32 = 1.0;
        const AT_REST: AtRest = AtRest {
            sigma: 0.0,
            max_bias: 0.0,
        };

        fn counts(&mut self) -> [[i32; 1]; 1] {
            [[0]]
        }

        fn put(&mut self, _: &Outcome<1, 1>) {
            self.now.set(self.now.get().wrapping_add(self.takes.get()));
        }
    }

    /// A timer of `PERIOD` counts, and a counter of `PER` counts per period and 16 bits, or as many
    /// as the timer; unless it runs, it stands still.
    struct Clock<const PER: u32, const RUNS: bool = true>(Rc<Cell<u32>>);

    impl<const PER: u32, const RUNS: bool> SampleClock for Clock<PER, RUNS> {
        const COUNT_NS: u32 = 1;
        const FREE_PER_PERIOD: u32 = PER;
        const FREE_MAX: u32 = if PER == PERIOD { u32::MAX } else { 0xffff };

        fn since_interrupt(&self) -> u32 {
            self.0.get() % PERIOD
        }

        fn period(&self) -> u32 {
            PERIOD
        }

        fn sleep(&self) -> u32 {
            0
        }

        fn interrupt_now(&self) {}

        fn free_running(&self) -> u32 {
            if !RUNS {
                return 0;
            }
            // Its counts do not begin with the periods.
            (u64::from(self.0.get() + 77) * u64::from(PER) / u64::from(PERIOD)) as u32
                & Self::FREE_MAX
        }
    }

    const SCHEDULE: Schedule = Schedule {
        sample_rate_hz: 100.0,
        samples_per_update: 10,
    };

    #[test]
    fn temperatures_that_do_not_come_count_as_missing() {
        const CELLS: [[Terms; 1]; 1] = [[Terms::new([1.0, 0.0, 0.0], [0.0, 0.0])]];
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
        let counts = Counts::new();
        let mut queues = Queues::new();
        let (ends, mut main) = queues.split(&counts);
        let (now, takes) = (Rc::new(Cell::new(0)), Rc::default());
        let gyro = Slow {
            now: now.clone(),
            takes,
        };
        let (unit, zero) = ([[1.0]], [[0.0]]);
        let mut sampling = Sampling::new(gyro, ends, Some(&tables), SCHEDULE, unit, zero);
        let clock = Clock::<PERIOD>(now.clone());
        let mut status = |count: u32| {
            let mut last = Status::OK;
            for _ in 0..count {
                now.set(now.get() + PERIOD);
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
        assert_eq!(counts.losses(), tempco_link::Losses::default());
    }

    /// Runs interrupts that are entered after `delay` counts and take each of `lengths`, as a
    /// processor does: what comes while one runs waits, and several wait as one. Returns samples
    /// taken and missed, and the periods that began before the last entry.
    fn run<const PER: u32, const RUNS: bool>(delay: u32, lengths: &[u32]) -> (u32, u32, u32) {
        let (now, takes) = (Rc::new(Cell::new(0)), Rc::new(Cell::new(0)));
        let counts = Counts::new();
        let mut queues = Queues::new();
        let (ends, mut main) = queues.split(&counts);
        let gyro = Slow {
            now: now.clone(),
            takes: takes.clone(),
        };
        let mut sampling = Sampling::new(gyro, ends, None, SCHEDULE, [[1.0]], [[0.0]]);
        let clock = Clock::<PER, RUNS>(now.clone());
        sampling.start(&clock);
        let mut seen = 0;
        for length in lengths {
            // The next period that has not been seen, or at once if it has begun already.
            let due = ((seen + 1) * PERIOD).max(now.get()) + delay;
            now.set(due);
            seen = due / PERIOD;
            takes.set(*length);
            sampling.interrupt(true, &clock);
            main.moments.dequeue().unwrap();
        }
        let missed = counts.losses().missed_samples;
        (counts.samples(), missed, seen)
    }

    /// Every delay of the entry from none to a whole period, interrupts of up to twelve periods.
    #[test]
    fn samples_taken_and_missed_are_the_periods_that_have_begun() {
        for delay in (0..=PERIOD).step_by(10) {
            for length in (0..=12 * PERIOD).step_by(50) {
                let lengths = [length, 0, length, length / 3, length, 0, 0];
                for (taken, missed, begun) in [
                    run::<PERIOD, true>(delay, &lengths),
                    run::<5, true>(delay, &lengths),
                    run::<7, true>(delay, &lengths),
                ] {
                    assert_eq!(taken, lengths.len() as u32);
                    assert_eq!(taken + missed, begun, "{delay} {length}");
                }
                let (taken, missed, _) = run::<5, false>(delay, &lengths);
                assert_eq!((taken, missed), (lengths.len() as u32, 0), "none runs");
            }
        }
        // As found: not one of these was counted.
        let (taken, missed, begun) = run::<PERIOD, true>(0, &[1000, 1200, 1500, 2500, 10_500, 0]);
        assert_eq!((taken, missed, begun), (6, 11, 17));
    }

    #[test]
    fn latency_is_known_beyond_the_end_of_the_period() {
        let (now, takes) = (Rc::new(Cell::new(PERIOD + 300)), Rc::new(Cell::new(900)));
        let counts = Counts::new();
        let mut queues = Queues::new();
        let (ends, _main) = queues.split(&counts);
        let gyro = Slow {
            now: now.clone(),
            takes,
        };
        let mut sampling = Sampling::new(gyro, ends, None, SCHEDULE, [[1.0]], [[0.0]]);
        sampling.interrupt(true, &Clock::<PERIOD>(now));
        assert_eq!(counts.latency.load(Ordering::Relaxed), 1200);
    }

    #[test]
    fn what_finds_no_place_is_counted_apart() {
        let now = Rc::new(Cell::new(0));
        let counts = Counts::new();
        let mut queues = Queues::new();
        let (ends, mut main) = queues.split(&counts);
        let gyro = Slow {
            now: now.clone(),
            takes: Rc::default(),
        };
        let mut sampling = Sampling::new(gyro, ends, None, SCHEDULE, [[1.0]], [[0.0]]);
        let clock = Clock::<PERIOD>(now.clone());
        for _ in 0..300 {
            now.set(now.get() + PERIOD);
            main.injected.enqueue(Injected::Sample([[1.0]])).unwrap();
            sampling.interrupt(true, &clock);
        }
        let losses = counts.losses();
        assert_eq!(losses.missed_samples, 0);
        assert_eq!((losses.moments, losses.replies), (300 - 127, 300 - 255));
    }
}
