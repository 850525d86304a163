//! Settings of the thermal path, and what follows from them.

use crate::error::is_within;
use crate::sign::magnitude;
use crate::{Status, TableError};

/// The number of plays of a table.
pub const PLAYS: usize = 2;

/// Physical settings of the thermal path, as the fit used them and the firmware must.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
// C has it in `table.h`.
#[repr(C)]
pub struct ThermalSettings {
    /// Lowest temperature the sensor can report \[degC\]; below it the sensor is taken as broken.
    pub sensor_min_c: f32,
    /// Highest temperature the sensor can report \[degC\].
    pub sensor_max_c: f32,
    /// Largest accepted jump between neighbouring temperatures beyond `max_slew_c_per_min`
    /// \[degC\]: noise and quantisation of the sensor, generously. Also how far the
    /// lag-compensated temperature may be from where it ramps to without
    /// [`SETTLING`](crate::Status::SETTLING).
    pub spike_gate_c: f32,
    /// Fastest change the part can undergo \[degC/min\]. Bounds what is accepted after a fault,
    /// and the speed at which the lag-compensated temperature, and with it the bias, may move (but for
    /// at least 2e-5 degC per update, which f32 can just represent).
    pub max_slew_c_per_min: f32,
    /// How long the last good temperature is held before it is given up \[s\], at most 20000.
    pub hold_s: f32,
    /// How long [`SETTLING`](crate::Status::SETTLING) outlasts a rejected temperature \[s\], at
    /// most 20000; after several in a row, longer by the time they took.
    pub heal_s: f32,
    /// Time constant of the rate estimator \[s\], 0.1 to 6000.
    pub tau_s: f32,
    /// Shift of the lag-compensated temperature along the sensor's lag, 0 to 2; 0 is the paper.
    pub kappa: f32,
    /// Lowest calibrated rate of temperature \[degC/min\], at most 0.
    pub rate_min_c_per_min: f32,
    /// Highest calibrated rate of temperature \[degC/min\], at least 0.
    pub rate_max_c_per_min: f32,
    /// The temperature whose bias is the constant bias, applied alone when the temperature is
    /// lost \[degC\]; outside the table's range, the nearest end of it counts.
    pub reference_c: f32,
    /// Time constant of the second lag \[s\], 0.1 to 60000.
    pub tau2_s: f32,
    /// Share of the second lag in the lag-compensated temperature, -2 to 2.
    pub kappa2: f32,
    /// Lowest calibrated second lag \[degC\], at most 0.
    pub lag2_min_c: f32,
    /// Highest calibrated second lag \[degC\], at least 0. Where both limits are 0 there is no
    /// second lag.
    pub lag2_max_c: f32,
    /// Half width of the first play (backlash) \[degC\], 0 to 1000; 0 is no play.
    pub half_width1_c: f32,
    /// The same of the second play.
    pub half_width2_c: f32,
    /// As `kappa`, of the temperature that drags the plays, -2 to 2.
    pub play_kappa: f32,
    /// As `kappa2`, of the temperature that drags the plays, -2 to 2.
    pub play_kappa2: f32,
    /// The least number that the rate is divided by after power-on, 0 to 1, where `60 s / tau_s`
    /// is less; 0 is no limit.
    pub least_divisor: f32,
    /// Of a ramp that lasts since before power-on: how many times as large as it is 120 s after
    /// power-on the rate is put then, 0 to 100. 0 puts nothing, neither second lag nor plays.
    pub rate_start: f32,
    /// Where the second lag is put then, per rate, -1000 to 1000 \[degC per degC/min\].
    pub lag2_start_min: f32,
    /// Where a play is put then, per rate, -1000 to 1000 \[degC per degC/min\], within its half
    /// width.
    pub play_start_min: f32,
}

impl ThermalSettings {
    /// A rate since power-on is not trusted with less than this \[s\].
    pub const LEAST_MEMORY_S: f32 = 60.0;

