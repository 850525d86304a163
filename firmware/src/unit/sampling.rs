//! All that the sampling interrupt does.

use core::sync::atomic::{AtomicU32, Ordering};

use tempco::{Corrector, Status};

use super::devices::{Clock, Gyro, Lost, SampleClock};
use super::exchange::{InterruptEnds, Moment, Reply, add};

/// The interrupt's own state. Nothing in it waits, and nothing depends on what a sample is.
pub struct Sampling<'t, G, const C: usize, const A: usize> {
    gyro: G,
    ends: InterruptEnds<'t, C, A>,
    /// From counts to the unit of the axis.
    scale: [[f32; A]; C],
    correctors: [Corrector<'t, A>; C],
    replay_correctors: [Corrector<'t, A>; C],
    /// The free-running counter at the last period, and when that began.
    free: u32,
    begun: u32,
    /// Periods since the last sample of a gyro with a clock of its own, and since the last look.
    silent: u16,
    unwatched: u16,
}

impl<'t, G: Gyro<C, A>, const C: usize, const A: usize> Sampling<'t, G, C, A> {
    /// The state before the first interrupt. `scale` turns counts into the unit of each axis.
    pub fn new(gyro: G, ends: InterruptEnds<'t, C, A>, scale: [[f32; A]; C]) -> Self {
        Self {
            gyro,
            scale,
            correctors: ends.ramps.each_ref().map(Corrector::new),
            replay_correctors: ends.replay_ramps.each_ref().map(Corrector::new),
            ends,
            free: 0,
            begun: 0,
            silent: 0,
            unwatched: 0,
        }
    }

    /// Remembers the time of the clock, which has just been started.
    pub fn start(&mut self, clock: &impl SampleClock) {
        self.free = clock.free_running();
        self.begun = self.free;
    }

    /// Carries out an interrupt, of the timer if it `is_due`: the samples that the gyro has, and one
    /// that is replayed if there is one.
    pub fn interrupt<K: SampleClock>(&mut self, is_due: bool, clock: &K) {
        // Now, so that a period that begins between the two readings changes nothing below.
        let free = clock.free_running();
        let entry = clock.since_interrupt();
        let mut has_samples = false;
        match G::CLOCK {
            // The latency is from when the sample was due, which is when the period began.
            Clock::Timer if is_due => self.sample(entry, clock),
            Clock::Timer => {}
            Clock::Own {
                look_after,
                silent_after,
            } => {
                has_samples = self.block(entry, clock);
                if has_samples {
                    (self.silent, self.unwatched) = (0, 0);
                } else if is_due {
                    self.watch(look_after, silent_after);
                }
            }
        }
        if is_due {
            add(&self.ends.counts.ticks, 1);
            self.count_missed::<K>(free, entry, clock.period());
        }
        // An interrupt for the sake of samples is no further one for the replay.
        if is_due || !has_samples {
            self.replay();
        }
    }

    /// The sample of a period.
    fn sample<K: SampleClock>(&mut self, entry: u32, clock: &K) {
        let Some(counts) = self.gyro.sample() else {
            return;
        };
        let moment = self.give(self.scaled(counts));
        self.raise_latency(0, entry, clock);
        add(&self.ends.counts.samples, 1);
        self.keep(moment);
    }

    /// All samples that a gyro with a clock of its own has; whether there were any. The latency is
    /// from the interrupt to the last of them.
    fn block<K: SampleClock>(&mut self, entry: u32, clock: &K) -> bool {
        let mut count = 0;
        while let Some(counts) = self.gyro.sample() {
            let moment = self.give(self.scaled(counts));
            self.keep(moment);
            count += 1;
        }
        if count > 0 {
            self.raise_latency(entry, entry, clock);
            add(&self.ends.counts.samples, count);
        }
        let Lost {
            samples,
            data_ready,
        } = self.gyro.lost();
        add(&self.ends.counts.lost, samples);
        add(&self.ends.counts.data_ready, data_ready);
        count > 0
    }

    /// A period without a sample of a gyro that has a clock of its own.
    fn watch(&mut self, look_after: u16, silent_after: u16) {
        self.silent = self.silent.saturating_add(1);
        self.unwatched += 1;
        if self.unwatched >= look_after {
            self.unwatched = 0;
            self.gyro.look();
        }
        if self.silent >= silent_after {
            add(&self.ends.counts.silent, 1);
            let moment = self.give([[f32::NAN; A]; C]);
            self.keep(moment);
        }
    }

    /// Takes the bias out of a sample, and sends it on.
    fn give(&mut self, raw: [[f32; A]; C]) -> Moment<C, A> {
        let (bias, mut status) = advance(&mut self.correctors);
        if G::INVALID.is_some() || matches!(G::CLOCK, Clock::Own { .. }) {
            for (status, raw) in status.iter_mut().zip(&raw) {
                *status |= Status::of_raw(raw);
            }
        }
        self.gyro.put(&difference(&raw, &bias), &status);
        Moment { raw, bias, status }
    }

    /// Keeps a sample for the main loop.
    fn keep(&mut self, moment: Moment<C, A>) {
        if self.ends.moments.enqueue(moment).is_err() {
            add(&self.ends.counts.lost_moments, 1);
        }
    }

    /// Time from `from` until now, given when the interrupt was entered.
    fn raise_latency<K: SampleClock>(&self, from: u32, entry: u32, clock: &K) {
        let output = clock.since_interrupt();
        // The timer may have come round meanwhile.
        let round = if output < entry { clock.period() } else { 0 };
        raise(&self.ends.counts.latency, output + round - from);
    }

    /// Counts the periods since the last interrupt of the timer that had none: the interrupts of
    /// several periods that could not come are one. A counter that stands still, such as one that
    /// an emulator lacks, counts none.
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
        let missed = periods.saturating_sub(1);
        add(&self.ends.counts.missed, missed);
        // A part with a clock of its own may have kept the samples.
        if G::CLOCK == Clock::Timer {
            add(&self.ends.counts.lost, missed);
        }
    }

    fn scaled(&self, counts: [[i32; A]; C]) -> [[f32; A]; C] {
        let each = |channel: usize, axis: usize| match counts[channel][axis] {
            count if Some(count) == G::INVALID => f32::NAN,
            count => count as f32 * self.scale[channel][axis],
        };
        core::array::from_fn(|channel| core::array::from_fn(|axis| each(channel, axis)))
    }

    /// One sample per interrupt, as of the gyro.
    fn replay(&mut self) {
        let Some(raw) = self.ends.injected.dequeue() else {
            return;
        };
        let (bias, status) = advance(&mut self.replay_correctors);
        let reply = Reply {
            compensated: difference(&raw, &bias),
            bias,
            status: core::array::from_fn(|channel| status[channel] | Status::of_raw(&raw[channel])),
        };
        if self.ends.replies.enqueue(reply).is_err() {
            add(&self.ends.counts.lost_replies, 1);
        }
    }
}

