//! The spline model: one least squares over the whole range, and the choice among models.

mod basis;
mod blocks;
mod covariance;
mod crossval;
mod earn;
mod earned;
mod fit;
mod folds;
mod gram;
mod lag;
mod layout;
#[cfg(test)]
mod reference;
mod select;
mod solve;
mod states;

pub(crate) use basis::{Basis, RateForm, SparseRow, dot};
pub(crate) use blocks::{Block, Blocks, SamplePoints};
pub(crate) use earned::LEAST_RATES;
pub(crate) use fit::fit;
pub(crate) use gram::Gram;
pub(crate) use lag::FixedLag;
pub(crate) use select::{Choice, Chosen, Question, Spline};
