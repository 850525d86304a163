//! The boards the firmware is built for and QEMU can emulate.

use std::fmt;
use std::str::FromStr;

use crate::{Error, TARGET};

/// A board of the firmware that QEMU has a machine for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Board {
    /// Arm MPS2 with the AN386 image: the reference board.
    Mps2An386,
    /// STM32F405, as on the Netduino Plus 2.
    Stm32F405,
    /// Arm MPS2 with the AN500 image: a Cortex-M7.
    Mps2An500,
    /// Arm MPS2 with the AN505 image: a Cortex-M33.
    Mps2An505,
    /// Arm MPS2 with the AN385 image: a Cortex-M3.
    Mps2An385,
    /// BBC micro:bit: a Cortex-M0.
    Microbit,
}

impl Board {
    /// Every board, the reference board first.
    pub const ALL: [Self; 6] = [
        Self::Mps2An386,
        Self::Stm32F405,
        Self::Mps2An500,
        Self::Mps2An505,
        Self::Mps2An385,
        Self::Microbit,
    ];

    /// Name, as in the firmware's memory file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mps2An386 => "mps2-an386",
            Self::Stm32F405 => "stm32f405",
            Self::Mps2An500 => "mps2-an500",
            Self::Mps2An505 => "mps2-an505",
            Self::Mps2An385 => "mps2-an385",
            Self::Microbit => "microbit",
        }
    }

    /// The firmware's cargo feature.
    pub fn feature(self) -> String {
        format!("board-{}", self.name())
    }

    /// QEMU's machine.
    pub const fn machine(self) -> &'static str {
        match self {
            Self::Stm32F405 => "netduinoplus2",
            other => other.name(),
        }
    }

    /// Whether the application runs on its machine. The STM32F405 has it too, but QEMU does not
    /// emulate its flash.
    pub const fn has_application(self) -> bool {
        matches!(self, Self::Mps2An386 | Self::Mps2An500)
    }

    /// The Rust target of its images.
    pub const fn target(self) -> &'static str {
        match self {
            Self::Mps2An386 | Self::Stm32F405 | Self::Mps2An500 => TARGET,
            Self::Mps2An505 => "thumbv8m.main-none-eabihf",
            Self::Mps2An385 => "thumbv7m-none-eabi",
            Self::Microbit => "thumbv6m-none-eabi",
        }
    }

    /// The processor its images are compiled for. It is more than the target's default: with it
    /// the compiler knows what the processor has, and which of its instructions are fast.
    pub const fn cpu(self) -> &'static str {
        match self {
            Self::Mps2An386 | Self::Stm32F405 => "cortex-m4",
            Self::Mps2An500 => "cortex-m7",
            Self::Mps2An505 => "cortex-m33",
            Self::Mps2An385 => "cortex-m3",
            Self::Microbit => "cortex-m0",
        }
    }
}

impl fmt::Display for Board {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Board {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::ALL
            .into_iter()
            .find(|board| board.name() == name)
            .ok_or_else(|| Error::UnknownBoard(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boards_are_found_by_their_names() {
        for board in Board::ALL {
            assert_eq!(board.to_string().parse::<Board>().unwrap(), board);
        }
        let error = "mps2".parse::<Board>().unwrap_err().to_string();
        assert_eq!(
            error,
            "there is no board `mps2`; the boards are \
             mps2-an386, stm32f405, mps2-an500, mps2-an505, mps2-an385, microbit"
        );
    }
}
