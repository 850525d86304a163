//! Times of rows: the unit's, across gaps and resets.

use std::time::Duration;

use tempco_link::Telemetry;

/// Why rows are missing before a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Gap {
    /// Messages did not arrive.
    Lost,
    /// The line was away, or the unit silent.
    Line,
    /// The unit was reset: its time began again.
    Reset,
    /// The gyro gave no valid sample.
    Invalid,
}

impl Gap {
    /// As in the log.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Lost => "lost",
            Self::Line => "line",
            Self::Reset => "reset",
            Self::Invalid => "invalid",
        }
    }
}

/// The time of a log, which never goes back.
#[derive(Debug, Default)]
pub(super) struct Timeline {
    last: Option<Last>,
    first_ms: u64,
    /// A gap before the next row that is known already.
    marked: Option<Gap>,
    gaps: u32,
}

#[derive(Debug)]
struct Last {
    index: u32,
    uptime_ms: u32,
    time_ms: u64,
}

impl Timeline {
    /// Marks a gap before the next row.
    pub(super) fn mark(&mut self, gap: Gap) {
        self.marked = Some(gap);
    }

    /// The time of a message that came some time after the one before, and the gap before it \[ms\].
    ///
    /// It is the unit's time since power-on. After a reset of the unit it goes on from the last row by
    /// the time that has passed here.
    pub(super) fn take(&mut self, message: &Telemetry, since: Duration) -> (u64, Option<Gap>) {
        let &Telemetry {
            index, uptime_ms, ..
        } = message;
        let marked = self.marked.take();
        let (time_ms, gap) = match &self.last {
            None => {
                self.first_ms = uptime_ms.into();
                (self.first_ms, None)
            }
            Some(last) if index <= last.index || uptime_ms <= last.uptime_ms => {
                let since_ms = (since.as_millis() as u64).max(1);
                (last.time_ms + since_ms, Some(Gap::Reset))
            }
            Some(last) => {
                let passed_ms = u64::from(uptime_ms - last.uptime_ms);
                let lost = (index > last.index + 1).then_some(Gap::Lost);
                (last.time_ms + passed_ms, marked.or(lost))
            }
        };
        self.gaps += u32::from(gap.is_some());
        self.last = Some(Last {
            index,
            uptime_ms,
            time_ms,
        });
        (time_ms, gap)
    }

    /// From the first row to the last one \[s\].
    pub(super) fn duration_s(&self) -> f64 {
        let last = self.last.as_ref();
        last.map_or(0.0, |last| (last.time_ms - self.first_ms) as f64 / 1000.0)
    }

    /// Rows with a gap before them.
    pub(super) const fn gaps(&self) -> u32 {
        self.gaps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(index: u32, uptime_ms: u32) -> Telemetry {
        Telemetry {
            index,
            uptime_ms,
            ..Telemetry::default()
        }
    }

    #[test]
    fn time_is_the_units_and_gaps_say_why() {
        let mut timeline = Timeline::default();
        // Of what came before the recording nothing is missing.
        timeline.mark(Gap::Line);
        let here = Duration::from_secs(20);
        let mut take = |index, uptime_ms| timeline.take(&message(index, uptime_ms), here);
        assert_eq!(take(8, 1500), (1500, None));
        assert_eq!(take(9, 1600), (1600, None));
        assert_eq!(take(12, 1900), (1900, Some(Gap::Lost)));
        // A reset: 20 s by the clock here.
        assert_eq!(take(2, 300), (21_900, Some(Gap::Reset)));
        assert_eq!(take(3, 400), (22_000, None));
        // A reset after which more messages were sent than before it.
        assert_eq!(take(5, 350), (42_000, Some(Gap::Reset)));
        timeline.mark(Gap::Line);
        let (time_ms, gap) = timeline.take(&message(900, 90_350), here);
        assert_eq!((time_ms, gap), (132_000, Some(Gap::Line)));
        assert_eq!(timeline.duration_s(), 130.5);
        assert_eq!(timeline.gaps(), 4);
    }
}
