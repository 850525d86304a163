//! What the spline model sees of each block, at any lags.

use std::cell::RefCell;
use std::rc::Rc;

use tempco::{Play, TableError, ThermalSettings};
use tempco_set::run::with_every_rate;

use crate::least_squares::{Basis, Block, Blocks, SamplePoints, SparseRow};
use crate::spline::lags::{Form, HALF_WIDTHS_C, Lags};
use crate::summary::ChannelData;

/// Runs of the core that are remembered.
const REMEMBERED: usize = 32;

/// A mean over the samples of each block.
type BlockMeans = Rc<Vec<f64>>;

/// The lags of each block, as the core finds them, by time constant.
pub(crate) struct Paths<'a> {
    pub(crate) data: &'a ChannelData<'a>,
    pub(crate) blocks: &'a Blocks,
    pub(crate) settings: ThermalSettings,
    /// Rates \[degC/min\] and second lags \[degC\] that were computed, the last ones last.
    rates: RefCell<Vec<(f64, BlockMeans)>>,
    lags2: RefCell<Vec<(f64, BlockMeans)>>,
}

/// The points of all blocks at some lags.
pub(crate) struct Points {
    /// Lag-compensated temperature \[degC\].
    pub(crate) effective_c: Vec<f64>,
    /// \[degC/min\]
    pub(crate) rates: BlockMeans,
    /// \[degC\]
    pub(crate) lags2_c: BlockMeans,
    /// What each play is behind \[degC\].
    pub(crate) plays_c: Vec<Vec<f64>>,
}

impl<'a> Paths<'a> {
    pub(crate) fn new(
        data: &'a ChannelData<'a>,
        blocks: &'a Blocks,
        settings: ThermalSettings,
    ) -> Self {
        Self {
            data,
            blocks,
            settings,
            rates: RefCell::default(),
            lags2: RefCell::default(),
        }
    }

    /// The points at some lags.
    ///
    /// # Errors
    /// Settings that the core refuses.
    pub(crate) fn points(&self, form: &Form, lags: &Lags) -> Result<Points, TableError> {
        let (rates, lags2_c) = self.lags(form, lags)?;
        let mixed = |kappa: f64, kappa2: f64| -> Vec<f64> {
            // The rate is the first lag per time constant, in minutes.
            let shift_min = kappa * lags.tau_s / 60.0;
            let both = self.blocks.temp_c.iter().zip(rates.iter().zip(&*lags2_c));
            let mix = |(temp_c, (rate, lag2_c)): (&f64, (&f64, &f64))| {
                temp_c - shift_min * rate - kappa2 * lag2_c
            };
            both.map(mix).collect()
        };
        let drag_c = mixed(lags.play_kappa, lags.play_kappa2);
        let widths = HALF_WIDTHS_C[..form.plays].iter();
        Ok(Points {
            effective_c: mixed(lags.kappa, lags.kappa2),
            plays_c: widths.map(|&width_c| self.play(width_c, &drag_c)).collect(),
            rates,
            lags2_c,
        })
    }

    /// What a play is behind, which begins where the temperature does in every log.
    fn play(&self, half_width_c: f64, drag_c: &[f64]) -> Vec<f64> {
        let mut play = Play::new(0.0);
        let mut log = usize::MAX;
        let follow = |(block, &drag_c): (&Block, &f64)| {
            if block.log != log {
                (log, play) = (block.log, Play::new(drag_c as f32));
            }
            f64::from(play.follow(half_width_c as f32, drag_c as f32))
        };
        self.blocks.blocks.iter().zip(drag_c).map(follow).collect()
    }

    /// Rates and second lags.
    fn lags(&self, form: &Form, lags: &Lags) -> Result<(BlockMeans, BlockMeans), TableError> {
        let known = |of: &RefCell<Vec<(f64, BlockMeans)>>, tau_s: f64| {
            let known = of.borrow();
            let found = known.iter().find(|(of, _)| *of == tau_s);
            found.map(|(_, means)| means.clone())
        };
        let found = (
            known(&self.rates, lags.tau_s),
            known(&self.lags2, lags.tau2_s),
        );
        if let (Some(rates), Some(lags2)) = found {
            return Ok((rates, lags2));
        }
        let both = Lags {
            kappa: 0.0,
            kappa2: 0.0,
            play_kappa: 0.0,
            play_kappa2: 0.0,
            ..*lags
        };
        let form = Form { plays: 0, ..*form };
        let settings = form.settings(&both, self.settings);
        let points = SamplePoints::new(self.data, &with_every_rate(settings)?);
        let mean = |block: &Block| {
            let (mut rate, mut lag2, mut rows) = (0.0, 0.0, 0.0);
            for kept in points.of_block(block) {
                rate += kept.rows * f64::from(kept.point.rate_c_per_min);
                lag2 += kept.rows * f64::from(kept.point.lag2_c);
                rows += kept.rows;
            }
            (rate / rows, lag2 / rows)
        };
        let (rates, lags2): (Vec<f64>, Vec<f64>) = self.blocks.blocks.iter().map(mean).unzip();
        let (rates, lags2) = (Rc::new(rates), Rc::new(lags2));
        for (of, tau_s, means) in [
            (&self.rates, lags.tau_s, &rates),
            (&self.lags2, lags.tau2_s, &lags2),
        ] {
            let mut known = of.borrow_mut();
            if known.len() == REMEMBERED {
                known.remove(0);
            }
            known.push((tau_s, means.clone()));
        }
        Ok((rates, lags2))
    }
}

impl Points {
    /// The rows of the least squares.
    pub(crate) fn rows(&self, blocks: &Blocks, basis: &Basis) -> Vec<SparseRow> {
        let of_block = blocks.blocks.iter().enumerate();
        let row = |(i, block): (usize, &Block)| {
            let mut row = SparseRow::with_capacity(9);
            basis.row(block.log, self.effective_c[i], self.rates[i], &mut row);
            let plays_c = self.plays_c.iter().map(|play_c| play_c[i]);
            basis.push_history(self.effective_c[i], self.lags2_c[i], plays_c, &mut row);
            row
        };
        of_block.map(row).collect()
    }
}
