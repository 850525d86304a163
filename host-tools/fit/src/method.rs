//! What is fitted: the form of the model, with what each form leaves to choose.

use serde::{Deserialize, Serialize};
use tempco_set::{Model, Overlap, Segmentation};

/// What is fitted. Every form has only the choices that it uses.
///
/// Without a segmentation the measured range is divided in the paper's manner.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// The paper's: each segment by itself, at the lag of the settings.
    Segments {
        /// Terms of a segment.
        model: SegmentModel,
        /// What is applied where segments overlap.
        overlap: SegmentOverlap,
        /// The segments.
        segmentation: Option<Segmentation>,
    },
    /// All cells together, without jump or kink, with the lags, plays and smoothness that the logs
    /// make most likely.
    Auto {
        /// Overlap of the paper's models that it is compared with.
        overlap: SegmentOverlap,
        /// Segments of these.
        segmentation: Option<Segmentation>,
    },
}

/// The paper's models of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SegmentModel {
    /// [`Model::Static`]
    Static,
    /// [`Model::Composite`]
    Composite,
}

impl From<SegmentModel> for Model {
    fn from(model: SegmentModel) -> Self {
        match model {
            SegmentModel::Static => Self::Static,
            SegmentModel::Composite => Self::Composite,
        }
    }
}

/// What is applied where segments overlap that were fitted by themselves; see [`Overlap`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SegmentOverlap {
    /// [`Overlap::None`]
    None,
    /// [`Overlap::Hard`]
    Hard,
    /// [`Overlap::Mean`]
    Mean,
    /// [`Overlap::Linear`]
    Linear,
    /// [`Overlap::Smooth`]
    Smooth,
}

impl From<SegmentOverlap> for Overlap {
    fn from(overlap: SegmentOverlap) -> Self {
        match overlap {
            SegmentOverlap::None => Self::None,
            SegmentOverlap::Hard => Self::Hard,
            SegmentOverlap::Mean => Self::Mean,
            SegmentOverlap::Linear => Self::Linear,
            SegmentOverlap::Smooth => Self::Smooth,
        }
    }
}

/// What is searched of the first lag; what is not stays as in the settings of the thermal path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LagSearch {
    /// Time constant of the rate estimator.
    pub tau: bool,
    /// Shift of the lag-compensated temperature.
    pub kappa: bool,
}

impl LagSearch {
    /// Both.
    pub const ALL: Self = Self {
        tau: true,
        kappa: true,
    };
}

impl From<SegmentModel> for Method {
    /// With a linear blend, the measured range divided.
    fn from(model: SegmentModel) -> Self {
        Self::Segments {
            model,
            overlap: SegmentOverlap::Linear,
            segmentation: None,
        }
    }
}

/// A form with what it has by default; a spline is what the default fits.
impl From<Model> for Method {
    fn from(model: Model) -> Self {
        match model {
            Model::Static => SegmentModel::Static.into(),
            Model::Composite => SegmentModel::Composite.into(),
            Model::Spline | Model::Auto => Self::AUTO,
        }
    }
}

impl Method {
    /// The default.
    pub const AUTO: Self = Self::Auto {
        overlap: SegmentOverlap::Linear,
        segmentation: None,
    };

    /// The form, as the set says it.
    pub fn model(&self) -> Model {
        match self {
            Self::Segments { model, .. } => (*model).into(),
            Self::Auto { .. } => Model::Auto,
        }
    }

    /// The overlap, as the set says it.
    pub fn overlap(&self) -> Overlap {
        match self {
            Self::Segments { .. } => self.overlap_of_segments(),
            Self::Auto { .. } => Overlap::Spline,
        }
    }

    /// The segments that were given.
    pub(crate) fn segmentation(&self) -> Option<&Segmentation> {
        match self {
            Self::Segments { segmentation, .. } | Self::Auto { segmentation, .. } => {
                segmentation.as_ref()
            }
        }
    }

    /// The overlap of the paper's models, to which every fit is compared.
    pub(crate) fn overlap_of_segments(&self) -> Overlap {
        match self {
            Self::Segments { overlap, .. } | Self::Auto { overlap, .. } => (*overlap).into(),
        }
    }
}
