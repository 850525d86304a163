//! From the stamps of a logger to a time that increases.
//!
//! A counter that wraps goes on. A recorder that starts again begins a run of its own, an hour
//! later. One stamp far ahead of both neighbours is the bad one.

use super::doubt::{Doubt, DoubtKind};

/// Counters wrap after this long \[s\]: 2^32 us, 2^32 ms, 2^16 ms, a day, a week.
const WRAPS_S: [f64; 5] = [4_294.967_296, 4_294_967.296, 65.536, 86_400.0, 604_800.0];

/// Counters that wrap sooner than this are short \[s\].
const SHORT_S: f64 = 100.0;

/// A stamp is ahead where its step is this many times the step that leaves it out.
const AHEAD: f64 = 3.0;

/// A recorder that starts again stamps within this time of its first stamp \[s\] ...
const RESTART_WITHIN_S: f64 = 60.0;

/// ... after a run of at least this long \[s\] ...
const LEAST_RUN_S: f64 = 60.0;

/// ... and this many steps.
const LEAST_STEPS: f64 = 100.0;

/// Nobody knows how long a restart took. A run is set this long after the last row \[s\]: longer
/// than any time constant.
const RESTART_GAP_S: f64 = 3600.0;

/// Bursts further apart than this leave in doubt when a row was measured \[s\]: a mean of the fit is
/// as long.
const LONG_BURST_S: f64 = 10.0;

/// What was found in the stamps of a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct TimeNotes {
    /// Number of wraps of the counter.
    pub(super) wraps: usize,
    /// The time after which it wraps \[s\].
    pub(super) wrap_s: f64,
    /// Times at which the recorder began again, as they are counted on \[s\].
    pub(super) restarts_s: Vec<f64>,
    /// Rows that repeat the row before in every column that is read; left out.
    pub(super) repeated_rows: usize,
    /// Rows per burst, where the logger stamps whole bursts; 0 else.
    pub(super) rows_per_burst: usize,
    /// Time from burst to burst \[s\]; 0 where there are none.
    pub(super) burst_s: f64,
}

impl TimeNotes {
    /// What was found, each in some words.
    pub(super) fn in_words(&self) -> Vec<String> {
        let mut words = Vec::new();
        match self.wraps {
            0 => (),
            1 => words.push(format!(
                "the time wraps once, at {} s, and goes on",
                self.wrap_s
            )),
            wraps => words.push(format!(
                "the time wraps {wraps} times, at {} s, and goes on",
                self.wrap_s
            )),
        }
        if self.rows_per_burst > 0 {
            words.push(format!(
                "rows are stamped in bursts of {}: each is spread over the time since the one before",
                self.rows_per_burst
            ));
        }
        if self.repeated_rows > 0 {
            words.push(format!(
                "{} rows repeat the row before and are left out",
                self.repeated_rows
            ));
        }
        words
    }

    /// What a person must judge of it. A counter that wraps, a row that is written twice and short
    /// bursts leave no doubt about the times.
    pub(super) fn doubts(&self) -> Vec<Doubt> {
        let restarts = match self.restarts_s[..] {
            [] => None,
            [time_s] => Some(format!(
                "the recorder starts again: a run of its own, set an hour later, from {time_s:.1} s on"
            )),
            [first_s, .., last_s] => Some(format!(
                "the recorder starts again {} times: runs of their own, each set an hour later, the \
                 first from {first_s:.1} s on and the last from {last_s:.1} s on",
                self.restarts_s.len()
            )),
        };
        let bursts = (self.burst_s > LONG_BURST_S).then(|| {
            format!(
                "{} rows have one stamp, every {:.1} s: when each was measured is a guess",
                self.rows_per_burst, self.burst_s
            )
        });
        let found = [
            (DoubtKind::TimeRestarts, restarts),
            (DoubtKind::LongBursts, bursts),
        ];
        let doubt = |(kind, detail)| {
            Some(Doubt {
                kind,
                detail: detail?,
            })
        };
        found.into_iter().filter_map(doubt).collect()
    }
}

