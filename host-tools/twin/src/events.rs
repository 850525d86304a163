//! What happens to a unit besides heat: faults of its sensors and data, and motion.

use core::fmt;

use serde::Deserialize;

use crate::check::{Invalid, Range};

/// A fault and when it is there.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fault {
    /// Beginning, minutes from the start of the profile.
    pub at_min: f64,
    /// Duration, minutes; a spike takes one sample, whatever this is.
    #[serde(default)]
    pub duration_min: f64,
    /// What is wrong.
    pub what: FaultKind,
}

/// What is wrong with a sensor or the data.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FaultKind {
    /// The temperature reading stays what it was.
    TemperatureStuck,
    /// The temperature sensor is open: its reading is at the upper rail.
    TemperatureOpen,
    /// The temperature sensor is short: its reading is at the lower rail.
    TemperatureShort,
    /// There is no temperature reading: `NaN` in the log.
    TemperatureMissing,
    /// The temperature reading is off by a constant.
    TemperatureOffset {
        /// Added to the reading, degC.
        by_c: f64,
    },
    /// One temperature reading is off.
    TemperatureSpike {
        /// Added to the reading, degC.
        by_c: f64,
    },
    /// A gyro puts out 0.
    GyroDead {
        /// Its axis.
        axis: AxisName,
    },
    /// Rows are missing from the log.
    RowsLost,
}

/// An axis of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AxisName {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

/// A motion of the unit and when it is there.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Beginning, minutes from the start of the profile.
    pub at_min: f64,
    /// Duration, minutes.
    pub duration_min: f64,
    /// How the unit moves.
    pub what: MotionKind,
}

/// How a unit moves.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MotionKind {
    /// It turns at a constant rate.
    Turn {
        /// Rate about the axes, deg/s.
        rate_dps: [f64; 3],
    },
    /// It sways to and fro by an angle; where it stops in mid-swing, it stays.
    Sway {
        /// Amplitude about the axes, arcsec.
        amplitude_arcsec: [f64; 3],
        /// Frequency, Hz.
        frequency_hz: f64,
    },
}

impl Fault {
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        Range::TIME_MIN.check("at_min", self.at_min)?;
        let spike = matches!(self.what, FaultKind::TemperatureSpike { .. });
        match self.what {
            FaultKind::TemperatureOffset { by_c } => {
                Range::DIFFERENCE.check("what.temperature_offset.by_c", by_c)?;
            }
            FaultKind::TemperatureSpike { by_c } => {
                Range::DIFFERENCE.check("what.temperature_spike.by_c", by_c)?;
            }
            _ => {}
        }
        if spike {
            return Ok(());
        }
        Range::DURATION_MIN.check("duration_min", self.duration_min)
    }

    /// Whether the fault is there at the end of the sample interval `from_s..=to_s`.
    pub(crate) fn is_there(&self, from_s: f64, to_s: f64) -> bool {
        let begin_s = 60.0 * self.at_min;
        match self.what {
            FaultKind::TemperatureSpike { .. } => from_s < begin_s && begin_s <= to_s,
            _ => begin_s <= to_s && to_s < begin_s + 60.0 * self.duration_min,
        }
    }
}

impl Motion {
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        Range::TIME_MIN.check("at_min", self.at_min)?;
        Range::DURATION_MIN.check("duration_min", self.duration_min)?;
        match self.what {
            MotionKind::Turn { rate_dps } => rate_dps
                .into_iter()
                .try_for_each(|rate| Range::new(-1e4, 1e4).check("what.turn.rate_dps", rate)),
            MotionKind::Sway {
                amplitude_arcsec,
                frequency_hz,
            } => {
                Range::FREQUENCY.check("what.sway.frequency_hz", frequency_hz)?;
                amplitude_arcsec.into_iter().try_for_each(|amplitude| {
                    Range::SIGNED.check("what.sway.amplitude_arcsec", amplitude)
                })
            }
        }
    }

    /// Whether the unit moves in the sample interval `from_s..to_s`.
    pub(crate) fn is_there(&self, from_s: f64, to_s: f64) -> bool {
        let begin_s = 60.0 * self.at_min;
        begin_s < to_s && from_s < begin_s + 60.0 * self.duration_min
    }

    /// Angle turned about each axis since the beginning, arcsec.
    pub(crate) fn angle_arcsec(&self, time_s: f64) -> [f64; 3] {
        let since_s = (time_s - 60.0 * self.at_min).clamp(0.0, 60.0 * self.duration_min);
        match self.what {
            MotionKind::Turn { rate_dps } => rate_dps.map(|rate| 3600.0 * rate * since_s),
            MotionKind::Sway {
                amplitude_arcsec,
                frequency_hz,
            } => {
                let swing = libm::sin(core::f64::consts::TAU * frequency_hz * since_s);
                amplitude_arcsec.map(|amplitude| amplitude * swing)
            }
        }
    }
}

