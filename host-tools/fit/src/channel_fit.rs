//! The fit of a channel, whatever its model, and how it becomes a part of the set.

use tempco::{Terms, ThermalSettings};
use tempco_set::build::{self, Fitted};
use tempco_set::{
    AxisSet, ChannelSet, CoefficientSigmas, GainSet, HeldOutErrors, NoiseSet, Outliers, Overlap,
    Polynomial, SegmentSet, Segmentation, Selection,
};

use crate::summary::ChannelData;

/// A fitted channel before its table is made.
pub(crate) struct ChannelFit {
    /// Settings of the thermal path; limits of rate and lag and reference temperature are not set
    /// yet.
    pub(crate) thermal: ThermalSettings,
    /// Range of lag-compensated temperatures that was measured and is modelled \[degC\].
    pub(crate) calibrated_c: (f32, f32),
    /// Range of rates that was measured \[degC/min\].
    pub(crate) rates: (f32, f32),
    /// Range of second lags that was measured \[degC\].
    pub(crate) lags: (f32, f32),
    pub(crate) segmentation: Segmentation,
    pub(crate) overlap: Overlap,
    pub(crate) segments: Vec<SegmentSet>,
    /// By axis and segment.
    pub(crate) polynomials: Vec<Vec<Polynomial>>,
    /// By axis and segment.
    pub(crate) sigmas: Vec<Vec<CoefficientSigmas>>,
    /// By axis, where `sigmas` account for it.
    pub(crate) noises: Vec<Option<NoiseSet>>,
    /// By axis and play.
    pub(crate) gains: Vec<Vec<GainSet>>,
}

/// What was found on the way to a fit.
pub(crate) struct Findings {
    pub(crate) outliers: Outliers,
    pub(crate) selection: Option<Selection>,
    /// By axis.
    pub(crate) held_out: Vec<HeldOutErrors>,
}

impl ChannelFit {
    /// Leaves an axis without terms: it keeps `constant` alone.
    pub(crate) fn keep_constant(&mut self, axis: usize, constant: f64) {
        // A number of the table, so that its cells do not differ by rounding.
        let constant = f64::from(constant as f32);
        for polynomial in &mut self.polynomials[axis] {
            polynomial.a = [constant, 0.0, 0.0];
            polynomial.r = [0.0; Terms::RATE];
            polynomial.s = [0.0; Terms::LAG];
        }
        self.sigmas[axis].fill(CoefficientSigmas::new(&[], &[]));
        self.noises[axis] = None;
        self.gains[axis].fill(GainSet::default());
    }

    /// Makes the table.
    pub(crate) fn into_set(self, data: &ChannelData, findings: Findings) -> ChannelSet {
        let reference_c = match self.calibrated_c {
            (low, high) if (low..=high).contains(&25.0) => 25.0,
            (low, high) => 0.5 * (low + high),
        };
        let thermal = ThermalSettings {
            rate_min_c_per_min: self.rates.0.min(0.0),
            rate_max_c_per_min: self.rates.1.max(0.0),
            lag2_min_c: self.lags.0.min(0.0),
            lag2_max_c: self.lags.1.max(0.0),
            reference_c,
            ..self.thermal
        };
        let channel = data.of(0);
        let fitted = Fitted {
            temperature: channel.column.clone(),
            segments: self.segments,
            axes: channel
                .axes
                .iter()
                .zip(self.polynomials)
                .zip(self.sigmas.into_iter().zip(self.noises).zip(self.gains))
                .zip(findings.held_out)
                .map(
                    |(((axis, polynomials), ((sigmas, noise), gains)), held_out)| AxisSet {
                        name: axis.name.clone(),
                        unit: axis.unit,
                        reference_c: None,
                        polynomials,
                        sigmas,
                        gains,
                        noise,
                        held_out: Some(held_out),
                        statistics: None,
                    },
                )
                .collect(),
            outliers: Some(findings.outliers),
            selection: findings.selection,
        };
        let channels = data.logs[0].channels.iter();
        let axes_of_unit = channels.map(|channel| channel.axes.len()).sum();
        build::channel(
            fitted,
            &self.segmentation,
            self.overlap,
            thermal,
            self.calibrated_c,
            axes_of_unit,
        )
    }
}
