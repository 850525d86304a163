//! The two-rate pairs of all temperature channels, as a sampling interrupt and a host run them.

use crate::{Interval, Output, Status, Table, TwoRateCompensator};

/// How often a unit samples.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Schedule {
    /// Gyro samples per second \[Hz\].
    pub sample_rate_hz: f32,
    /// Gyro samples between two temperatures.
    pub samples_per_update: u16,
}

impl Schedule {
    /// Time between two temperatures \[s\].
    pub fn update_interval_s(&self) -> f32 {
        f32::from(self.samples_per_update) / self.sample_rate_hz
    }
}

/// One two-rate compensator per temperature channel.
///
/// The first temperatures start every channel; they and all later ones then count as being one
/// update interval after those before.
#[derive(Clone, Debug)]
pub struct Stream<'t, const C: usize, const A: usize, const PLAYS: usize = 0, const SLOW: usize = 0>
{
    tables: &'t [Table<'t, A, PLAYS, SLOW>; C],
    units: [TwoRateCompensator<'t, A, PLAYS, SLOW>; C],
    intervals: [Interval; C],
    is_started: bool,
}

impl<'t, const C: usize, const A: usize, const PLAYS: usize, const SLOW: usize>
    Stream<'t, C, A, PLAYS, SLOW>
{
    /// A stream before its first temperatures: constant biases are taken out.
    pub fn new(tables: &'t [Table<'t, A, PLAYS, SLOW>; C], schedule: &Schedule) -> Self {
        let dt_s = schedule.update_interval_s();
        Self {
            tables,
            units: tables
                .each_ref()
                .map(|table| TwoRateCompensator::new(table, schedule.samples_per_update)),
            intervals: tables
                .each_ref()
                .map(|table| Interval::new(table.thermal(), dt_s)),
            is_started: false,
        }
    }

    /// The tables it runs on.
    pub const fn tables(&self) -> &'t [Table<'t, A, PLAYS, SLOW>; C] {
        self.tables
    }

    /// Takes a temperature per channel; NaN where there is none \[degC\].
    ///
    /// # Timing
    /// No branch depends on the data but for the first call, which starts the channels.
    pub fn temperatures(&mut self, temps_c: &[f32; C]) {
        let channels = self.units.iter_mut().zip(&self.intervals).zip(temps_c);
        for ((unit, interval), temp_c) in channels {
            if !self.is_started {
                unit.start(*temp_c);
            }
            unit.update(interval, *temp_c);
        }
        self.is_started = true;
    }

    /// Takes one gyro sample per axis through every channel \[unit of each axis\].
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline]
    pub fn sample(&mut self, raw: &[[f32; A]; C]) -> [Output<A>; C] {
        core::array::from_fn(|channel| {
            let unit = &mut self.units[channel];
            let raw = raw[channel];
            Output {
                compensated: unit.compensate(raw),
                bias: unit.bias(),
                point: unit.point(),
                status: unit.status() | Status::of_raw(&raw),
            }
        })
    }

    /// Temperatures rejected so far, over all channels.
    pub fn rejected(&self) -> u32 {
        let counts = self
            .units
            .iter()
            .map(|unit| unit.thermal_state().rejected());
        counts.fold(0, u32::saturating_add)
    }
}
