//! What the compensator says about its own output.

use core::ops::{BitAnd, BitOr, BitOrAssign};

use crate::sign::Sign;

/// A set of flags that goes with every output.
///
/// Flags describe the present sample; how long a fault is remembered is said at each flag.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Status(u16);

/// The names of the flags, separated by blanks; `ok` without a flag.
#[cfg(feature = "defmt")]
impl defmt::Format for Status {
    fn format(&self, fmt: defmt::Formatter) {
        if *self == Self::OK {
            defmt::write!(fmt, "ok");
        }
        for (flag, name) in Self::NAMES {
            if self.contains(flag) {
                defmt::write!(fmt, "{=str} ", name);
            }
        }
    }
}

/// The three classes a system's monitor acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Validity {
    /// No flag.
    Valid,
    /// Compensated with stale, clamped or still settling thermal data.
    Degraded,
    /// Only the constant bias is applied, or the gyro sample itself is not a number.
    Invalid,
}

impl Status {
    /// No flag set.
    pub const OK: Self = Self(0);
    /// The temperature was not finite or outside the sensor's range; the last good one is held.
    pub const TEMPERATURE_INVALID: Self = Self(1 << 0);
    /// The temperature changed too fast; the last good one is held.
    pub const TEMPERATURE_SPIKE: Self = Self(1 << 1);
    /// No accepted temperature for longer than the hold time: the bias ramps to, and stays at,
    /// its value at the reference temperature.
    pub const TEMPERATURE_LOST: Self = Self(1 << 2);
    /// A start, restart or rejected temperature lies so little back that the rate estimate may
    /// still be settling, or the lag-compensated temperature is still ramping to a new value; after
    /// a loss, until rate and history count in full again; after power-on, until plays that are put
    /// where the rate says they are have been put there.
    pub const SETTLING: Self = Self(1 << 3);
    /// The interval since the last thermal update was not positive (the temperature is then not
    /// accepted), or longer than half the estimator's time constant (the estimator then restarts), or
    /// the next update is overdue by more than an update period.
    pub const INTERVAL_INVALID: Self = Self(1 << 4);
    /// The lag-compensated temperature lies outside the calibrated range and was clamped to it.
    pub const TEMPERATURE_CLAMPED: Self = Self(1 << 5);
    /// The rate of temperature lies outside the calibrated range and was clamped to it.
    pub const RATE_CLAMPED: Self = Self(1 << 6);
    /// A gyro sample is NaN or infinite; it is passed through, no state is touched by it.
    pub const RAW_INVALID: Self = Self(1 << 7);
    /// The second lag lies outside the calibrated range and was clamped to it.
    pub const LAG_CLAMPED: Self = Self(1 << 8);
    /// The temperature was lost, and what it did meanwhile still has a share in the bias: for three
    /// time constants of the second lag (5.5 h at most), and until the temperature, once the rate
    /// has settled, has moved through the wider play. Never set without second lag and plays.
    pub const HISTORY_UNKNOWN: Self = Self(1 << 9);
    /// Since the start the temperature has jumped further than the part can, and one away from
    /// where it was before was accepted in the end. It may be right now, or may have been before.
    pub const TEMPERATURE_JUMPED: Self = Self(1 << 10);

    /// Every flag with its name, in the order of the bits.
    pub const NAMES: [(Self, &'static str); 11] = [
        (Self::TEMPERATURE_INVALID, "temperature_invalid"),
        (Self::TEMPERATURE_SPIKE, "temperature_spike"),
        (Self::TEMPERATURE_LOST, "temperature_lost"),
        (Self::SETTLING, "settling"),
        (Self::INTERVAL_INVALID, "interval_invalid"),
        (Self::TEMPERATURE_CLAMPED, "temperature_clamped"),
        (Self::RATE_CLAMPED, "rate_clamped"),
        (Self::RAW_INVALID, "raw_invalid"),
        (Self::LAG_CLAMPED, "lag_clamped"),
        (Self::HISTORY_UNKNOWN, "history_unknown"),
        (Self::TEMPERATURE_JUMPED, "temperature_jumped"),
    ];

    /// The flags as bits, for storing and sending.
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// The flags from bits; bits without a meaning are kept.
    pub const fn from_bits(bits: u16) -> Self {
        Self(bits)
    }

    /// Whether all flags of `other` are set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether any flag of `other` is set.
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// The flags where `condition` holds, else none.
    pub(crate) const fn when(self, condition: bool) -> Self {
        if condition { self } else { Self::OK }
    }

    /// The flags where `sign` holds, else none.
    #[inline(always)]
    pub(crate) const fn where_holds(self, sign: Sign) -> Self {
        Self(sign.keep(self.0 as i32) as u16)
    }

    /// [`Status::RAW_INVALID`] if a gyro sample is NaN or infinite, or nothing.
    #[inline(always)]
    pub fn of_raw(raw: &[f32]) -> Self {
        // 0, or a NaN once a factor was NaN or infinite. Of these the lowest bit of the exponent
        // tells, and it lies 16 above the flag.
        let check = raw.iter().fold(0.0_f32, |check, value| check * value);
        Self((check.to_bits() >> 16) as u16) & Self::RAW_INVALID
    }

    /// The first flags in the order of their bits.
    #[inline(always)]
    pub(crate) fn of(signs: [Sign; 4]) -> Self {
        let bits = signs.iter().rev();
        Self(bits.fold(0, |bits, sign| bits << 1 | sign.count()) as u16)
    }

    /// The class a monitor acts on.
    pub const fn validity(self) -> Validity {
        if self.intersects(Self(Self::TEMPERATURE_LOST.0 | Self::RAW_INVALID.0)) {
            Validity::Invalid
        } else if self.0 != 0 {
            Validity::Degraded
        } else {
            Validity::Valid
        }
    }
}

impl BitOr for Status {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitAnd for Status {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOrAssign for Status {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_name_belongs_to_one_bit_of_its_own() {
        for (position, (flag, _)) in Status::NAMES.iter().enumerate() {
            assert_eq!(flag.bits(), 1 << position);
        }
    }

    #[test]
    fn flags_are_gathered() {
        let mut status = Status::SETTLING;
        status |= Status::RATE_CLAMPED;
        assert_eq!(status, Status::SETTLING | Status::RATE_CLAMPED);
        assert_eq!(status & Status::RATE_CLAMPED, Status::RATE_CLAMPED);
    }

    #[test]
    fn validity_is_the_worst_of_the_flags() {
        assert_eq!(Status::OK.validity(), Validity::Valid);
        for (flag, name) in Status::NAMES {
            let invalid = name == "temperature_lost" || name == "raw_invalid";
            let expected = if invalid {
                Validity::Invalid
            } else {
                Validity::Degraded
            };
            assert_eq!(flag.validity(), expected, "{name}");
            assert_eq!(
                (flag | Status::RAW_INVALID).validity(),
                Validity::Invalid,
                "{name}"
            );
        }
    }
}
