//! Number and place of breakpoints.

use tempco_set::{Place, Segmentation};

use crate::least_squares::{Basis, RateForm};

/// The most segments that are tried.
pub(crate) const MOST_SEGMENTS: usize = 12;

/// Breakpoints at quantiles go to the nearest of this many edges, so that the table needs no more
/// cells.
const EDGES: f64 = 64.0;

/// A division of the range that does not depend on where the range ends.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Layout {
    /// A number of segments, placed by a rule.
    Rule { place: Place, segments: usize },
    /// The ends and switching points of given segments \[degC\].
    Given(Vec<f64>),
}

impl Layout {
    pub(crate) fn uniform(segments: usize) -> Self {
        Self::Rule {
            place: Place::Uniform,
            segments,
        }
    }

    /// Given segments, cut at the middle of their overlaps.
    pub(crate) fn given(segmentation: &Segmentation) -> Self {
        let (low, high) = segmentation.range_c();
        let inner = segmentation.switch_points_c().into_iter();
        Self::Given([low].into_iter().chain(inner).chain([high]).collect())
    }

    pub(crate) fn place(&self) -> Place {
        match self {
            Self::Rule { place, .. } => *place,
            Self::Given(_) => Place::Given,
        }
    }

    pub(crate) fn segments(&self) -> usize {
        match self {
            Self::Rule { segments, .. } => *segments,
            Self::Given(breakpoints) => breakpoints.len() - 1,
        }
    }

    /// Breakpoints over a range, for temperatures `sorted_c` of equal weight; `None` where two
    /// would coincide.
    pub(crate) fn breakpoints_c(
        &self,
        (low, high): (f64, f64),
        sorted_c: &[f64],
    ) -> Option<Vec<f64>> {
        let found: Vec<f64> = match self {
            Self::Given(breakpoints) => breakpoints.clone(),
            Self::Rule { place, segments } => {
                let at = |k: usize| {
                    let share = k as f64 / *segments as f64;
                    if *place == Place::Quantile && k > 0 && k < *segments {
                        let quantile = sorted_c[(share * (sorted_c.len() - 1) as f64) as usize];
                        let edge = (EDGES * (quantile - low) / (high - low)).round();
                        low + (high - low) * edge / EDGES
                    } else {
                        low + (high - low) * share
                    }
                };
                (0..=*segments).map(at).collect()
            }
        };
        found.is_sorted_by(|a, b| a < b).then_some(found)
    }

    pub(crate) fn basis(
        &self,
        range_c: (f64, f64),
        sorted_c: &[f64],
        rate: RateForm,
        logs: usize,
    ) -> Option<Basis> {
        let breakpoints = self.breakpoints_c(range_c, sorted_c)?;
        Some(Basis::new(breakpoints, rate, logs))
    }
}
