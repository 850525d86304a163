//! The functions whose executed instructions the `bench` image counts.
//!
//! All have one signature, so that an empty function of that signature measures exactly what the
//! measuring itself costs: the call, the arguments and the loop around them.

use tempco::{Compensator, Interval, Output, Table, ThermalPoint, TwoRateCompensator};

/// The compensators under measurement, with their state.
#[derive(Clone, Debug)]
pub struct Units<'t, const A: usize> {
    /// The single-call pipeline.
    pub single: Compensator<'t, A>,
    /// The two-rate pair.
    pub two_rate: TwoRateCompensator<'t, A>,
    /// The baseline.
    pub cubic: Cubic<A>,
    /// Where [`interval`] puts its result.
    pub interval: Interval,
    table: &'t Table<'t, A>,
}

/// What a sample brings along.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<const A: usize> {
    /// Time since the sample before, with its factors.
    pub interval: Interval,
    /// The same time \[s\].
    pub dt_s: f32,
    /// Temperature \[degC\].
    pub temp_c: f32,
    /// Gyro samples.
    pub raw: [f32; A],
}

/// What every measured function looks like.
pub type Kernel<'t, const A: usize> = fn(&mut Units<'t, A>, &Inputs<A>, &mut Output<A>);

impl<'t, const A: usize> Units<'t, A> {
    /// Units as after power-on.
    pub fn new(table: &'t Table<'t, A>, samples_per_update: u16) -> Self {
        Self {
            single: Compensator::new(table),
            two_rate: TwoRateCompensator::new(table, samples_per_update),
            cubic: Cubic::tangent_to(table),
            interval: Interval::new(table.thermal(), 0.0),
            table,
        }
    }

    /// Starts all units at a temperature \[degC\].
    pub fn start(&mut self, temp_c: f32) {
        self.single.start(temp_c);
        self.two_rate.start(temp_c);
    }
}

/// Nothing: what is left is the cost of measuring, and one instruction to return.
#[inline(never)]
pub fn empty<const A: usize>(_: &mut Units<'_, A>, _: &Inputs<A>, _: &mut Output<A>) {}

/// [`Compensator::step`]: conditioning, rate, place, polynomial and subtraction of all axes.
#[inline(never)]
pub fn step<const A: usize>(units: &mut Units<'_, A>, inputs: &Inputs<A>, out: &mut Output<A>) {
    *out = units
        .single
        .step(&inputs.interval, inputs.temp_c, inputs.raw);
}

/// [`TwoRateCompensator::update`]: the thermal work.
#[inline(never)]
pub fn update<const A: usize>(units: &mut Units<'_, A>, inputs: &Inputs<A>, out: &mut Output<A>) {
    out.point = units.two_rate.update(&inputs.interval, inputs.temp_c);
}

/// [`TwoRateCompensator::compensate`]: the subtraction at the gyro's rate.
#[inline(never)]
pub fn compensate<const A: usize>(
    units: &mut Units<'_, A>,
    inputs: &Inputs<A>,
    out: &mut Output<A>,
) {
    out.compensated = units.two_rate.compensate(inputs.raw);
}

/// [`Interval::new`]: what a varying sample time costs on top.
#[inline(never)]
pub fn interval<const A: usize>(units: &mut Units<'_, A>, inputs: &Inputs<A>, _: &mut Output<A>) {
    units.interval = Interval::new(units.table.thermal(), inputs.dt_s);
}

/// The baseline: [`Cubic::compensate`].
#[inline(never)]
pub fn cubic<const A: usize>(units: &mut Units<'_, A>, inputs: &Inputs<A>, out: &mut Output<A>) {
    units.cubic.compensate(inputs.temp_c, inputs.raw, out);
}

/// The baseline: what autopilots usually do, written from its formula.
///
/// ```text
/// d   = clamp(T, t_min, t_max) - T_ref
/// B   = c0 + d (c1 + d (c2 + d c3))          per axis
/// out = raw - B
/// ```
///
/// One polynomial over the whole range; no rate of temperature, no conditioning, no status: a NaN
/// temperature makes a NaN bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic<const A: usize> {
    /// Cold end of the calibrated range \[degC\].
    pub t_min_c: f32,
    /// Hot end of the calibrated range \[degC\].
    pub t_max_c: f32,
    /// Reference temperature \[degC\].
    pub reference_c: f32,
    /// Coefficients of each axis, lowest power first \[unit of the axis per degC^power\].
    pub coefficients: [[f32; 4]; A],
}

impl<const A: usize> Cubic<A> {
    /// A cubic with a table's range, and its bias and slope at the reference temperature. How
    /// well it fits does not matter for what it costs.
    fn tangent_to(table: &Table<'_, A>) -> Self {
        let reference_c = table.thermal().settings().reference_c;
        let bias_at = |effective_c| {
            let point = ThermalPoint {
                effective_c,
                ..ThermalPoint::default()
            };
            table.bias(&point).0
        };
        let (here, next) = (bias_at(reference_c), bias_at(reference_c + 1.0));
        Self {
            t_min_c: table.t_min_c(),
            t_max_c: table.t_max_c(),
            reference_c,
            coefficients: core::array::from_fn(|axis| {
                [here[axis], next[axis] - here[axis], 1e-5, 1e-7]
            }),
        }
    }

    /// Takes the bias out of one sample per axis; only `compensated` and `bias` are written.
    #[inline]
    pub fn compensate(&self, temp_c: f32, raw: [f32; A], out: &mut Output<A>) {
        let temp_c = if temp_c < self.t_min_c {
            self.t_min_c
        } else {
            temp_c
        };
        let temp_c = if temp_c > self.t_max_c {
            self.t_max_c
        } else {
            temp_c
        };
        let d = temp_c - self.reference_c;
        out.bias = self
            .coefficients
            .map(|[c0, c1, c2, c3]| c0 + d * (c1 + d * (c2 + d * c3)));
        out.compensated = core::array::from_fn(|axis| raw[axis] - out.bias[axis]);
    }
}
