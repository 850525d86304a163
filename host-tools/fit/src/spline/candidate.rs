//! Models that stand to choice.

use tempco_set::{Candidate, Segmentation};

use crate::least_squares::{AxisTerms, RateForm};
use crate::method::SegmentModel;
use crate::spline::breakpoints::Layout;
use crate::spline::cross_validation::HeldOut;
use crate::spline::history_terms::Shape;
use crate::spline::regressors::Lag;

/// The model that was fitted.
pub(crate) enum Chosen {
    /// One of the paper's.
    Segments(SegmentModel),
    /// Another one, with its errors.
    HeldOut(HeldOut),
}

/// What is to be fitted in the end.
#[derive(Clone, Debug)]
pub(crate) enum Choice {
    Segments {
        model: SegmentModel,
        segmentation: Segmentation,
    },
    Spline(Spline),
}

/// A spline model, all but its coefficients.
#[derive(Clone, Debug)]
pub(crate) struct Spline {
    pub(crate) layout: Layout,
    pub(crate) rate: RateForm,
    pub(crate) lag: Lag,
    /// History terms.
    pub(crate) shape: Shape,
    /// For each axis, what helps it.
    pub(crate) axes: Vec<AxisTerms>,
}

/// A model with its errors where it was left out.
#[derive(Clone)]
pub(super) struct Tried {
    pub(super) candidate: Candidate,
    pub(super) held_out: HeldOut,
    pub(super) choice: Choice,
}
