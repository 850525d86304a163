//! Arguments of the commands that talk to a unit.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use tempco_hil::{Patience, Unit, open};
use tempco_link::Bank;

/// Baud rate of the boards in `firmware`.
pub(crate) const BAUD: u32 = 921_600;

/// Where a unit is.
#[derive(clap::Args)]
pub(crate) struct PortArgs {
    /// Serial port of the unit, such as /dev/ttyUSB0 or COM3, or the socket of an emulator
    #[arg(long, value_name = "PORT")]
    pub(crate) port: PathBuf,
    /// Baud rate of the serial port
    #[arg(long, value_name = "N", default_value_t = BAUD)]
    baud: u32,
}

impl PortArgs {
    /// Opens a session with the unit.
    pub(crate) fn connect(&self) -> Result<Unit> {
        // An error of opening names the port itself.
        let port = open(&self.port, self.baud)?;
        Unit::connect(port, Patience::default()).with_context(|| self.port.display().to_string())
    }
}

/// Refuses a period of telemetry that is none.
pub(crate) fn check_period(period_ms: u32) -> Result<()> {
    ensure!(period_ms > 0, "--period 0: expected milliseconds, above 0");
    Ok(())
}

/// A bank in words, to stand after its contents.
pub(crate) const fn bank_name(bank: Bank) -> &'static str {
    match bank {
        Bank::A => " in bank A",
        Bank::B => " in bank B",
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use tempco::Schedule;
    use tempco_hil::Identity;
    use tempco_image::{Fit, Unit};

    use super::Bank;

    /// A unit without a table, of axes in pulses/s.
    pub(crate) fn identity(channels: u8, axes: u8) -> Identity {
        let fit = Fit {
            unit: Unit::PulsesPerS,
            scale_factor_arcsec: 1.0,
            max_bias: 1.0,
        };
        Identity {
            serial: "S1".to_owned(),
            firmware: "1".to_owned(),
            channels,
            axes,
            schedule: Schedule {
                sample_rate_hz: 2000.0,
                samples_per_update: 200,
            },
            bank: None,
            spare: Bank::A,
            table_crc: 0,
            sequence: 0,
            scale_factor_arcsec: 1.0,
            fits: vec![fit; usize::from(channels * axes)],
        }
    }
}
