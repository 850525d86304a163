//! Time since power-on, by the sampling interrupt.

use core::num::NonZeroU32;

/// Turns periods of the sampling timer into time. A look comes with every sample, so it is cheap.
pub(super) struct Time {
    /// Periods per second, 1 to 4 million \[Hz\].
    rate_hz: NonZeroU32,
    /// Since power-on, as of the last look.
    periods: u64,
    now_ms: u32,
    /// What is left over from whole milliseconds \[1/1000 periods\].
    rest: u32,
}

impl Time {
    /// Power-on.
    pub(super) fn new(sample_rate_hz: f32) -> Self {
        Self {
            rate_hz: NonZeroU32::new((sample_rate_hz as u32).min(4_000_000))
                .unwrap_or(NonZeroU32::MIN),
            periods: 0,
            now_ms: 0,
            rest: 0,
        }
    }

    /// Looks at the periods that the interrupt has counted.
    pub(super) fn look(&mut self, periods: u32) {
        // The interrupt counts 32 bits, of which these are the continuation.
        let since = periods.wrapping_sub(self.periods as u32);
        self.periods += u64::from(since);
        // Whole seconds apart, so that the rest does not overflow.
        let (seconds, since) = (since / self.rate_hz, since % self.rate_hz);
        let rest = self.rest + 1000 * since;
        self.rest = rest % self.rate_hz;
        let ms = seconds.wrapping_mul(1000).wrapping_add(rest / self.rate_hz);
        self.now_ms = self.now_ms.wrapping_add(ms);
    }

    /// Time at the last look; it begins again after 49 days \[ms\].
    pub(super) const fn now_ms(&self) -> u32 {
        self.now_ms
    }

    /// Time at the last look \[s\].
    pub(super) fn uptime_s(&self) -> u32 {
        (self.periods as f32 / self.rate_hz.get() as f32) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_is_that_of_all_periods() {
        for rate_hz in [1_u32, 7, 100, 2000, 1_999_993, 4_000_000] {
            let mut time = Time::new(rate_hz as f32);
            let mut all = 0_u64;
            for step in [0, 1, 1, 2, 19, 1999, 2000, 2001, 4_000_000, u32::MAX] {
                all += u64::from(step);
                time.look(all as u32);
                let expected = all * 1000 / u64::from(rate_hz);
                assert_eq!(time.now_ms(), expected as u32, "{step} at {rate_hz}");
            }
        }
    }
}
