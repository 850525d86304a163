//! Faults that are present, and when the watchdog is fed.

use tempco::Status;
use tempco_link::{Fault, FaultSet};

/// A fault stays present for this long after it was last seen \[ms\], so that one that comes and
/// goes is not reported as many.
const HOLD_MS: u32 = 1000;

/// Faults that stay present until the next reset, or until what they are of has gone well: that
/// they were not seen again takes nothing back.
const LATCHED: [Fault; 7] = [
    Fault::Flash,
    Fault::KnownAnswer,
    Fault::WatchdogReset,
    Fault::Crash,
    Fault::BrownOut,
    Fault::Clock,
    Fault::ReZero,
];

/// Flags of the compensator, with the faults that they are.
const OF_STATUS: [(Status, Fault); 8] = [
    (Status::TEMPERATURE_INVALID, Fault::TemperatureRejected),
    (Status::TEMPERATURE_SPIKE, Fault::TemperatureRejected),
    (Status::TEMPERATURE_LOST, Fault::TemperatureLost),
    (Status::TEMPERATURE_CLAMPED, Fault::OutOfRange),
    (Status::RATE_CLAMPED, Fault::OutOfRange),
    (Status::LAG_CLAMPED, Fault::OutOfRange),
    (Status::INTERVAL_INVALID, Fault::Starved),
    (Status::RAW_INVALID, Fault::RawInvalid),
];

/// The faults that a status is made of.
pub fn faults_of(status: Status) -> FaultSet {
    let present = OF_STATUS
        .iter()
        .filter(|(flag, _)| status.intersects(*flag));
    present.map(|(_, fault)| *fault).collect()
}

/// The faults that are present.
pub struct Health {
    present: FaultSet,
    seen_ms: [u32; Fault::ALL.len()],
}

impl Default for Health {
    fn default() -> Self {
        Self::new()
    }
}

impl Health {
    /// Nothing is known to be wrong.
    pub const fn new() -> Self {
        Self {
            present: FaultSet::NONE,
            seen_ms: [0; Fault::ALL.len()],
        }
    }

    /// Records a fault; whether it was not present before, and so belongs into the log.
    pub fn record(&mut self, fault: Fault, now_ms: u32) -> bool {
        let is_new = !self.present.contains(fault);
        self.present |= fault.into();
        if let Some(seen_ms) = self.seen_ms.get_mut(usize::from(fault.code())) {
            *seen_ms = now_ms;
        }
        is_new
    }

    /// Takes out a fault, as what it is of has gone well.
    pub fn clear(&mut self, fault: Fault) {
        self.present = self.present.without(fault.into());
    }

    /// Takes out the faults that have not been seen for a while.
    pub fn heal(&mut self, now_ms: u32) {
        let gone = self.present.iter().filter(|fault| {
            let seen_ms = self.seen_ms.get(usize::from(fault.code()));
            let age_ms = now_ms.wrapping_sub(seen_ms.copied().unwrap_or(now_ms));
            age_ms > HOLD_MS && !LATCHED.contains(fault)
        });
        self.present = self.present.without(gone.collect());
    }

    /// The faults that are present.
    pub const fn present(&self) -> FaultSet {
        self.present
    }
}

/// The rule by which the watchdog is fed: the main loop asks, and the thermometers were read since
/// it asked last. The sampling interrupt counts the time, so without it nothing is fed either.
pub struct LiveNess {
    looked_ms: u32,
    readings: u32,
}

/// Time between two looks \[ms\]; several of them fit into the watchdog's timeout.
const LOOK_MS: u32 = 500;

impl Default for LiveNess {
    fn default() -> Self {
        Self::new()
    }
}

impl LiveNess {
    /// Before the first look.
    pub const fn new() -> Self {
        Self {
            looked_ms: 0,
            readings: 0,
        }
    }

    /// Whether everything is alive, given the number of readings since power-on; nothing while it
    /// is not yet time to look.
    pub fn look(&mut self, now_ms: u32, readings: u32) -> Option<bool> {
        if now_ms.wrapping_sub(self.looked_ms) < LOOK_MS {
            return None;
        }
        let is_alive = readings != self.readings;
        *self = Self {
            looked_ms: now_ms,
            readings,
        };
        Some(is_alive)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_readings_the_watchdog_is_not_fed() {
        let mut live_ness = LiveNess::new();
        assert_eq!(live_ness.look(100, 1), None);
        assert_eq!(live_ness.look(500, 5), Some(true));
        assert_eq!(live_ness.look(900, 9), None);
        assert_eq!(live_ness.look(1000, 5), Some(false));
        assert_eq!(live_ness.look(1500, 6), Some(true));
    }

    /// Every flag is a fault but those that follow from one that was, or from power-on.
    #[test]
    fn what_is_beyond_its_range_is_out_of_range() {
        let none = Status::SETTLING | Status::HISTORY_UNKNOWN | Status::TEMPERATURE_JUMPED;
        for (flag, name) in Status::NAMES {
            let faults = faults_of(flag);
            assert_eq!(faults == FaultSet::NONE, none.contains(flag), "{name}");
            let is_clamped = name.ends_with("clamped");
            assert_eq!(faults == Fault::OutOfRange.into(), is_clamped, "{name}");
        }
    }

    #[test]
    fn faults_heal_but_those_of_the_last_reset() {
        let mut health = Health::new();
        assert!(health.record(Fault::SensorOpen, u32::MAX));
        assert!(!health.record(Fault::SensorOpen, 100), "it is known");
        assert!(health.record(Fault::Crash, 100));
        health.heal(1100);
        assert!(health.present().contains(Fault::SensorOpen));
        health.heal(1101);
        assert_eq!(health.present(), Fault::Crash.into());
        health.heal(u32::MAX / 2);
        assert_eq!(health.present(), Fault::Crash.into());
    }
}