    /// When rate, second lag and plays are put where a lasting ramp has them, after power-on \[s\].
    pub const START_S: f32 = 120.0;

    /// What the fit starts from: a sensor range of -60 to 150 degC, accepted jumps of 2 degC
    /// beyond 30 degC/min, 60 s of hold, a 60 s estimator without shift; no second lag, no plays.
    pub const DEFAULT: Self = Self {
        sensor_min_c: -60.0,
        sensor_max_c: 150.0,
        spike_gate_c: 2.0,
        max_slew_c_per_min: 30.0,
        hold_s: 60.0,
        heal_s: 10.0,
        tau_s: 60.0,
        kappa: 0.0,
        rate_min_c_per_min: -30.0,
        rate_max_c_per_min: 30.0,
        reference_c: 25.0,
        tau2_s: 600.0,
        kappa2: 0.0,
        lag2_min_c: 0.0,
        lag2_max_c: 0.0,
        half_width1_c: 0.0,
        half_width2_c: 0.0,
        play_kappa: 0.0,
        play_kappa2: 0.0,
        least_divisor: 0.0,
        rate_start: 0.0,
        lag2_start_min: 0.0,
        play_start_min: 0.0,
    };

    /// Whether there is a second lag.
    pub const fn has_lag2(&self) -> bool {
        self.lag2_min_c < 0.0 || self.lag2_max_c > 0.0
    }
}

