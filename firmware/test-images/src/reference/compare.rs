//! The C next to the core, through the same samples.

use tempco::{BiasRamp, Corrector, RampBuffer, Table, ThermalHalf, ThermalPoint};
use tempco_firmware::table::AXES;

use super::course::Course;
use super::{Compiled, Inputs, Model, Outcome, Outputs, Unit};
use crate::kernels::BLOCK;

/// Gyro samples of a ramp.
pub const SAMPLES_PER_UPDATE: u16 = 8;

/// Where the C puts out something else than the core.
#[derive(Clone, Copy, Debug, defmt::Format)]
pub struct Difference {
    /// The compilation.
    pub compiled: &'static str,
    /// Thermal updates before.
    pub update: u32,
    /// The interval \[s\] and the temperature \[degC\] that came last.
    pub dt_s: f32,
    /// The temperature \[degC\].
    pub temp_c: f32,
    /// The output.
    pub output: &'static str,
    /// Its bits in the core.
    pub core: u32,
    /// Its bits in the C.
    pub c: u32,
}

/// Outputs with their names and bits.
type Bits = (&'static str, u32);

/// How many gyro samples are taken one by one after an update, and whether a block follows: in time,
/// early and late.
fn schedule(update: u32) -> (u32, bool) {
    match update % 8 {
        0 => (0, false),
        1 => (1, false),
        2 => (3, true),
        4 => (25, false),
        _ => (0, true),
    }
}

/// Whether the units are started at the temperature of an update: often in the first half, and then
/// never again, as some of what happens takes long.
fn starts(update: u32, updates: u32) -> bool {
    update.is_multiple_of(1531) && update <= updates / 2
}

/// Takes so many hostile updates, and gyro samples after each, with the core and both compilations.
///
/// # Errors
/// The first output that differs in any bit.
pub fn compare(
    compiled: &[Compiled; 2],
    table: &'static Table<'static, AXES>,
    updates: u32,
) -> Result<(), Difference> {
    let models = compiled.each_ref().map(|c| Model::new(c, table));
    let mut units = [0, 1].map(|at| Unit::new(&compiled[at], &models[at]));
    let mut half = ThermalHalf::new(table, SAMPLES_PER_UPDATE);
    let ramps = RampBuffer::new();
    let mut corrector = Corrector::new(&ramps);
    let mut course = Course::new();
    for update in 0..updates {
        let sample = course.next();
        let (dt_s, temp_c, raw) = (sample.dt_s, sample.temp_c, sample.raw);
        let same = |c: &Compiled, core: Bits, of_c: u32| match core {
            (_, bits) if bits == of_c => Ok(()),
            (output, core) => Err(Difference {
                compiled: c.name,
                update,
                dt_s,
                temp_c,
                output,
                core,
                c: of_c,
            }),
        };
        // The thermal half.
        if starts(update, updates) {
            half.start(temp_c);
        }
        let ramp = half.update(&tempco::Interval::new(table.thermal(), dt_s), temp_c);
        ramps.publish(&ramp);
        let published = corrector.status().bits().into();
        let expected = Outcome::of(&ramp, published, &half).words();
        let inputs = [0, 1].map(|at| Inputs::new(&compiled[at], &models[at], dt_s, temp_c, raw));
        let mut outputs = Outputs {
            compensated: [0.0; AXES],
            block: [[0.0; AXES]; BLOCK],
        };
        for ((c, unit), inputs) in compiled.iter().zip(&mut units).zip(&inputs) {
            if starts(update, updates) {
                (c.start)(unit, temp_c);
            }
            c.thermal()(unit, inputs, &mut outputs);
            let mut outcome = Outcome::default();
            (c.outcome)(unit, &mut outcome);
            for (core, (_, of_c)) in expected.into_iter().zip(outcome.words()) {
                same(c, core, of_c)?;
            }
        }
        // The sample half.
        let (singles, has_block) = schedule(update);
        for _ in 0..singles {
            let expected = corrector.correct(raw);
            let status = corrector.status().bits().into();
            for ((c, unit), inputs) in compiled.iter().zip(&mut units).zip(&inputs) {
                c.subtract()(unit, inputs, &mut outputs);
                for (core, of_c) in expected.iter().zip(outputs.compensated) {
                    same(c, ("sample", core.to_bits()), of_c.to_bits())?;
                }
                same(c, ("status of a sample", status), (c.status)(unit))?;
            }
        }
        if has_block {
            let mut expected = [raw; BLOCK];
            corrector.correct_block(&mut expected);
            let status = corrector.status().bits().into();
            for ((c, unit), inputs) in compiled.iter().zip(&mut units).zip(&inputs) {
                outputs.block = [raw; BLOCK];
                c.block8()(unit, inputs, &mut outputs);
                let of_c = outputs.block.as_flattened();
                for (core, of_c) in expected.as_flattened().iter().zip(of_c) {
                    same(c, ("block", core.to_bits()), of_c.to_bits())?;
                }
                same(c, ("status of a block", status), (c.status)(unit))?;
            }
        }
    }
    Ok(())
}

/// Takes so many hostile updates with one compilation, and shows each `every`-th state, with what
/// comes next, before that is taken.
pub fn visit(
    by: &Compiled,
    table: &'static Table<'static, AXES>,
    updates: u32,
    every: u32,
    mut show: impl FnMut(&Unit, &Inputs, &Outputs),
) {
    let model = Model::new(by, table);
    let mut unit = Unit::new(by, &model);
    let mut course = Course::new();
    for update in 0..updates {
        let sample = course.next();
        let inputs = Inputs::new(by, &model, sample.dt_s, sample.temp_c, sample.raw);
        let mut outputs = Outputs {
            compensated: [0.0; AXES],
            block: [sample.raw; BLOCK],
        };
        if starts(update, updates) {
            (by.start)(&mut unit, sample.temp_c);
        }
        if update % every == 0 {
            show(&unit, &inputs, &outputs);
        }
        by.thermal()(&mut unit, &inputs, &mut outputs);
        let (singles, has_block) = schedule(update);
        for _ in 0..singles {
            by.subtract()(&mut unit, &inputs, &mut outputs);
        }
        if has_block {
            by.block8()(&mut unit, &inputs, &mut outputs);
        }
    }
}

impl Compiled {
    fn thermal(&self) -> super::Kernel {
        self.kernels[1].1
    }

    fn subtract(&self) -> super::Kernel {
        self.kernels[2].1
    }

    fn block8(&self) -> super::Kernel {
        self.kernels[3].1
    }
}

impl Unit {
    fn new(compiled: &Compiled, model: &Model) -> Self {
        let mut unit = Self([0; 64]);
        (compiled.unit)(&mut unit, model, SAMPLES_PER_UPDATE);
        unit
    }
}

impl Outcome {
    /// What the core puts out, with the flags that go with the published ramp.
    fn of(ramp: &BiasRamp<AXES>, ramp_status: u32, half: &ThermalHalf<'_, AXES>) -> Self {
        let ThermalPoint {
            effective_c,
            rate_c_per_min,
            lag2_c,
            plays_c,
            status,
        } = half.point();
        Self {
            end: ramp.end,
            slope: ramp.slope,
            effective_c,
            rate_c_per_min,
            lag2_c,
            plays_c,
            samples: ramp.samples.into(),
            ramp_status,
            point_status: status.bits().into(),
            rejected: half.thermal_state().rejected(),
            restarts: half.thermal_state().restarts(),
        }
    }

    fn words(&self) -> [Bits; 16] {
        let [end_x, end_y, end_z] = self.end.map(f32::to_bits);
        let [slope_x, slope_y, slope_z] = self.slope.map(f32::to_bits);
        let [play1, play2] = self.plays_c.map(f32::to_bits);
        [
            ("point_status", self.point_status),
            ("effective_c", self.effective_c.to_bits()),
            ("rate_c_per_min", self.rate_c_per_min.to_bits()),
            ("lag2_c", self.lag2_c.to_bits()),
            ("plays_c[0]", play1),
            ("plays_c[1]", play2),
            ("rejected", self.rejected),
            ("restarts", self.restarts),
            ("status", self.ramp_status),
            ("samples", self.samples),
            ("end[0]", end_x),
            ("end[1]", end_y),
            ("end[2]", end_z),
            ("slope[0]", slope_x),
            ("slope[1]", slope_y),
            ("slope[2]", slope_z),
        ]
    }
}