/// What a stamp is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stamp {
    /// A time \[s\], later than those before.
    At(f64),
    /// The stamp of the row before.
    Again,
    /// Far ahead of both neighbours; it does not count.
    Ahead {
        /// Time of the row before \[s\].
        before_s: f64,
        /// Time of the row after \[s\].
        after_s: f64,
    },
    /// Earlier than this time \[s\], without a reason that is known.
    Back(f64),
}

/// Follows the stamps of a log.
#[derive(Clone, Debug, Default)]
pub(super) struct Clock {
    /// Stamp at which the recorder began \[s\].
    first_s: f64,
    /// Time of the last good row \[s\].
    last_s: Option<f64>,
    /// The step before it \[s\].
    step_s: f64,
    /// What is added to stamps \[s\].
    offset_s: f64,
    pub(super) notes: TimeNotes,
}

impl Clock {
    /// Time of the last good row \[s\].
    pub(super) fn last_s(&self) -> Option<f64> {
        self.last_s
    }

    /// Judges a stamp by those before and the one after, if there is one.
    pub(super) fn judge(&mut self, stamp_s: f64, next_s: Option<f64>) -> Stamp {
        let time_s = stamp_s + self.offset_s;
        let Some(last_s) = self.last_s else {
            self.first_s = stamp_s;
            return self.advance(time_s, 0.0);
        };
        let step_s = time_s - last_s;
        if step_s > 0.0 {
            let after_s = next_s.map_or(f64::INFINITY, |next| next + self.offset_s);
            let without = after_s - last_s;
            if after_s <= time_s && without > 0.0 && step_s > AHEAD * without {
                let before_s = last_s;
                return Stamp::Ahead { before_s, after_s };
            }
            return self.advance(time_s, step_s);
        }
        if step_s == 0.0 {
            return Stamp::Again;
        }
        // A wrap: about the same step as before, if the length of the counter is added. A short
        // counter could fit by chance, so it must also begin at 0 again.
        let is_wrap = |wrap_s: &f64| {
            let step = step_s + wrap_s;
            let near = 4.0 * self.step_s;
            let begins = *wrap_s > SHORT_S || (0.0..near).contains(&stamp_s);
            step > 0.0 && step <= near && *wrap_s > LEAST_STEPS * self.step_s && begins
        };
        if let Some(wrap_s) = WRAPS_S.into_iter().find(is_wrap) {
            self.offset_s += wrap_s;
            self.notes.wraps += 1;
            self.notes.wrap_s = wrap_s;
            return self.advance(time_s + wrap_s, step_s + wrap_s);
        }
        // A restart: near the first stamp, far back, and time goes on from there.
        let goes_on = next_s.is_some_and(|next| next >= stamp_s && next < stamp_s - step_s);
        let is_restart = (stamp_s - self.first_s).abs() <= RESTART_WITHIN_S
            && -step_s > LEAST_RUN_S.max(LEAST_STEPS * self.step_s)
            && goes_on;
        if is_restart {
            self.offset_s += RESTART_GAP_S - step_s;
            self.first_s = stamp_s;
            self.notes.restarts_s.push(last_s + RESTART_GAP_S);
            return self.advance(last_s + RESTART_GAP_S, self.step_s);
        }
        Stamp::Back(last_s)
    }

    fn advance(&mut self, time_s: f64, step_s: f64) -> Stamp {
        self.last_s = Some(time_s);
        self.step_s = step_s;
        Stamp::At(time_s)
    }

