//! Time since power-on, by the sampling interrupt.

/// Counts periods of the sampling timer beyond the interrupt's 32 bits.
pub(super) struct Time {
    sample_rate_hz: f32,
    /// Since power-on, as of the last look.
    periods: u64,
    now_ms: u32,
}

impl Time {
    /// Power-on.
    pub(super) const fn new(sample_rate_hz: f32) -> Self {
        Self {
            sample_rate_hz,
            periods: 0,
            now_ms: 0,
        }
    }

    /// Looks at the periods that the interrupt has counted.
    pub(super) fn look(&mut self, periods: u32) {
        // The interrupt counts 32 bits, of which these are the continuation.
        let since = periods.wrapping_sub(self.periods as u32);
        self.periods += u64::from(since);
        let per_s = (self.sample_rate_hz as u64).max(1);
        self.now_ms = (self.periods * 1000 / per_s) as u32;
    }

    /// Time at the last look; it begins again after 49 days \[ms\].
    pub(super) const fn now_ms(&self) -> u32 {
        self.now_ms
    }

    /// Time at the last look \[s\].
    pub(super) fn uptime_s(&self) -> u32 {
        (self.periods as f32 / self.sample_rate_hz) as u32
    }
}
