//! The fit of one segment: which terms the data can tell apart, and their coefficients.

use tempco::Terms;
use tempco_set::{COMPOSITE, Coverage};
use thiserror::Error;

use crate::least_squares::{RFactor, Solution};

/// A term is dropped where the part of it that the terms before it cannot represent is less than
/// this share of what it would be with `z` all over the segment: the error of its coefficient
/// would be 20 times larger.
pub(crate) const LEAST_SHARE: f64 = 0.05;

/// Noise a temperature sensor may have \[degC\]. Divided by the time constant of the estimator it
/// is the spread of rates that says nothing.
pub(crate) const SENSOR_NOISE_C: f64 = 0.05;

/// The share of a segment that the data must span, so that the curve is not extrapolated.
pub(crate) const LEAST_SPAN: f64 = 0.2;

/// What a segment's rows gave.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SegmentFit {
    /// Number of leading [`TERMS`](tempco_set::TERMS) that were fitted.
    pub(crate) terms: usize,
    pub(crate) rows: u64,
    pub(crate) coverage: Coverage,
    pub(crate) solution: Solution,
}

/// Where some rows lie: means of the regressors `1, z, z^2, T', z T'`, and extremes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) regressors: [f64; COMPOSITE],
    pub(crate) z_range: (f64, f64),
    pub(crate) rate_range: (f64, f64),
}

impl Place {
    /// Of one row.
    pub(crate) fn at(z: f64, rate: f64) -> Self {
        Self {
            regressors: [1.0, z, z * z, rate, z * rate],
            z_range: (z, z),
            rate_range: (rate, rate),
        }
    }
}

/// Rows of one segment, with what is needed to judge them.
#[derive(Clone, Debug)]
pub(crate) struct SegmentRows {
    factor: RFactor,
    z_range: (f64, f64),
    rate_range: (f64, f64),
    time_s: f64,
}

impl SegmentRows {
    pub(crate) fn new(axes: usize) -> Self {
        Self {
            factor: RFactor::new(COMPOSITE, axes),
            z_range: (f64::INFINITY, f64::NEG_INFINITY),
            rate_range: (f64::INFINITY, f64::NEG_INFINITY),
            time_s: 0.0,
        }
    }

    /// Takes in a row at local coordinate `z` that stands for `interval_s`.
    pub(crate) fn push(
        &mut self,
        interval_s: f64,
        z: f64,
        rate_c_per_min: f64,
        raw: impl Iterator<Item = f64>,
    ) {
        let place = Place::at(z, rate_c_per_min);
        self.push_mean(&place, (1, interval_s), raw.map(|mean| (mean, 0.0)));
    }

    /// Takes in some rows that stand for `time_s`; of each observation the mean and the sum of
    /// squares about it.
    pub(crate) fn push_mean(
        &mut self,
        place: &Place,
        (rows, time_s): (u64, f64),
        raw: impl Iterator<Item = (f64, f64)>,
    ) {
        let wider = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
        self.z_range = wider(self.z_range, place.z_range);
        self.rate_range = wider(self.rate_range, place.rate_range);
        self.time_s += time_s;
        let (means, within): (Vec<f64>, Vec<f64>) = raw.unzip();
        let row = place.regressors.into_iter().chain(means);
        self.factor.push_mean(rows, row, within);
    }

    /// Takes in all rows of `other`.
    pub(crate) fn merge(&mut self, other: Self) {
        let wider = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
        self.z_range = wider(self.z_range, other.z_range);
        self.rate_range = wider(self.rate_range, other.rate_range);
        self.time_s += other.time_s;
        self.factor.merge(other.factor);
    }

    pub(crate) fn rows(&self) -> u64 {
        self.factor.rows()
    }

    /// What the rows cover.
    pub(crate) fn coverage(&mut self) -> Coverage {
        Coverage {
            time_s: self.time_s,
            width: ((self.z_range.1 - self.z_range.0) / 2.0).max(0.0),
            rate_min_c_per_min: self.rate_range.0,
            rate_max_c_per_min: self.rate_range.1,
            rate_independent_c_per_min: self.factor.independence()[Terms::STATIC].independent,
        }
    }