/// The biases of the next sample, and their flags.
fn advance<const C: usize, const A: usize>(
    correctors: &mut [Corrector<'_, A>; C],
) -> ([[f32; A]; C], [Status; C]) {
    let next = correctors.each_mut().map(Corrector::advance::<1>);
    (next.map(|(bias, _)| bias), next.map(|(_, status)| status))
}

/// The samples of all axes without their biases.
pub(super) fn difference<const C: usize, const A: usize>(
    raw: &[[f32; A]; C],
    bias: &[[f32; A]; C],
) -> [[f32; A]; C] {
    core::array::from_fn(|channel| {
        core::array::from_fn(|axis| raw[channel][axis] - bias[channel][axis])
    })
}

/// As [`add`].
fn raise(highest: &AtomicU32, value: u32) {
    highest.store(
        highest.load(Ordering::Relaxed).max(value),
        Ordering::Relaxed,
    );
}

#[cfg(test)]
mod tests {
    use core::cell::Cell;
    use std::rc::Rc;

    use tempco::BiasRamp;

    use super::super::devices::{AtRest, Count};
    use super::super::exchange::{Counts, Exchange, publish};
    use super::*;

    const PERIOD: u32 = 1000;

    /// A gyro whose output takes time.
    struct Slow {
        now: Rc<Cell<u32>>,
        takes: Rc<Cell<u32>>,
    }

    impl Gyro<1, 1> for Slow {
        const COUNTS: [[Count; 1]; 1] = [[Count::Pulses(1.0)]];
        const AT_REST: AtRest = AtRest {
            sigma: 0.0,
            max_bias: 0.0,
        };
        const MAX_TABLE_BIAS: f32 = 0.0;

        fn sample(&mut self) -> Option<[[i32; 1]; 1]> {
            Some([[0]])
        }

        fn put(&mut self, _: &[[f32; 1]; 1], _: &[Status; 1]) {
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

    #[test]
    fn what_is_published_is_taken_out_from_the_next_sample_on() {
        let counts = Counts::new();
        let mut exchange = Exchange::new();
        let (ends, mut main) = exchange.split(&counts);
        let (now, takes) = (Rc::new(Cell::new(0)), Rc::default());
        let gyro = Slow {
            now: now.clone(),
            takes,
        };
        let mut sampling = Sampling::new(gyro, ends, [[1.0]]);
        let clock = Clock::<PERIOD>(now.clone());
        let mut next = |main: &mut super::super::exchange::MainEnds<'_, 1, 1>| {
            now.set(now.get() + PERIOD);
            sampling.interrupt(true, &clock);
            let moment = main.moments.dequeue().unwrap();
            (moment.bias[0][0], moment.status[0])
        };
        assert_eq!(next(&mut main), (0.0, Status::TEMPERATURE_LOST));
        let ramp = |end| BiasRamp {
            end: [end],
            slope: [1.0],
            samples: 2,
            status: Status::SETTLING,
        };
        publish(main.ramps, &[ramp(5.0)]);
        // That of a replay is its own.
        publish(main.replay_ramps, &[ramp(7.0)]);
        main.injected.enqueue([[10.0]]).unwrap();
        assert_eq!(next(&mut main), (4.0, Status::SETTLING));
        let reply = main.replies.dequeue().unwrap();
        assert_eq!((reply.bias, reply.compensated), ([[6.0]], [[4.0]]));
        assert_eq!(reply.status, [Status::SETTLING]);
        for _ in 0..3 {
            assert_eq!(next(&mut main), (5.0, Status::SETTLING));
        }
        let late = Status::SETTLING | Status::INTERVAL_INVALID;
        assert_eq!(next(&mut main), (5.0, late));
        assert_eq!(counts.losses(), tempco_link::Losses::default());
    }

    /// Runs interrupts that are entered after `delay` counts and take each of `lengths`, as a
    /// processor does: what comes while one runs waits, and several wait as one. Returns samples
    /// taken and missed, and the periods that began before the last entry.
    fn run<const PER: u32, const RUNS: bool>(delay: u32, lengths: &[u32]) -> (u32, u32, u32) {
        let (now, takes) = (Rc::new(Cell::new(0)), Rc::new(Cell::new(0)));
        let counts = Counts::new();
        let mut exchange = Exchange::new();
        let (ends, mut main) = exchange.split(&counts);
        let gyro = Slow {
            now: now.clone(),
            takes: takes.clone(),
        };
        let mut sampling = Sampling::new(gyro, ends, [[1.0]]);
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
        let mut exchange = Exchange::new();
        let (ends, _main) = exchange.split(&counts);
        let gyro = Slow {
            now: now.clone(),
            takes,
        };
        let mut sampling = Sampling::new(gyro, ends, [[1.0]]);
        sampling.interrupt(true, &Clock::<PERIOD>(now));
        assert_eq!(counts.latency.load(Ordering::Relaxed), 1200);
    }

    #[test]
    fn what_finds_no_place_is_counted_apart() {
        let now = Rc::new(Cell::new(0));
        let counts = Counts::new();
        let mut exchange = Exchange::new();
        let (ends, mut main) = exchange.split(&counts);
        let gyro = Slow {
            now: now.clone(),
            takes: Rc::default(),
        };
        let mut sampling = Sampling::new(gyro, ends, [[1.0]]);
        let clock = Clock::<PERIOD>(now.clone());
        for _ in 0..300 {
            now.set(now.get() + PERIOD);
            main.injected.enqueue([[1.0]]).unwrap();
            sampling.interrupt(true, &clock);
        }
        let losses = counts.losses();
        assert_eq!(losses.missed_samples, 0);
        assert_eq!((losses.moments, losses.replies), (300 - 127, 300 - 255));
    }
}