    /// Passes over stamps that increase and need no offset; returns whether they do.
    pub(super) fn pass(&mut self, stamps_s: &[f64], next_s: Option<f64>) -> bool {
        let (Some(&first), Some(&last)) = (stamps_s.first(), stamps_s.last()) else {
            return true;
        };
        let passes = self.offset_s == 0.0
            && self.last_s.is_none_or(|before| first > before)
            && stamps_s.windows(2).all(|t| t[1] > t[0])
            && next_s.is_none_or(|next| next > last);
        if passes {
            if self.last_s.is_none() {
                self.first_s = first;
            }
            let before = match stamps_s.len() {
                1 => self.last_s.unwrap_or(last),
                rows => stamps_s[rows - 2],
            };
            self.last_s = Some(last);
            self.step_s = last - before;
        }
        passes
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// What becomes of stamps.
    fn judged(stamps: &[f64]) -> (Vec<Stamp>, TimeNotes) {
        let mut clock = Clock::default();
        let judge = |row: usize| clock.judge(stamps[row], stamps.get(row + 1).copied());
        let found = (0..stamps.len()).map(judge).collect();
        (found, clock.notes)
    }

    fn times(found: &[Stamp]) -> Vec<f64> {
        let time = |stamp: &Stamp| match stamp {
            Stamp::At(time_s) => Some(*time_s),
            _ => None,
        };
        found.iter().filter_map(time).collect()
    }

    proptest! {
        #[test]
        fn counters_of_any_length_are_unwrapped(
            wrap in 0..WRAPS_S.len(), begin in 0.0_f64..1.0, rate_hz in 2.0_f64..200.0,
        ) {
            let wrap_s = WRAPS_S[wrap];
            let begin_s = (wrap_s - 10.0 * begin - 1.0).max(0.0);
            let truth: Vec<f64> = (0..3000).map(|i| begin_s + f64::from(i) / rate_hz).collect();
            let stamps: Vec<f64> = truth.iter().map(|t| t % wrap_s).collect();
            let (found, notes) = judged(&stamps);
            let found = times(&found);
            prop_assert_eq!(found.len(), truth.len());
            for (found, truth) in found.iter().zip(&truth) {
                prop_assert!((found - truth).abs() < 1e-6);
            }
            let wraps = (truth[2999] / wrap_s) as usize;
            prop_assert_eq!((notes.wraps, notes.wrap_s), (wraps, wrap_s));
        }

        #[test]
        fn one_stamp_ahead_is_the_bad_one(at in 1_usize..98, ahead_s in 4.0_f64..1e6) {
            let mut stamps: Vec<f64> = (0..100).map(f64::from).collect();
            stamps[at] += ahead_s;
            let (found, notes) = judged(&stamps);
            for (row, stamp) in found.iter().enumerate() {
                let is_ahead = matches!(stamp, Stamp::Ahead { .. });
                prop_assert_eq!(is_ahead, row == at, "{} {:?}", row, stamp);
            }
            prop_assert_eq!(notes, TimeNotes::default());
        }

        #[test]
        fn a_recorder_that_starts_again_begins_a_run(
            rows in 900_usize..2000, begin_s in 0.0_f64..1e6, later_s in 0.0_f64..60.0,
        ) {
            let stamp = |i: usize| begin_s + 0.2 * i as f64;
            let stamps: Vec<f64> = (0..rows)
                .map(stamp)
                .chain((0..100).map(|i| later_s.min(0.05 * rows as f64) + stamp(i)))
                .collect();
            let (found, notes) = judged(&stamps);
            let found = times(&found);
            prop_assert_eq!(found.len(), rows + 100);
            prop_assert!((found[rows] - found[rows - 1] - RESTART_GAP_S).abs() < 1e-6);
            prop_assert_eq!(notes.restarts_s.len(), 1);
        }

        /// Clean logs, with gaps of any length, stay as they are.
        #[test]
        fn times_that_increase_stay(steps in prop::collection::vec(1e-4_f64..5000.0, 2..100)) {
            let stamps: Vec<f64> = steps
                .iter()
                .scan(0.0, |time_s, step| {
                    *time_s += step;
                    Some(*time_s)
                })
                .collect();
            let (found, notes) = judged(&stamps);
            prop_assert_eq!(times(&found), stamps);
            prop_assert_eq!(notes, TimeNotes::default());
        }
    }

    #[test]
    fn what_goes_back_without_a_reason_is_bad() {
        let stamps = [0.0, 1.0, 2.0, 3.0, 2.5, 4.0, 4.0, 5.0];
        let (found, _) = judged(&stamps);
        assert_eq!(found[4], Stamp::Back(3.0));
        assert_eq!(found[6], Stamp::Again);
        assert_eq!(times(&found), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }
}
