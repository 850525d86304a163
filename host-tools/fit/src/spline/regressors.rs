//! Temperatures and rates of the blocks under a lag shift.

use tempco::{TableError, ThermalSettings};

use crate::least_squares::{Basis, Blocks, Gram, SparseRow};
use crate::method::SplineSearch;
use crate::spline::folds::Folds;
use crate::summary::ChannelData;

/// A time constant with its shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lag {
    pub(crate) tau_s: f64,
    pub(crate) kappa: f64,
}

/// What is not searched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FixedLag {
    pub(crate) tau_s: Option<f64>,
    pub(crate) kappa: Option<f64>,
}

impl FixedLag {
    pub(crate) fn new(search: SplineSearch, settings: &ThermalSettings) -> Self {
        Self {
            tau_s: (!search.tau).then(|| settings.tau_s.into()),
            kappa: (!search.kappa).then(|| settings.kappa.into()),
        }
    }
}

/// Temperatures and rates of the blocks at one time constant.
#[derive(Clone, Debug)]
pub(crate) struct Regressors<'a> {
    temp_c: &'a [f64],
    rates: Vec<f64>,
    tau_s: f64,
}

impl<'a> Regressors<'a> {
    pub(crate) fn new(
        blocks: &'a Blocks,
        data: &ChannelData,
        settings: &ThermalSettings,
        tau_s: f64,
    ) -> Result<Self, TableError> {
        Ok(Self {
            temp_c: &blocks.temp_c,
            rates: blocks.rates(data, settings, tau_s)?,
            tau_s,
        })
    }

    pub(crate) fn tau_s(&self) -> f64 {
        self.tau_s
    }

    pub(crate) fn rates(&self) -> &[f64] {
        &self.rates
    }

    /// Lag-compensated temperature of a block: linear in kappa, as in the core.
    pub(crate) fn effective_c(&self, block: usize, kappa: f64) -> f64 {
        self.temp_c[block] - kappa * self.tau_s / 60.0 * self.rates[block]
    }

    /// Lowest and highest lag-compensated temperature.
    pub(crate) fn range_c(&self, kappa: f64) -> (f64, f64) {
        let count = self.rates.len();
        let temps: Vec<f64> = (0..count).map(|i| self.effective_c(i, kappa)).collect();
        Blocks::range(&temps)
    }

    /// The normal equations of each fold; `history` are the values of the history terms, block
    /// by block.
    pub(crate) fn grams(
        &self,
        blocks: &Blocks,
        folds: &Folds,
        basis: &Basis,
        kappa: f64,
        history: &[Vec<f64>],
    ) -> Vec<Gram> {
        let mut grams = vec![Gram::new(basis.columns(), blocks.axes()); folds.count];
        let mut row = SparseRow::new();
        for (i, block) in blocks.blocks.iter().enumerate() {
            basis.row(
                block.log,
                self.effective_c(i, kappa),
                self.rates[i],
                &mut row,
            );
            basis.push_history(history.iter().map(|state| state[i]), &mut row);
            grams[folds.of_block[i]].push(&row, blocks.observations(i), block.weight);
        }
        grams
    }
}
