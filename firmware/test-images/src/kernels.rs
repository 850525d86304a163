//! The functions whose executed instructions the `bench` image counts.
//!
//! All have one signature, so that an empty function of that signature measures exactly what the
//! measuring itself costs: the call, the arguments and the loop around them.

use tempco::{
    Compensator, Corrector, Interval, Output, PulseCorrector, RampBuffer, Table, ThermalHalf,
};

#[cfg(not(feature = "link-guard"))]
use crate::baselines::Baselines;

/// The compensators under measurement, with their state.
///
/// In this order in memory: what a firmware would have a pointer to comes first.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Units<'t, const A: usize> {
    /// The single-call pipeline.
    pub single: Compensator<'t, A>,
    /// The thermal half.
    pub thermal: ThermalHalf<'t, A>,
    /// From there to the sample half.
    pub ramps: &'t RampBuffer<A>,
    /// The sample half for whole pulses.
    pub whole: PulseCorrector<'t, A>,
    /// Where [`interval`] puts its result.
    pub interval: Interval,
    /// Where [`pulses`] puts its result.
    pub pulses: [i32; A],
    /// What [`block8`] takes the bias out of.
    pub block: [[f32; A]; BLOCK],
    /// What is usually done instead; no part of an image that proves something of the core.
    #[cfg(not(feature = "link-guard"))]
    pub baselines: Baselines<A>,
    table: &'t Table<'t, A>,
}

/// From the thermal halves to the sample halves.
#[derive(Debug, Default)]
pub struct Buffers<const A: usize> {
    ramps: RampBuffer<A>,
    whole: RampBuffer<A, i32>,
}

impl<const A: usize> Buffers<A> {
    /// Without a ramp.
    pub const fn new() -> Self {
        Self {
            ramps: RampBuffer::new(),
            whole: RampBuffer::new(),
        }
    }
}

/// Gyro samples of a block.
pub const BLOCK: usize = 8;

/// What a sample brings along.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Inputs<const A: usize> {
    /// Time since the sample before, with its factors.
    pub interval: Interval,
    /// The same time \[s\].
    pub dt_s: f32,
    /// Temperature \[degC\].
    pub temp_c: f32,
    /// Gyro samples.
    pub raw: [f32; A],
    /// A sample in pulses.
    pub pulses: [i32; A],
}

/// What every measured function looks like.
pub type Kernel<'t, const A: usize> = fn(&mut Units<'t, A>, &Inputs<A>, &mut Output<A>);

impl<'t, const A: usize> Units<'t, A> {
    /// Units as after power-on.
    pub fn new(table: &'t Table<'t, A>, buffers: &'t Buffers<A>, samples_per_update: u16) -> Self {
        Self {
            single: Compensator::new(table),
            thermal: ThermalHalf::new(table, samples_per_update),
            ramps: &buffers.ramps,
            whole: PulseCorrector::new(&buffers.whole),
            interval: Interval::new(table.thermal(), 0.0),
            pulses: [0; A],
            block: [[0.0; A]; BLOCK],
            #[cfg(not(feature = "link-guard"))]
            baselines: Baselines::new(table),
            table,
        }
    }

    /// Starts all units at a temperature \[degC\].
    pub fn start(&mut self, temp_c: f32) {
        self.single.start(temp_c);
        self.thermal.start(temp_c);
    }

    /// Takes the thermal inputs of a sample with all units.
    pub fn advance(&mut self, inputs: &Inputs<A>, out: &mut Output<A>) {
        step(self, inputs, out);
        thermal(self, inputs, out);
    }
}

/// Nothing: what is left is the cost of measuring, and what every function has (its return, and
/// its frame pointer where the target wants one).
#[inline(never)]
pub fn empty<const A: usize>(_: &mut Units<'_, A>, _: &Inputs<A>, _: &mut Output<A>) {}

/// [`Compensator::step`]: conditioning, rate, place, polynomial and subtraction of all axes.
#[inline(never)]
pub fn step<const A: usize>(units: &mut Units<'_, A>, inputs: &Inputs<A>, out: &mut Output<A>) {
    *out = units
        .single
        .step(&inputs.interval, inputs.temp_c, inputs.raw);
}

/// [`ThermalHalf::update`] and [`RampBuffer::publish`]: the thermal work.
#[inline(never)]
pub fn thermal<const A: usize>(units: &mut Units<'_, A>, inputs: &Inputs<A>, _: &mut Output<A>) {
    let ramp = units.thermal.update(&inputs.interval, inputs.temp_c);
    units.ramps.publish(&ramp);
}

/// [`Corrector::correct`]: a gyro sample along its ramp.
#[inline(never)]
pub fn subtract<const A: usize>(units: &mut Units<'_, A>, inputs: &Inputs<A>, out: &mut Output<A>) {
    out.compensated = Corrector::new(units.ramps).correct(inputs.raw);
}

/// [`Corrector::correct_block`]: as many as a FIFO holds.
#[inline(never)]
pub fn block8<const A: usize>(units: &mut Units<'_, A>, _: &Inputs<A>, _: &mut Output<A>) {
    Corrector::new(units.ramps).correct_block(&mut units.block);
}

/// [`Interval::new`]: what a varying sample time costs on top.
#[inline(never)]
pub fn interval<const A: usize>(units: &mut Units<'_, A>, inputs: &Inputs<A>, _: &mut Output<A>) {
    units.interval = Interval::new(units.table.thermal(), inputs.dt_s);
}

/// [`PulseCorrector::correct`]: a gyro sample in whole pulses.
#[inline(never)]
pub fn pulses<const A: usize>(units: &mut Units<'_, A>, inputs: &Inputs<A>, _: &mut Output<A>) {
    units.pulses = units.whole.correct(inputs.pulses);
}

/// Measured functions of the baselines, of the names of their fields.
#[cfg(not(feature = "link-guard"))]
macro_rules! baselines {
    ($($name:ident: $what:ident;)+) => {$(
        #[doc = concat!("A baseline: [`", stringify!($what), "`](crate::baselines::", stringify!($what), ").")]
        #[inline(never)]
        pub fn $name<const A: usize>(
            units: &mut Units<'_, A>,
            inputs: &Inputs<A>,
            out: &mut Output<A>,
        ) {
            units.baselines.$name.compensate(inputs.temp_c, inputs.raw, out);
        }
    )+};
}

#[cfg(not(feature = "link-guard"))]
baselines! {
    cubic: Cubic;
    lookup_14: Lookup14;
    composite_f32: CompositeF32;
    composite_f64: CompositeF64;
}