/// Conversions to and from arrays, of the settings in the order in which they are declared.
macro_rules! in_order {
    ($($name:ident),+ $(,)?) => {
        impl ThermalSettings {
            /// Names of the settings, in the order in which they are declared.
            pub const NAMES: [&'static str; [$(stringify!($name)),+].len()] =
                [$(stringify!($name)),+];

            /// The settings in the order of [`NAMES`](Self::NAMES).
            pub const fn to_array(&self) -> [f32; Self::NAMES.len()] {
                [$(self.$name),+]
            }

            /// The inverse of [`to_array`](Self::to_array).
            pub const fn from_array([$($name),+]: [f32; Self::NAMES.len()]) -> Self {
                Self { $($name),+ }
            }
        }
    };
}

in_order! {
    sensor_min_c,
    sensor_max_c,
    spike_gate_c,
    max_slew_c_per_min,
    hold_s,
    heal_s,
    tau_s,
    kappa,
    rate_min_c_per_min,
    rate_max_c_per_min,
    reference_c,
    tau2_s,
    kappa2,
    lag2_min_c,
    lag2_max_c,
    half_width1_c,
    half_width2_c,
    play_kappa,
    play_kappa2,
    least_divisor,
    rate_start,
    lag2_start_min,
    play_start_min,
}

macro_rules! limits {
    ($($name:ident: $least:expr, $most:expr;)+) => {
        /// The least value of each setting, whatever the others are.
        const LEAST: [f32; ThermalSettings::NAMES.len()] =
            ThermalSettings { $($name: $least),+ }.to_array();
        /// The largest value, likewise.
        const MOST: [f32; ThermalSettings::NAMES.len()] =
            ThermalSettings { $($name: $most),+ }.to_array();
    };
}

limits! {
    sensor_min_c: -273.15, 1e3;
    sensor_max_c: -273.15, 1e3;
    spike_gate_c: 1e-3, 1e3;
    max_slew_c_per_min: 1e-3, 1e4;
    hold_s: 0.0, LONGEST_TIMER_S;
    heal_s: 0.0, LONGEST_TIMER_S;
    tau_s: 0.1, 6e3;
    kappa: 0.0, 2.0;
    rate_min_c_per_min: -1e4, 0.0;
    rate_max_c_per_min: 0.0, 1e4;
    reference_c: -273.15, 1e3;
    tau2_s: 0.1, 6e4;
    kappa2: -2.0, 2.0;
    lag2_min_c: -1e3, 0.0;
    lag2_max_c: 0.0, 1e3;
    half_width1_c: 0.0, 1e3;
    half_width2_c: 0.0, 1e3;
    play_kappa: -2.0, 2.0;
    play_kappa2: -2.0, 2.0;
    least_divisor: 0.0, 1.0;
    rate_start: 0.0, 1e2;
    lag2_start_min: -1e3, 1e3;
    play_start_min: -1e3, 1e3;
}

/// The number of the first setting that is not finite or outside its limits; if there is none, the
/// number of settings.
const fn first_unusable(settings: &ThermalSettings) -> usize {
    let values = settings.to_array();
    let mut number = 0;
    while number < values.len() && is_within(values[number], LEAST[number], MOST[number]) {
        number += 1;
    }
    number
}

/// Resolution of the core's timers: 10 us, and 5.9 h at most. Integers, because a sum of many
/// short times in f32 stands still when they fall below its last place.
pub(crate) const TICKS_PER_S: f32 = 1e5;

/// The longest time that is counted, with room to add to it \[s\].
const LONGEST_TIMER_S: f32 = 2e4;

const fn ticks(time_s: f32) -> i32 {
    (time_s * TICKS_PER_S + 0.5) as i32
}

/// Checked [`ThermalSettings`] with what follows from them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Thermal {
    pub(crate) settings: ThermalSettings,
    /// The middle of the sensor's range \[degC\] and how far it reaches from there \[bits of degC\].
    pub(crate) sensor_middle_c: f32,
    pub(crate) sensor_reach: i32,
    pub(crate) hold_ticks: i32,
    /// After this long without an accepted temperature the estimator begins again.
    pub(crate) restart_ticks: i32,
    /// What is left of settling after a temperature was rejected, below zero \[ticks\].
    pub(crate) healing: i32,
    /// The same after a restart: three time constants, when the rate estimate is within 5 % of a
    /// new ramp.
    pub(crate) settling: i32,
    pub(crate) slew_c_per_tick: f32,
    pub(crate) per_tau_hz: f32,
    pub(crate) tau_min: f32,
    /// Shift of the lag-compensated temperature per rate, `kappa tau` \[min\].
    pub(crate) shift_min: f32,
    /// The least share of the estimator's memory that it divides by: `60 s / tau` or the limit of
    /// the settings, at most 1.
    pub(crate) least_memory: f32,
    pub(crate) per_tau2_hz: f32,
    /// As `shift_min`, of the temperature that drags the plays.
    pub(crate) play_shift_min: f32,
    /// Half widths of the plays \[bits of degC\].
    pub(crate) half_widths: [i32; PLAYS],
    /// Where the time to the start begins, below zero; 0 where it is not waited for \[ticks\].
    pub(crate) start: i32,
    /// After a loss of the temperature the history counts as known when this much time has
    /// passed \[ticks\] and the temperature has moved this far \[degC\].
    pub(crate) known_ticks: i32,
    pub(crate) known_c: f32,
    /// The flag of a second lag that was clamped, where there is one.
    pub(crate) lag2_flag: Status,
}

impl Thermal {
    /// Checks the settings.
    ///
    /// # Errors
    /// Names the first setting that is not finite or outside its range.
    // Inlined, so that a program that does not use the names has none of them.
    #[inline(always)]
    pub const fn new(settings: ThermalSettings) -> Result<Self, TableError> {
        let number = first_unusable(&settings);
        if number < ThermalSettings::NAMES.len() {
            return Err(TableError::Setting(ThermalSettings::NAMES[number]));
        }
        if settings.sensor_max_c < settings.sensor_min_c {
            return Err(TableError::Setting("sensor_max_c"));
        }
        if !is_within(
            settings.reference_c,
            settings.sensor_min_c,
            settings.sensor_max_c,
        ) {
            return Err(TableError::Setting("reference_c"));
        }
        Ok(Self::of(&settings))
    }

