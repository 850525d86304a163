//! The C of the same behaviour, `c/reference.c`, compiled twice: `-O2` and `-O3`.
//!
//! - [`Compiled`]: the functions of one compilation
//! - [`Model`], [`Unit`], [`Inputs`], [`Outputs`], [`Outcome`]: what they work on
//! - [`compare`]: both next to the core, through the same samples

pub mod compare;
mod course;

use tempco::{PLAYS, Table, Terms, ThermalSettings};
use tempco_firmware::table::AXES;

use crate::kernels::BLOCK;

/// What every measured function looks like.
pub type Kernel = extern "C" fn(&mut Unit, &Inputs, &mut Outputs);

/// The functions of one compilation.
#[derive(Clone, Copy)]
pub struct Compiled {
    /// Its name, with which its functions begin.
    pub name: &'static str,
    /// The measured functions with their names: nothing, the thermal half, one sample, a block.
    pub kernels: [(&'static str, Kernel); 4],
    model: extern "C" fn(&mut Model, &Description),
    interval: extern "C" fn(&mut Interval, &Model, f32),
    unit: extern "C" fn(&mut Unit, &Model, u16),
    start: extern "C" fn(&mut Unit, f32),
    status: extern "C" fn(&Unit) -> u32,
    outcome: extern "C" fn(&Unit, &mut Outcome),
}

/// A table for the C: what the core's has, in one piece.
#[repr(C)]
pub struct Description {
    settings: [f32; ThermalSettings::NAMES.len()],
    first_edge_c: f32,
    cells_per_c: f32,
    t_min_c: f32,
    t_max_c: f32,
    play_gains: [[f32; AXES]; PLAYS],
    cells: *const [Terms; AXES],
}

/// The C's `struct model`.
#[derive(Clone, Debug)]
#[repr(C, align(8))]
pub struct Model([u32; 64]);

/// The C's `struct unit`.
#[derive(Clone, Debug)]
#[repr(C, align(8))]
pub struct Unit([u32; 64]);

/// The C's `struct interval`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Interval([u32; 8]);

/// The C's `struct inputs`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Inputs {
    interval: Interval,
    temp_c: f32,
    raw: [f32; AXES],
}

/// The C's `struct outputs`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Outputs {
    /// Of one sample.
    pub compensated: [f32; AXES],
    /// What a block's bias is taken out of.
    pub block: [[f32; AXES]; BLOCK],
}

/// All that a thermal update puts out.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Outcome {
    end: [f32; AXES],
    slope: [f32; AXES],
    effective_c: f32,
    rate_c_per_min: f32,
    lag2_c: f32,
    plays_c: [f32; PLAYS],
    samples: u32,
    ramp_status: u32,
    point_status: u32,
    rejected: u32,
    restarts: u32,
}

/// The functions of a compilation, by the prefix of their names.
macro_rules! compilation {
    ($name:ident, $prefix:literal) => {
        /// A compilation of `c/reference.c`.
        pub const $name: Compiled = {
            // SAFETY: the functions take what they are declared with in `c/reference.c`, which checks
            // the sizes, keep no pointer but that of a unit to its model, and write only where a
            // `&mut` leads.
            #[allow(unsafe_code)]
            unsafe extern "C" {
                #[link_name = concat!($prefix, "empty")]
                safe fn empty(unit: &mut Unit, inputs: &Inputs, outputs: &mut Outputs);
                #[link_name = concat!($prefix, "thermal")]
                safe fn thermal(unit: &mut Unit, inputs: &Inputs, outputs: &mut Outputs);
                #[link_name = concat!($prefix, "subtract")]
                safe fn subtract(unit: &mut Unit, inputs: &Inputs, outputs: &mut Outputs);
                #[link_name = concat!($prefix, "block8")]
                safe fn block8(unit: &mut Unit, inputs: &Inputs, outputs: &mut Outputs);
                #[link_name = concat!($prefix, "model")]
                safe fn model(model: &mut Model, table: &Description);
                #[link_name = concat!($prefix, "interval")]
                safe fn interval(interval: &mut Interval, model: &Model, dt_s: f32);
                #[link_name = concat!($prefix, "unit")]
                safe fn unit(unit: &mut Unit, model: &Model, samples_per_update: u16);
                #[link_name = concat!($prefix, "start")]
                safe fn start(unit: &mut Unit, temp_c: f32);
                #[link_name = concat!($prefix, "status")]
                safe fn status(unit: &Unit) -> u32;
                #[link_name = concat!($prefix, "outcome")]
                safe fn outcome(unit: &Unit, outcome: &mut Outcome);
            }
            Compiled {
                name: $prefix,
                kernels: [
                    ("empty", empty),
                    ("thermal", thermal),
                    ("subtract", subtract),
                    ("block8", block8),
                ],
                model,
                interval,
                unit,
                start,
                status,
                outcome,
            }
        };
    };
}

compilation!(O2, "c_o2_");
compilation!(O3, "c_o3_");

impl Model {
    /// The model of a table.
    pub fn new(compiled: &Compiled, table: &Table<'static, AXES>) -> Self {
        let description = Description {
            settings: table.thermal().settings().to_array(),
            first_edge_c: table.first_edge_c(),
            cells_per_c: table.cells_per_c(),
            t_min_c: table.t_min_c(),
            t_max_c: table.t_max_c(),
            play_gains: *table.play_gains(),
            cells: table.cells().as_ptr(),
        };
        let mut model = Self([0; 64]);
        (compiled.model)(&mut model, &description);
        model
    }
}

impl Inputs {
    /// What a sample brings along.
    pub fn new(
        compiled: &Compiled,
        model: &Model,
        dt_s: f32,
        temp_c: f32,
        raw: [f32; AXES],
    ) -> Self {
        let mut interval = Interval([0; 8]);
        (compiled.interval)(&mut interval, model, dt_s);
        Self {
            interval,
            temp_c,
            raw,
        }
    }
}
