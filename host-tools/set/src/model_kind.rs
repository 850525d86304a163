//! Form of a model.

use serde::{Deserialize, Serialize};
use tempco::Terms;

use crate::model::COMPOSITE;

/// Form of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// `a0 + a1 T + a2 T^2`
    Static,
    /// `a0 + a1 T + a2 T^2 + a3 T' + a4 T T'`
    Composite,
    /// The same terms in every segment, the static part continuous in value and slope, the rate
    /// part in value; fitted together with the lag shift.
    Spline,
    /// Whichever of the others does best on soaks and ramps it was not fitted to.
    Auto,
}

impl Model {
    /// The form as it is written in settings.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Static => "static",
            Self::Composite => "composite",
            Self::Spline => "spline",
            Self::Auto => "auto",
        }
    }

    /// Number of leading [`TERMS`](crate::TERMS) that it has.
    pub const fn terms(self) -> usize {
        match self {
            Self::Static => Terms::STATIC,
            Self::Composite | Self::Spline | Self::Auto => COMPOSITE,
        }
    }
}
