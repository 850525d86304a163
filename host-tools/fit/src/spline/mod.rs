//! The spline model: one least squares over the whole range, and the choice among models.

mod breakpoints;
mod candidate;
mod covariance;
mod cross_validation;
mod fit;
mod folds;
mod history_search;
mod history_selection;
mod history_terms;
mod lag_search;
mod model_selection;
mod regressors;
mod rows;
mod solve;

pub(crate) use candidate::{Choice, Chosen};
pub(crate) use fit::fit;
pub(crate) use model_selection::Question;
pub(crate) use regressors::FixedLag;
