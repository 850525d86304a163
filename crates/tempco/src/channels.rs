//! The halves of all temperature channels.

use crate::{
    BiasRamp, Corrector, Interval, Output, RampBuffer, Status, Table, ThermalHalf, ThermalPoint,
};

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

/// The thermal half of each temperature channel.
///
/// The first temperatures start every channel, and count as being one time step after themselves.
#[derive(Clone, Debug)]
pub struct ThermalChannels<'t, const C: usize, const A: usize> {
    tables: &'t [Table<'t, A>; C],
    halves: [ThermalHalf<'t, A>; C],
    is_started: bool,
}

impl<'t, const C: usize, const A: usize> ThermalChannels<'t, C, A> {
    /// Channels before their first temperatures.
    pub fn new(tables: &'t [Table<'t, A>; C], samples_per_update: u16) -> Self {
        Self {
            tables,
            halves: tables
                .each_ref()
                .map(|table| ThermalHalf::new(table, samples_per_update)),
            is_started: false,
        }
    }

    /// The constant biases, to be applied before the first temperatures.
    pub fn constant(&self) -> [BiasRamp<A>; C] {
        self.tables.each_ref().map(ThermalHalf::constant)
    }

    /// Takes a temperature per channel, `dt_s` after the ones before; NaN where there is none
    /// \[degC\].
    pub fn update(&mut self, dt_s: f32, temps_c: &[f32; C]) -> [BiasRamp<A>; C] {
        let is_first = !core::mem::replace(&mut self.is_started, true);
        core::array::from_fn(|channel| {
            let half = &mut self.halves[channel];
            let temp_c = temps_c[channel];
            if is_first {
                half.start(temp_c);
            }
            let interval = Interval::new(self.tables[channel].thermal(), dt_s);
            half.update(&interval, temp_c)
        })
    }

    /// Goes on with copies of the same tables, as where the ones before were damaged in memory. The
    /// next ramp begins where the last one ends.
    pub fn move_to(&mut self, tables: &'t [Table<'t, A>; C]) {
        self.tables = tables;
        for (half, table) in self.halves.iter_mut().zip(tables) {
            half.move_to(table);
        }
    }

    /// Where the models were evaluated at the last update.
    pub fn points(&self) -> [ThermalPoint; C] {
        self.halves.each_ref().map(ThermalHalf::point)
    }

    /// Temperatures rejected so far, over all channels.
    pub fn rejected(&self) -> u32 {
        let counts = self
            .halves
            .iter()
            .map(|half| half.thermal_state().rejected());
        counts.fold(0, u32::saturating_add)
    }
}

/// Both halves of each temperature channel, for those who have the temperatures between the gyro
/// samples: a host that computes what a unit does, and tests.
#[derive(Debug)]
pub struct Stream<'t, const C: usize, const A: usize> {
    thermal: ThermalChannels<'t, C, A>,
    ramps: [RampBuffer<A>; C],
    update_interval_s: f32,
}

impl<'t, const C: usize, const A: usize> Stream<'t, C, A> {
    /// A stream before its first temperatures: constant biases are taken out.
    pub fn new(tables: &'t [Table<'t, A>; C], schedule: &Schedule) -> Self {
        let stream = Self {
            thermal: ThermalChannels::new(tables, schedule.samples_per_update),
            ramps: [const { RampBuffer::new() }; C],
            update_interval_s: schedule.update_interval_s(),
        };
        stream.publish(&stream.thermal.constant());
        stream
    }

    /// Takes a temperature per channel; NaN where there is none \[degC\].
    pub fn temperatures(&mut self, temps_c: &[f32; C]) {
        let ramps = self.thermal.update(self.update_interval_s, temps_c);
        self.publish(&ramps);
    }

    fn publish(&self, ramps: &[BiasRamp<A>; C]) {
        for (buffer, ramp) in self.ramps.iter().zip(ramps) {
            buffer.publish(ramp);
        }
    }

    /// Takes one gyro sample per axis through every channel \[unit of each axis\].
    pub fn sample(&mut self, raw: &[[f32; A]; C]) -> [Output<A>; C] {
        let points = self.thermal.points();
        core::array::from_fn(|channel| {
            let raw = raw[channel];
            let (bias, status) = Corrector::new(&self.ramps[channel]).advance::<1>();
            Output {
                compensated: core::array::from_fn(|axis| raw[axis] - bias[axis]),
                bias,
                point: points[channel],
                status: status | Status::of_raw(&raw),
            }
        })
    }
}
