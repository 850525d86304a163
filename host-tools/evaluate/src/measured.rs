//! A figure, or why there is none.

use serde::Serialize;

/// A figure, or the reason why it was not measured. In JSON the latter is
/// `{"not_measured": "reason"}`.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Measured<T> {
    /// The figure.
    Figure(T),
    /// There is none.
    Not {
        /// Why.
        not_measured: String,
    },
}

impl<T> Measured<T> {
    /// The figure, or the reason.
    pub(super) fn or(figure: Option<T>, reason: impl FnOnce() -> String) -> Self {
        figure.map_or_else(
            || Self::Not {
                not_measured: reason(),
            },
            Self::Figure,
        )
    }

    /// The figure, if there is one.
    pub const fn figure(&self) -> Option<&T> {
        match self {
            Self::Figure(figure) => Some(figure),
            Self::Not { .. } => None,
        }
    }

    /// The reason, if there is no figure.
    pub fn reason(&self) -> Option<&str> {
        match self {
            Self::Figure(_) => None,
            Self::Not { not_measured } => Some(not_measured),
        }
    }
}
