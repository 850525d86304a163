//! What is fitted: the form of the model, with what each form leaves to choose.

use tempco_set::{Model, Overlap, Segmentation};

/// What is fitted. Every form has only the choices that it uses.
///
/// Without a segmentation the measured range is divided: in the paper's manner by `Segments`, by
/// cross-validation by the others.
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
    /// All segments together, without jump or kink.
    Spline {
        /// The segments; they meet in the middle of their overlaps.
        segmentation: Option<Segmentation>,
        /// What is searched.
        search: SplineSearch,
    },
    /// Whichever of the others does best on soaks and ramps it was not fitted to.
    Auto {
        /// What is applied where segments overlap that are fitted by themselves.
        overlap: SegmentOverlap,
        /// The segments of all candidates.
        segmentation: Option<Segmentation>,
        /// What is searched for splines.
        search: SplineSearch,
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

/// What is searched for a spline beside its coefficients. What is not searched stays as in the
/// settings of the thermal path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplineSearch {
    /// Time constant of the rate estimator.
    pub tau: bool,
    /// Shift of the lag-compensated temperature.
    pub kappa: bool,
    /// History terms: plays (backlash) and a second thermal lag, where they lower the error on
    /// soaks and ramps left out of the fit by more than one standard error.
    pub history: bool,
}

impl SplineSearch {
    /// All of it.
    pub const ALL: Self = Self {
        tau: true,
        kappa: true,
        history: true,
    };
}

/// A form with what it has by default: a linear blend, the measured range divided, everything
/// searched.
impl From<Model> for Method {
    fn from(model: Model) -> Self {
        let (overlap, segmentation, search) = (SegmentOverlap::Linear, None, SplineSearch::ALL);
        let segments = |model| Self::Segments {
            model,
            overlap,
            segmentation: None,
        };
        match model {
            Model::Static => segments(SegmentModel::Static),
            Model::Composite => segments(SegmentModel::Composite),
            Model::Spline => Self::Spline {
                segmentation,
                search,
            },
            Model::Auto => Self::Auto {
                overlap,
                segmentation,
                search,
            },
        }
    }
}

impl Method {
    /// The form, as the set says it.
    pub fn model(&self) -> Model {
        match self {
            Self::Segments { model, .. } => (*model).into(),
            Self::Spline { .. } => Model::Spline,
            Self::Auto { .. } => Model::Auto,
        }
    }

    /// The overlap, as the set says it.
    pub fn overlap(&self) -> Overlap {
        match self {
            Self::Segments { overlap, .. } | Self::Auto { overlap, .. } => (*overlap).into(),
            Self::Spline { .. } => Overlap::Spline,
        }
    }

    /// The segments that were given.
    pub(crate) fn segmentation(&self) -> Option<&Segmentation> {
        match self {
            Self::Segments { segmentation, .. }
            | Self::Spline { segmentation, .. }
            | Self::Auto { segmentation, .. } => segmentation.as_ref(),
        }
    }

    /// The overlap of the paper's models, to which every fit is compared.
    pub(crate) fn overlap_of_segments(&self) -> Overlap {
        match self {
            Self::Spline { .. } => Overlap::Linear,
            Self::Segments { .. } | Self::Auto { .. } => self.overlap(),
        }
    }

    /// What is searched; nothing for segments that are fitted by themselves.
    pub(crate) fn search(&self) -> SplineSearch {
        match self {
            Self::Segments { .. } => SplineSearch {
                tau: false,
                kappa: false,
                history: false,
            },
            Self::Spline { search, .. } | Self::Auto { search, .. } => *search,
        }
    }
}
