//! The functions whose executed instructions the `fixed_bench` image counts.
//!
//! As in [`kernels`](crate::kernels) all have one signature, so that an empty function measures
//! what the measuring itself costs.

use tempco::{Compensator, Interval, Output, Table, TwoRateCompensator};
use tempco_fixed::{
    FixedCompensator, FixedInterval, FixedOutput, FixedTable, FixedTwoRate, PulseCarry, to_f32,
};

use crate::fixed::FixedSample;

/// The compensators under measurement, with their state and their latest results.
#[derive(Clone, Debug)]
pub struct Units<'t, const A: usize, const C: usize> {
    table: &'t FixedTable<A, C>,
    single: FixedCompensator<'t, A, C>,
    two_rate: FixedTwoRate<'t, A, C>,
    carry: Option<PulseCarry>,
    f32_single: Compensator<'t, A>,
    f32_two_rate: TwoRateCompensator<'t, A>,
    interval: Option<FixedInterval>,
    pulses: i32,
    out: Option<FixedOutput<A>>,
    f32_out: Option<Output<A>>,
    f32_compensated: [f32; A],
}

/// What a sample brings along, for both cores.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<const A: usize> {
    sample: FixedSample<A>,
    interval: FixedInterval,
    f32_interval: Interval,
    temp_c: f32,
    f32_raw: [f32; A],
}

/// What every measured function looks like.
pub type Kernel<'t, const A: usize, const C: usize> = fn(&mut Units<'t, A, C>, &Inputs<A>);

impl<const A: usize> Inputs<A> {
    /// The inputs of a sample.
    pub fn new<const C: usize>(
        table: &FixedTable<A, C>,
        f32_table: &Table<'_, A>,
        sample: &FixedSample<A>,
    ) -> Self {
        Self {
            sample: *sample,
            interval: FixedInterval::from_micros(table.thermal(), sample.dt_us),
            f32_interval: Interval::new(f32_table.thermal(), sample.dt_us as f32 * 1e-6),
            temp_c: to_f32(sample.temp),
            f32_raw: sample.raw.map(|raw| raw as f32),
        }
    }
}

impl<'t, const A: usize, const C: usize> Units<'t, A, C> {
    /// Units as after power-on.
    pub fn new(table: &'t FixedTable<A, C>, f32_table: &'t Table<'t, A>, samples: u16) -> Self {
        Self {
            table,
            single: FixedCompensator::new(table),
            two_rate: FixedTwoRate::new(table, samples),
            carry: PulseCarry::new(-30, 1e-3).ok(),
            f32_single: Compensator::new(f32_table),
            f32_two_rate: TwoRateCompensator::new(f32_table, samples),
            interval: None,
            pulses: 0,
            out: None,
            f32_out: None,
            f32_compensated: [0.0; A],
        }
    }

    /// Starts all units at a temperature \[2^-20 degC\].
    pub fn start(&mut self, temp: i32) {
        self.single.start(temp);
        self.two_rate.start(temp);
        self.f32_single.start(to_f32(temp));
        self.f32_two_rate.start(to_f32(temp));
    }

    /// Takes a sample with all units.
    pub fn advance(&mut self, inputs: &Inputs<A>) {
        for kernel in [step, update, compensate, f32_step, f32_update] {
            kernel(self, inputs);
        }
    }
}

/// Nothing: what is left is the cost of measuring, and one instruction to return.
#[inline(never)]
pub fn empty<const A: usize, const C: usize>(_: &mut Units<'_, A, C>, _: &Inputs<A>) {}

/// [`FixedCompensator::step`].
#[inline(never)]
pub fn step<const A: usize, const C: usize>(units: &mut Units<'_, A, C>, inputs: &Inputs<A>) {
    let sample = &inputs.sample;
    let out = units.single.step(&inputs.interval, sample.temp, sample.raw);
    units.out = Some(out);
}

/// [`FixedTwoRate::update`].
#[inline(never)]
pub fn update<const A: usize, const C: usize>(units: &mut Units<'_, A, C>, inputs: &Inputs<A>) {
    units.two_rate.update(&inputs.interval, inputs.sample.temp);
}

/// [`FixedTwoRate::compensate`].
#[inline(never)]
pub fn compensate<const A: usize, const C: usize>(units: &mut Units<'_, A, C>, inputs: &Inputs<A>) {
    units.out = Some(units.two_rate.compensate(inputs.sample.raw));
}

/// [`FixedInterval::from_micros`].
#[inline(never)]
pub fn interval<const A: usize, const C: usize>(units: &mut Units<'_, A, C>, inputs: &Inputs<A>) {
    let thermal = units.table.thermal();
    units.interval = Some(FixedInterval::from_micros(thermal, inputs.sample.dt_us));
}

/// [`PulseCarry::compensate`] of one axis.
#[inline(never)]
pub fn pulses<const A: usize, const C: usize>(units: &mut Units<'_, A, C>, inputs: &Inputs<A>) {
    let raw = inputs.sample.raw[0];
    if let Some(carry) = &mut units.carry {
        units.pulses = carry.compensate(raw, inputs.sample.temp);
    }
}

/// [`Compensator::step`] of the f32 core.
#[inline(never)]
pub fn f32_step<const A: usize, const C: usize>(units: &mut Units<'_, A, C>, inputs: &Inputs<A>) {
    let out = units
        .f32_single
        .step(&inputs.f32_interval, inputs.temp_c, inputs.f32_raw);
    units.f32_out = Some(out);
}

/// [`TwoRateCompensator::update`] of the f32 core.
#[inline(never)]
pub fn f32_update<const A: usize, const C: usize>(units: &mut Units<'_, A, C>, inputs: &Inputs<A>) {
    units
        .f32_two_rate
        .update(&inputs.f32_interval, inputs.temp_c);
}

/// [`TwoRateCompensator::compensate`] of the f32 core.
#[inline(never)]
pub fn f32_compensate<const A: usize, const C: usize>(
    units: &mut Units<'_, A, C>,
    inputs: &Inputs<A>,
) {
    units.f32_compensated = units.f32_two_rate.compensate(inputs.f32_raw);
}
