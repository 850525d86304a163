//! The processor's load.

/// Time over which the load is found \[s\].
const TIME_S: f32 = 1.0;

/// The share of time in which the processor does not sleep.
#[derive(Default)]
pub(super) struct Load {
    /// Counts asleep since `from` periods of the sampling timer.
    asleep: u64,
    from: u32,
    permille: u16,
}

impl Load {
    /// Takes a sleep \[counts of the timer\].
    pub(super) fn slept(&mut self, counts: u32) {
        self.asleep += u64::from(counts);
    }

    /// Finds the load once enough periods have passed, of `counts` each.
    pub(super) fn find(&mut self, periods: u32, counts: u32, sample_rate_hz: f32) {
        let since = periods.wrapping_sub(self.from);
        if (since as f32) < sample_rate_hz * TIME_S {
            return;
        }
        let all = u64::from(since) * u64::from(counts);
        let busy = all.saturating_sub(self.asleep);
        *self = Self {
            asleep: 0,
            from: periods,
            permille: (busy * 1000).checked_div(all).unwrap_or(0) as u16,
        };
    }

    /// The load when it was found last \[1/1000\].
    pub(super) const fn permille(&self) -> u16 {
        self.permille
    }
}
