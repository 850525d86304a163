//! What a unit can find wrong with itself.

use core::fmt;
use core::ops::{BitOr, BitOrAssign};

use serde::{Deserialize, Serialize};

/// A fault that the built-in test knows. Its code is its place in [`ALL`](Self::ALL).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Fault {
    /// There is no good table in the store: the unit runs uncompensated.
    NoTable,
    /// One of the two tables is damaged or does not fit the board; the other one is in use or could
    /// be.
    SpareTable,
    /// The flash failed to read, write or erase.
    Flash,
    /// The compensator does not find the known answer.
    KnownAnswer,
    /// A temperature sensor or a wire to it is open.
    SensorOpen,
    /// A temperature sensor or a wire to it is short-circuited.
    SensorShort,
    /// A temperature sensor's voltage is beyond what its converter can measure.
    SensorRail,
    /// A temperature sensor does not answer, or has nothing new for too long.
    SensorBus,
    /// A temperature sensor gives the same code for longer than its noise allows.
    SensorStuck,
    /// A temperature changed too fast, or is not a number.
    TemperatureRejected,
    /// No temperature was accepted for so long that only the constant bias is taken out.
    TemperatureLost,
    /// Temperature, rate or second lag lie outside the calibrated range.
    OutOfRange,
    /// A gyro sample is not a number.
    RawInvalid,
    /// A gyro sample was not taken, or the outcome of one was lost.
    Overrun,
    /// A task did not do its work in time.
    Starved,
    /// The last reset was the watchdog's.
    WatchdogReset,
    /// The last reset followed a panic or a fault of the processor.
    Crash,
    /// The stack has used more than the share that was foreseen.
    Stack,
    /// The supply was too low.
    BrownOut,
    /// The crystal does not run: the unit runs from its internal oscillator, which keeps worse time.
    Clock,
    /// The last re-zero was given up; the constant biases are those before it.
    ReZero,
    /// A gyro with a clock of its own gives no samples.
    GyroSilent,
    /// Samples of a gyro were ready, and its data-ready line did not say so.
    DataReady,
    /// The table in use was damaged in RAM, and was loaded again from the store.
    TableUpset,
    /// The fault log has had as many erasures as its flash stands, and is written no more.
    LogWorn,
}

impl Fault {
    /// Every fault, by its code.
    pub const ALL: [Self; 25] = [
        Self::NoTable,
        Self::SpareTable,
        Self::Flash,
        Self::KnownAnswer,
        Self::SensorOpen,
        Self::SensorShort,
        Self::SensorRail,
        Self::SensorBus,
        Self::SensorStuck,
        Self::TemperatureRejected,
        Self::TemperatureLost,
        Self::OutOfRange,
        Self::RawInvalid,
        Self::Overrun,
        Self::Starved,
        Self::WatchdogReset,
        Self::Crash,
        Self::Stack,
        Self::BrownOut,
        Self::Clock,
        Self::ReZero,
        Self::GyroSilent,
        Self::DataReady,
        Self::TableUpset,
        Self::LogWorn,
    ];

    /// The code, as in a fault log.
    pub const fn code(self) -> u16 {
        self as u16
    }

    /// The fault of a code; none for one that a newer version may know.
    pub fn from_code(code: u16) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }

    /// Whether the output must not be used while the fault is present; otherwise it is degraded.
    pub const fn is_invalidating(self) -> bool {
        matches!(
            self,
            Self::NoTable
                | Self::KnownAnswer
                | Self::TemperatureLost
                | Self::RawInvalid
                | Self::GyroSilent
        )
    }

    /// A short name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NoTable => "no table",
            Self::SpareTable => "spare table",
            Self::Flash => "flash",
            Self::KnownAnswer => "known answer",
            Self::SensorOpen => "sensor open",
            Self::SensorShort => "sensor short",
            Self::SensorRail => "sensor rail",
            Self::SensorBus => "sensor bus",
            Self::SensorStuck => "sensor stuck",
            Self::TemperatureRejected => "temperature rejected",
            Self::TemperatureLost => "temperature lost",
            Self::OutOfRange => "out of range",
            Self::RawInvalid => "raw invalid",
            Self::Overrun => "overrun",
            Self::Starved => "starved",
            Self::WatchdogReset => "watchdog reset",
            Self::Crash => "crash",
            Self::Stack => "stack",
            Self::BrownOut => "brown-out",
            Self::Clock => "clock",
            Self::ReZero => "re-zero",
            Self::GyroSilent => "gyro silent",
            Self::DataReady => "data ready",
            Self::TableUpset => "table upset",
            Self::LogWorn => "log worn",
        }
    }
}

/// Faults by the bits of their codes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultSet(pub u32);

impl FaultSet {
    /// No fault.
    pub const NONE: Self = Self(0);

    /// Whether the fault is among these.
    pub const fn contains(self, fault: Fault) -> bool {
        self.0 & 1 << fault.code() != 0
    }

    /// The faults that are among these and not among others.
    pub const fn without(self, others: Self) -> Self {
        Self(self.0 & !others.0)
    }

    /// Those faults of this version that are among these.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        Fault::ALL
            .into_iter()
            .filter(move |fault| self.contains(*fault))
    }

    /// Whether the output must not be used.
    pub fn is_invalidating(self) -> bool {
        self.iter().any(Fault::is_invalidating)
    }
}

impl From<Fault> for FaultSet {
    fn from(fault: Fault) -> Self {
        Self(1 << fault.code())
    }
}

impl BitOr for FaultSet {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for FaultSet {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

impl FromIterator<Fault> for FaultSet {
    fn from_iter<I: IntoIterator<Item = Fault>>(faults: I) -> Self {
        faults
            .into_iter()
            .fold(Self::NONE, |set, fault| set | fault.into())
    }
}

/// The names, separated by commas; `none` without a fault.
impl fmt::Display for FaultSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut faults = self.iter();
        match faults.next() {
            None => f.write_str("none"),
            Some(first) => {
                f.write_str(first.name())?;
                faults.try_for_each(|fault| write!(f, ", {}", fault.name()))
            }
        }
    }
}

/// The names, separated by blanks; `none` without a fault.
#[cfg(feature = "defmt")]
impl defmt::Format for FaultSet {
    fn format(&self, fmt: defmt::Formatter) {
        if *self == Self::NONE {
            defmt::write!(fmt, "none");
        }
        for fault in self.iter() {
            defmt::write!(fmt, "{=str} ", fault.name());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_places() {
        for (place, fault) in Fault::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(fault.code()), place);
            assert_eq!(Fault::from_code(fault.code()), Some(fault));
            assert!(FaultSet::from(fault).contains(fault));
        }
        assert!(Fault::ALL.len() <= 32, "a bit for each fault");
        assert_eq!(Fault::from_code(Fault::ALL.len() as u16), None);
    }
}