    /// What follows from settings that were checked.
    const fn of(s: &ThermalSettings) -> Self {
        let has_lag2 = s.has_lag2();
        let least_memory = ThermalSettings::LEAST_MEMORY_S / s.tau_s;
        let least_memory = if least_memory > s.least_divisor {
            least_memory
        } else {
            s.least_divisor
        };
        let sensor_middle_c = 0.5 * (s.sensor_min_c + s.sensor_max_c);
        let below = magnitude(s.sensor_min_c - sensor_middle_c);
        let above = magnitude(s.sensor_max_c - sensor_middle_c);
        Self {
            sensor_middle_c,
            sensor_reach: if below > above { below } else { above },
            hold_ticks: ticks(s.hold_s),
            healing: ticks(s.heal_s).wrapping_neg(),
            settling: ticks(3.0 * s.tau_s).wrapping_neg(),
            restart_ticks: ticks(0.5 * s.tau_s),
            slew_c_per_tick: s.max_slew_c_per_min / (60.0 * TICKS_PER_S),
            per_tau_hz: 1.0 / s.tau_s,
            tau_min: s.tau_s / 60.0,
            shift_min: s.kappa * s.tau_s / 60.0,
            least_memory: if least_memory < 1.0 {
                least_memory
            } else {
                1.0
            },
            per_tau2_hz: 1.0 / s.tau2_s,
            play_shift_min: s.play_kappa * s.tau_s / 60.0,
            half_widths: [magnitude(s.half_width1_c), magnitude(s.half_width2_c)],
            start: if s.rate_start == 0.0 {
                0
            } else {
                ticks(ThermalSettings::START_S).wrapping_neg()
            },
            known_ticks: match has_lag2 {
                true if 3.0 * s.tau2_s < LONGEST_TIMER_S => ticks(3.0 * s.tau2_s),
                true => ticks(LONGEST_TIMER_S),
                false => 0,
            },
            known_c: if s.half_width1_c > s.half_width2_c {
                2.0 * s.half_width1_c
            } else {
                2.0 * s.half_width2_c
            },
            lag2_flag: Status::LAG_CLAMPED.when(has_lag2),
            settings: *s,
        }
    }

    /// The settings this was made from.
    pub const fn settings(&self) -> &ThermalSettings {
        &self.settings
    }

