//! The single-call step: one temperature and one gyro sample per axis in, the bias taken out.

use tempco::Status;

use crate::format::INVALID;
use crate::history::HistoryState;
use crate::mask::{Mask, saturating_difference};
use crate::{FixedInterval, FixedPoint, FixedTable, FixedThermalState};

/// All state that the bias of a unit depends on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BiasState<const PLAYS: usize, const SLOW: usize> {
    pub(crate) thermal: FixedThermalState,
    history: HistoryState<PLAYS, SLOW>,
}

impl<const PLAYS: usize, const SLOW: usize> BiasState<PLAYS, SLOW> {
    /// The state before any temperature was seen.
    pub(crate) const fn new<const AXES: usize, const CELLS: usize>(
        table: &FixedTable<AXES, CELLS, PLAYS, SLOW>,
    ) -> Self {
        Self {
            thermal: FixedThermalState::new(table.thermal()),
            history: HistoryState::new(table.thermal().reference),
        }
    }

    /// Starts at the first temperature after power-on; there is no history yet, and it adds
    /// nothing to the bias.
    pub(crate) fn start<const AXES: usize, const CELLS: usize>(
        &mut self,
        table: &FixedTable<AXES, CELLS, PLAYS, SLOW>,
        temp: i32,
    ) -> FixedPoint {
        let point = self.thermal.start(table.thermal(), temp);
        self.history = HistoryState::new(point.effective);
        point
    }

    /// Takes one temperature; the bias of every axis there, and all remarks.
    #[inline]
    pub(crate) fn update<const AXES: usize, const CELLS: usize>(
        &mut self,
        table: &FixedTable<AXES, CELLS, PLAYS, SLOW>,
        interval: &FixedInterval,
        temp: i32,
    ) -> (FixedPoint, [i32; AXES], Status) {
        let before = self.thermal.effective();
        let point = self.thermal.update(table.thermal(), interval, temp);
        let (mut bias, status) = table.bias(&point);
        let history = table.history();
        // Both are within 2^30 of zero.
        let movement = point.effective - before;
        self.history
            .update(history, interval, point.effective, movement);
        history.add(&self.history, point.effective, &mut bias);
        (point, bias, status)
    }
}

/// Compensates units whose temperature is sampled together with the gyro.
///
/// Where the gyro runs faster than the temperature, use [`FixedTwoRate`](crate::FixedTwoRate).
#[derive(Clone, Debug)]
pub struct FixedCompensator<
    't,
    const AXES: usize,
    const CELLS: usize,
    const PLAYS: usize = 0,
    const SLOW: usize = 0,
> {
    table: &'t FixedTable<AXES, CELLS, PLAYS, SLOW>,
    state: BiasState<PLAYS, SLOW>,
}

/// A compensated sample with everything that led to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FixedOutput<const AXES: usize> {
    /// `raw - bias` \[2^exponent of each axis's unit\].
    pub compensated: [i32; AXES],
    /// The bias that was taken out \[2^exponent of each axis's unit\].
    pub bias: [i32; AXES],
    /// Where the model was evaluated.
    pub point: FixedPoint,
    /// Remarks on the temperature, the range and the gyro samples.
    pub status: Status,
}

impl<'t, const AXES: usize, const CELLS: usize, const PLAYS: usize, const SLOW: usize>
    FixedCompensator<'t, AXES, CELLS, PLAYS, SLOW>
{
    /// A compensator that has not seen a temperature: it applies the constant bias.
    pub const fn new(table: &'t FixedTable<AXES, CELLS, PLAYS, SLOW>) -> Self {
        Self {
            table,
            state: BiasState::new(table),
        }
    }

    /// Starts at the first temperature after power-on \[2^-20 degC\], without ramping to it.
    pub fn start(&mut self, temp: i32) {
        self.state.start(self.table, temp);
    }

    /// Takes a temperature \[2^-20 degC\] and a gyro sample per axis \[2^exponent\], `interval`
    /// after the last ones; [`INVALID`] where there is none.
    ///
    /// An invalid gyro sample is passed through. A difference that does not fit saturates and is
    /// flagged [`Status::RAW_INVALID`] as well.
    ///
    /// # Timing
    /// No branch depends on the data.
    #[inline]
    pub fn step(
        &mut self,
        interval: &FixedInterval,
        temp: i32,
        raw: [i32; AXES],
    ) -> FixedOutput<AXES> {
        let (point, bias, status) = self.state.update(self.table, interval, temp);
        subtract(raw, bias, point, status)
    }

    /// The state of the thermal path, for its counters.
    pub const fn thermal_state(&self) -> &FixedThermalState {
        &self.state.thermal
    }
}

/// Takes the bias out of a sample and checks the sample.
#[inline]
pub(crate) fn subtract<const AXES: usize>(
    raw: [i32; AXES],
    bias: [i32; AXES],
    point: FixedPoint,
    status: Status,
) -> FixedOutput<AXES> {
    let mut wrong = Mask::NO;
    let compensated = core::array::from_fn(|axis| {
        let invalid = Mask::invalid(raw[axis]);
        let (difference, beyond) = saturating_difference(raw[axis], bias[axis]);
        wrong = wrong.or(invalid).or(beyond);
        invalid.pick(INVALID, difference)
    });
    FixedOutput {
        compensated,
        bias,
        point,
        status: status | wrong.flags(Status::RAW_INVALID),
    }
}
