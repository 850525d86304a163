//! The spline model: one least squares over the whole range, and the choice among models.

mod basis;
mod blocks;
mod covariance;
mod crossval;
mod fit;
mod folds;
mod gram;
mod lag;
mod layout;
#[cfg(test)]
mod reference;
mod select;
mod selection;
mod solve;

pub(crate) use basis::{Basis, RateForm, SparseRow, dot};
pub(crate) use blocks::{Block, Blocks, SamplePoints};
pub(crate) use fit::fit;
pub(crate) use gram::Gram;
pub(crate) use lag::FixedLag;
pub use layout::Place;
pub(crate) use select::{Choice, Chosen, Question};
pub use selection::{Candidate, HeldOutErrors, Selection};