    /// Fits up to `most_terms` terms, fewer where the rows cannot separate them.
    pub(crate) fn fit(mut self, most_terms: usize, tau_s: f64) -> Result<SegmentFit, Unfit> {
        let rows = self.factor.rows();
        let coverage = self.coverage();
        let span = coverage.width;
        if rows < 10 * most_terms as u64 {
            return Err(Unfit::Rows(rows));
        }
        if span < LEAST_SPAN {
            return Err(Unfit::Span(100.0 * span));
        }
        let least_rate = SENSOR_NOISE_C / (tau_s / 60.0);
        let independence = self.factor.independence();
        let rate = independence[Terms::STATIC].whole;
        let dependent = (0..most_terms).find(|&term| {
            let independent = independence[term].independent;
            let scale = if term < Terms::STATIC { 1.0 } else { rate };
            independent < LEAST_SHARE * scale || (term == Terms::STATIC && independent < least_rate)
        });
        let terms = dependent.unwrap_or(most_terms);
        if terms < 2 {
            return Err(Unfit::Span(100.0 * span));
        }
        let solution = self.factor.solve(terms).ok_or(Unfit::Span(100.0 * span))?;
        Ok(SegmentFit {
            terms,
            rows,
            coverage,
            solution,
        })
    }
}

/// Why a segment cannot be fitted at all.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub(crate) enum Unfit {
    #[error("holds {0} usable rows, too few to fit")]
    Rows(u64),
    #[error("is covered by data over {0:.0} % of its width only, expected 20 % or more")]
    Span(f64),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit(rows: impl Iterator<Item = (f64, f64)>) -> Result<SegmentFit, Unfit> {
        let mut segment = SegmentRows::new(1);
        for (z, rate) in rows {
            let bias = 1.0 + 2.0 * z - 0.5 * z * z + rate * (0.3 + 0.1 * z);
            segment.push(0.5, z, rate, std::iter::once(bias));
        }
        segment.fit(COMPOSITE, 60.0)
    }

    fn up_and_down(up: f64, down: f64) -> impl Iterator<Item = (f64, f64)> {
        let z = |i: i32| f64::from(i) / 250.0 - 1.0;
        (0..=500)
            .map(move |i| (z(i), up))
            .chain((0..=500).map(move |i| (-z(i), down)))
    }

    #[test]
    fn two_rates_give_all_five_terms() {
        let fit = fit(up_and_down(1.0, -0.5)).unwrap();
        assert_eq!((fit.terms, fit.rows), (5, 1002));
        let coverage = fit.coverage;
        assert_eq!((coverage.time_s, coverage.width), (501.0, 1.0));
        assert_eq!(
            (coverage.rate_min_c_per_min, coverage.rate_max_c_per_min),
            (-0.5, 1.0)
        );
        // Two rates 1.5 apart, each half of the time and all over the segment.
        assert!((coverage.rate_independent_c_per_min - 0.75).abs() < 0.01);
        let expected = [1.0, 2.0, -0.5, 0.3, 0.1];
        for (found, expected) in fit.solution.coefficients[0].iter().zip(expected) {
            assert!((found - expected).abs() < 1e-10);
        }
    }

    #[test]
    fn one_rate_drops_both_rate_terms() {
        // Exactly constant, and constant but for the estimator's noise.
        assert_eq!(fit(up_and_down(1.0, 1.0)).unwrap().terms, 3);
        let noisy = up_and_down(0.25, 0.25)
            .enumerate()
            .map(|(i, (z, rate))| (z, rate + 0.02 * (i as f64 * 12.9898).sin()));
        assert_eq!(fit(noisy).unwrap().terms, 3);
    }

    #[test]
    fn two_rates_at_one_temperature_each_drop_the_cross_term_alone() {
        let rows = (0..=500).map(|i| {
            let z = f64::from(i) / 250.0 - 1.0;
            (z, if (-0.05..0.05).contains(&z) { 1.0 } else { 0.0 })
        });
        assert_eq!(fit(rows).unwrap().terms, 4);
    }

    #[test]
    fn two_soaks_drop_the_curvature() {
        let rows = (0..500).map(|i| (if i < 250 { -0.5 } else { 0.5 }, 0.0));
        assert_eq!(fit(rows).unwrap().terms, 2);
    }

    #[test]
    fn one_soak_or_too_few_rows_are_refused() {
        let soak = (0..500).map(|i| (0.3 + 1e-3 * f64::from(i % 3), 0.0));
        assert!(matches!(fit(soak), Err(Unfit::Span(_))));
        // A tenth of the segment, though passed at two rates.
        let narrow = up_and_down(1.0, -1.0).map(|(z, rate)| (0.1 * z, rate));
        assert_eq!(fit(narrow), Err(Unfit::Span(10.0)));
        let few = up_and_down(1.0, -1.0).step_by(40);
        assert!(matches!(fit(few), Err(Unfit::Rows(26))));
    }
}