/// What is not as usual at a sample; shown as `ok` or by names joined with `+`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Flags(u8);

impl Flags {
    /// The temperature reading is false.
    pub const TEMPERATURE_FAULT: Self = Self(1);
    /// The output of a gyro is false.
    pub const GYRO_FAULT: Self = Self(2);
    /// The unit moved during the sample.
    pub const MOTION: Self = Self(4);
    /// Rows are missing before this one.
    pub const ROWS_LOST: Self = Self(8);

    const NAMES: [(Self, &str); 4] = [
        (Self::TEMPERATURE_FAULT, "temperature_fault"),
        (Self::GYRO_FAULT, "gyro_fault"),
        (Self::MOTION, "motion"),
        (Self::ROWS_LOST, "rows_lost"),
    ];

    /// Whether all of `flags` are set.
    pub const fn contains(self, flags: Self) -> bool {
        self.0 & flags.0 == flags.0
    }

    pub(crate) fn set(&mut self, flags: Self) {
        self.0 |= flags.0;
    }
}

impl Flags {
    /// Appends what [`Display`](fmt::Display) shows.
    pub(crate) fn push_to(self, row: &mut Vec<u8>) {
        if self.0 == 0 {
            row.extend_from_slice(b"ok");
            return;
        }
        let set = Self::NAMES.iter().filter(|(flag, _)| self.contains(*flag));
        for (index, (_, name)) in set.enumerate() {
            if index > 0 {
                row.push(b'+');
            }
            row.extend_from_slice(name.as_bytes());
        }
    }
}

impl fmt::Display for Flags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = Vec::new();
        self.push_to(&mut text);
        f.write_str(&String::from_utf8_lossy(&text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(what: FaultKind) -> Fault {
        Fault {
            at_min: 1.0,
            duration_min: 2.0,
            what,
        }
    }

    #[test]
    fn a_fault_is_there_from_its_beginning_to_before_its_end() {
        let stuck = fault(FaultKind::TemperatureStuck);
        let there = |time_s: f64| stuck.is_there(time_s - 0.5, time_s);
        assert_eq!(
            [59.5, 60.0, 100.0, 179.5, 180.0].map(there),
            [false, true, true, true, false]
        );
    }

    #[test]
    fn a_spike_takes_one_sample_at_any_rate() {
        let spike = fault(FaultKind::TemperatureSpike { by_c: 10.0 });
        for rate_hz in [0.3, 2.0, 7.0, 64.0] {
            let time = |i: u32| f64::from(i) / rate_hz;
            let count = (1..20_000)
                .filter(|&i| spike.is_there(time(i - 1), time(i)))
                .count();
            assert_eq!(count, 1, "{rate_hz} Hz");
        }
    }

    #[test]
    fn motion_has_an_angle_that_never_jumps() {
        let turn = Motion {
            at_min: 1.0,
            duration_min: 0.5,
            what: MotionKind::Turn {
                rate_dps: [0.0, 0.01, -1.0],
            },
        };
        assert_eq!(turn.angle_arcsec(59.0), [0.0; 3]);
        assert_eq!(turn.angle_arcsec(61.0), [0.0, 36.0, -3600.0]);
        assert_eq!(turn.angle_arcsec(1e4), [0.0, 1080.0, -108_000.0]);
        assert!(!turn.is_there(59.5, 60.0) && turn.is_there(59.9, 60.1));
        let sway = Motion {
            what: MotionKind::Sway {
                amplitude_arcsec: [2.0, 0.0, 0.0],
                frequency_hz: 0.25,
            },
            ..turn
        };
        assert!((sway.angle_arcsec(61.0)[0] - 2.0).abs() < 1e-12);
        assert_eq!(sway.angle_arcsec(90.0), sway.angle_arcsec(1000.0));
    }

    #[test]
    fn flags_are_shown_by_name() {
        let mut flags = Flags::default();
        assert_eq!(flags.to_string(), "ok");
        flags.set(Flags::MOTION);
        flags.set(Flags::TEMPERATURE_FAULT);
        assert_eq!(flags.to_string(), "temperature_fault+motion");
    }
}
