//! Units of the axes by code, so that a table in deg/h is not subtracted from pulses.

/// Unit of an axis and so of its bias.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Unit {
    /// Degrees per hour.
    Dph = 1,
    /// Degrees per second.
    Dps = 2,
    /// Radians per second.
    Radps = 3,
    /// Pulses per second.
    PulsesPerS = 4,
    /// Metres per second squared.
    Mps2 = 5,
    /// Standard gravity.
    G = 6,
}

impl Unit {
    /// The code in the image.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The unit of a code.
    pub const fn from_code(code: u8) -> Option<Self> {
        Some(match code {
            1 => Self::Dph,
            2 => Self::Dps,
            3 => Self::Radps,
            4 => Self::PulsesPerS,
            5 => Self::Mps2,
            6 => Self::G,
            _ => return None,
        })
    }

    /// The unit as it is written for people.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Dph => "deg/h",
            Self::Dps => "deg/s",
            Self::Radps => "rad/s",
            Self::PulsesPerS => "pulses/s",
            Self::Mps2 => "m/s^2",
            Self::G => "g",
        }
    }
}
