//! Least squares: blocks of rows and the basis of a spline, normal equations of parts, a QR factor
//! for the paper's segments.

mod blocks;
mod normal_equations;
mod qr;
#[cfg(test)]
mod reference;
mod spline_basis;

pub(crate) use blocks::{Block, Blocks, SamplePoints};
pub(crate) use normal_equations::Gram;
pub use qr::{Independence, RFactor, Solution};
pub(crate) use spline_basis::{Basis, RateForm, SparseRow, dot};
