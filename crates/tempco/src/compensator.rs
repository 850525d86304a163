//! The single-call step: one temperature and one gyro sample per axis in, the bias taken out.

use crate::{Interval, Status, Table, ThermalPoint, ThermalState};

/// Compensates units whose temperature is sampled together with the gyro.
///
/// Where the gyro runs faster than the temperature, use a [`ThermalHalf`](crate::ThermalHalf) and a
/// [`Corrector`](crate::Corrector).
#[derive(Clone, Debug)]
pub struct Compensator<'t, const AXES: usize> {
    table: &'t Table<'t, AXES>,
    state: ThermalState,
}

/// A compensated sample with everything that led to it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Output<const AXES: usize> {
    /// `raw - bias` \[unit of each axis\].
    pub compensated: [f32; AXES],
    /// The bias that was taken out; always finite \[unit of each axis\].
    pub bias: [f32; AXES],
    /// Where the model was evaluated.
    pub point: ThermalPoint,
    /// Flags of the temperature, the range and the gyro samples.
    pub status: Status,
}

impl<'t, const AXES: usize> Compensator<'t, AXES> {
    /// A compensator that has not seen a temperature: it applies the constant bias.
    pub const fn new(table: &'t Table<'t, AXES>) -> Self {
        Self {
            table,
            state: ThermalState::new(table.thermal()),
        }
    }

    /// Starts at the first temperature after power-on \[degC\], without ramping to it.
    pub fn start(&mut self, temp_c: f32) {
        self.state.start(self.table.thermal(), temp_c);
    }

    /// Takes a temperature \[degC\] and a gyro sample per axis, `interval` after the last ones.
    ///
    /// # Timing
    /// No branch depends on the data: a NaN costs what a good sample costs.
    #[inline(always)]
    pub fn step(&mut self, interval: &Interval, temp_c: f32, raw: [f32; AXES]) -> Output<AXES> {
        let point = self.state.update(self.table.thermal(), interval, temp_c);
        let (bias, status) = self.table.bias(&point);
        Output {
            compensated: core::array::from_fn(|axis| raw[axis] - bias[axis]),
            bias,
            point,
            status: status | Status::of_raw(&raw),
        }
    }

    /// The state of the thermal path, for its counters.
    pub const fn thermal_state(&self) -> &ThermalState {
        &self.state
    }
}