    /// The longest time between two thermal updates \[s\]: half the time constant. A longer one
    /// restarts the estimator.
    pub const fn longest_interval_s(&self) -> f32 {
        0.5 * self.settings.tau_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_go_through_an_array_in_the_order_of_their_names() {
        let numbers = core::array::from_fn(|number| number as f32);
        let settings = ThermalSettings::from_array(numbers);
        assert_eq!(settings.to_array(), numbers);
        assert_eq!(ThermalSettings::NAMES[6], "tau_s");
        assert_eq!((settings.sensor_min_c, settings.tau_s), (0.0, 6.0));
    }

    #[test]
    fn bad_settings_are_refused_by_name() {
        macro_rules! refuse {
            ($($name:ident: $($value:expr),+;)+) => {$($(
                let settings = ThermalSettings { $name: $value, ..ThermalSettings::DEFAULT };
                assert_eq!(Thermal::new(settings).unwrap_err(), TableError::Setting(stringify!($name)));
                let settings = ThermalSettings { $name: f32::NAN, ..ThermalSettings::DEFAULT };
                assert_eq!(Thermal::new(settings).unwrap_err(), TableError::Setting(stringify!($name)));
            )+)+};
        }
        refuse! {
            sensor_min_c: -300.0;
            sensor_max_c: -61.0, f32::INFINITY;
            spike_gate_c: 0.0;
            max_slew_c_per_min: 0.0, -1.0;
            hold_s: -1.0;
            heal_s: -1.0;
            tau_s: 0.0, f32::INFINITY;
            kappa: -0.1, 2.1;
            rate_min_c_per_min: 0.1;
            rate_max_c_per_min: -0.1;
            reference_c: -61.0, 151.0;
            tau2_s: 0.0, 6.1e4;
            kappa2: -2.1, 2.1;
            lag2_min_c: 0.1, -1001.0;
            lag2_max_c: -0.1, 1001.0;
            half_width1_c: -0.1, 1001.0;
            half_width2_c: -0.1, 1001.0;
            play_kappa: -2.1, 2.1;
            play_kappa2: -2.1, 2.1;
            least_divisor: -0.1, 1.1;
            rate_start: -0.1, 101.0;
            lag2_start_min: -1001.0, 1001.0;
            play_start_min: -1001.0, 1001.0;
        }
    }

    fn thermal(change: impl FnOnce(&mut ThermalSettings)) -> Thermal {
        let mut settings = ThermalSettings::DEFAULT;
        change(&mut settings);
        Thermal::new(settings).unwrap()
    }

    /// How long after a loss the history is not known: three times the slower time constant, as far
    /// as it can be counted.
    #[test]
    fn a_second_lag_is_known_after_three_time_constants() {
        for (min_c, max_c, ticks_of_1000_s) in [
            (0.0, 0.0, 0),
            (-1.0, 0.0, ticks(3000.0)),
            (0.0, 1.0, ticks(3000.0)),
            (-1.0, 1.0, ticks(3000.0)),
        ] {
            let of = |tau2_s| {
                thermal(|of| {
                    (of.tau2_s, of.lag2_min_c, of.lag2_max_c) = (tau2_s, min_c, max_c);
                })
            };
            let found = of(1000.0);
            assert_eq!(found.known_ticks, ticks_of_1000_s, "{min_c} {max_c}");
            let has_lag2 = ticks_of_1000_s > 0;
            assert_eq!(found.settings().has_lag2(), has_lag2);
            assert_eq!(found.lag2_flag, Status::LAG_CLAMPED.when(has_lag2));
            let longest = if has_lag2 { ticks(LONGEST_TIMER_S) } else { 0 };
            assert_eq!(
                [1e4, 6e4].map(|tau2_s| of(tau2_s).known_ticks),
                [longest; 2]
            );
        }
    }

    /// A play is where it seems to be once the temperature has moved through the widest of them.
    #[test]
    fn plays_are_known_after_the_width_of_the_widest() {
        for (width1_c, width2_c, known_c) in [(1.5, 2.5, 5.0), (2.5, 1.5, 5.0), (0.0, 0.0, 0.0)] {
            let found = thermal(|of| (of.half_width1_c, of.half_width2_c) = (width1_c, width2_c));
            assert_eq!(found.known_c, known_c);
            assert_eq!(
                found.half_widths,
                [magnitude(width1_c), magnitude(width2_c)]
            );
        }
    }

    /// In minutes, as the rate is in degC/min.
    #[test]
    fn shares_of_the_lag_and_the_start_are_in_the_units_of_the_core() {
        let found = thermal(|of| (of.tau_s, of.kappa, of.play_kappa) = (120.0, 0.5, -0.25));
        assert_eq!(found.tau_min, 2.0);
        assert_eq!((found.shift_min, found.play_shift_min), (1.0, -0.5));
        assert_eq!(thermal(|of| of.tau2_s = 8.0).per_tau2_hz, 0.125);
        assert_eq!(found.start, 0);
        let starts = thermal(|of| of.rate_start = 1.0);
        assert_eq!(starts.start, -ticks(ThermalSettings::START_S));
        let divisor =
            |tau_s, least| thermal(|of| (of.tau_s, of.least_divisor) = (tau_s, least)).least_memory;
        assert_eq!(divisor(120.0, 0.0), 0.5);
        assert_eq!(divisor(120.0, 0.75), 0.75);
        assert_eq!(divisor(30.0, 0.0), 1.0);
    }
}
