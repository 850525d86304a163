//! The single-call step: one temperature and one gyro sample per axis in, the bias taken out.

use crate::{HistoryState, Interval, Status, Table, ThermalPoint, ThermalState};

/// All state that the bias of a unit depends on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BiasState<const PLAYS: usize, const SLOW: usize> {
    pub(crate) thermal: ThermalState,
    history: HistoryState<PLAYS, SLOW>,
}

impl<const PLAYS: usize, const SLOW: usize> BiasState<PLAYS, SLOW> {
    /// The state before any temperature was seen.
    pub(crate) const fn new<const AXES: usize>(table: &Table<'_, AXES, PLAYS, SLOW>) -> Self {
        Self {
            thermal: ThermalState::new(table.thermal()),
            history: HistoryState::new(table.thermal().settings().reference_c),
        }
    }

    /// Starts at the first temperature after power-on; there is no history yet, and it adds
    /// nothing to the bias.
    pub(crate) fn start<const AXES: usize>(
        &mut self,
        table: &Table<'_, AXES, PLAYS, SLOW>,
        temp_c: f32,
    ) -> ThermalPoint {
        let point = self.thermal.start(table.thermal(), temp_c);
        self.history = HistoryState::new(point.effective_c);
        point
    }

    /// Takes one temperature; the bias of every axis there, and all flags.
    #[inline(always)]
    pub(crate) fn update<const AXES: usize>(
        &mut self,
        table: &Table<'_, AXES, PLAYS, SLOW>,
        interval: &Interval,
        temp_c: f32,
    ) -> (ThermalPoint, [f32; AXES], Status) {
        let point = self.thermal.update(table.thermal(), interval, temp_c);
        let (mut bias, status) = table.bias(&point);
        let history = table.history();
        let past = self.history.update(history, interval, point.effective_c);
        history.add(&past, &mut bias);
        (point, bias, status)
    }
}

/// Compensates units whose temperature is sampled together with the gyro.
///
/// Where the gyro runs faster than the temperature, use a [`ThermalHalf`](crate::ThermalHalf) and a
/// [`Corrector`](crate::Corrector).
#[derive(Clone, Debug)]
pub struct Compensator<'t, const AXES: usize, const PLAYS: usize = 0, const SLOW: usize = 0> {
    table: &'t Table<'t, AXES, PLAYS, SLOW>,
    state: BiasState<PLAYS, SLOW>,
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

impl<'t, const AXES: usize, const PLAYS: usize, const SLOW: usize>
    Compensator<'t, AXES, PLAYS, SLOW>
{
    /// A compensator that has not seen a temperature: it applies the constant bias.
    pub const fn new(table: &'t Table<'t, AXES, PLAYS, SLOW>) -> Self {
        Self {
            table,
            state: BiasState::new(table),
        }
    }

    /// Starts at the first temperature after power-on \[degC\], without ramping to it.
    pub fn start(&mut self, temp_c: f32) {
        self.state.start(self.table, temp_c);
    }

    /// Takes a temperature \[degC\] and a gyro sample per axis, `interval` after the last ones.
    ///
    /// # Timing
    /// No branch depends on the data: a NaN costs what a good sample costs.
    #[inline(always)]
    pub fn step(&mut self, interval: &Interval, temp_c: f32, raw: [f32; AXES]) -> Output<AXES> {
        let (point, bias, status) = self.state.update(self.table, interval, temp_c);
        Output {
            compensated: core::array::from_fn(|axis| raw[axis] - bias[axis]),
            bias,
            point,
            status: status | Status::of_raw(&raw),
        }
    }

    /// The state of the thermal path, for its counters.
    pub const fn thermal_state(&self) -> &ThermalState {
        &self.state.thermal
    }
}
