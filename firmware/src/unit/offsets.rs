//! The constant biases that are taken out, and the re-zero that finds new ones.

use tempco::Status;

use super::rezero::{GivenUp, Limits, ReZero};

/// Constant biases of all axes \[unit of the axis\].
pub struct Offsets<const C: usize, const A: usize> {
    in_use: [[f32; A]; C],
    limits: Limits<C, A>,
    refused: Option<usize>,
    rezero: Option<ReZero<C, A>>,
}

impl<const C: usize, const A: usize> Offsets<C, A> {
    /// Those that were kept over the reset; none at all where one is beyond its limit.
    pub fn new(kept: [[f32; A]; C], limits: Limits<C, A>) -> Self {
        let refused = limits.beyond(&kept);
        Self {
            in_use: match refused {
                None => kept,
                Some(_) => [[0.0; A]; C],
            },
            limits,
            refused,
            rezero: None,
        }
    }

    /// Those that are taken out.
    pub const fn in_use(&self) -> &[[f32; A]; C] {
        &self.in_use
    }

    /// Why those that were kept are not in use.
    pub fn refused(&self) -> Option<GivenUp> {
        self.refused.map(GivenUp::Bias)
    }

    /// Takes out others from now on.
    pub fn set(&mut self, offsets: [[f32; A]; C]) {
        self.in_use = offsets;
    }

    /// Whether a re-zero is under way.
    pub const fn is_averaging(&self) -> bool {
        self.rezero.is_some()
    }

    /// Begins a re-zero over `samples`; see [`ReZero::new`].
    pub fn begin(&mut self, samples: u32, expected: [[f32; A]; C], short: u32) {
        self.rezero = Some(ReZero::new(samples, expected, short, self.limits));
    }

    /// Gives a sample to the re-zero that is under way. Once it has ended: the offsets to take out
    /// from now on, which are what it found and those in use, or why it was given up.
    pub fn add(
        &mut self,
        compensated: &[[f32; A]; C],
        status: Status,
    ) -> Option<Result<[[f32; A]; C], GivenUp>> {
        let ended = self.rezero.as_mut()?.add(compensated, status).transpose()?;
        self.rezero = None;
        Some(ended.and_then(|found| {
            let mut offsets = self.in_use;
            for (offsets, found) in offsets.iter_mut().zip(&found) {
                for (offset, found) in offsets.iter_mut().zip(found) {
                    *offset += found;
                }
            }
            match self.limits.beyond(&offsets) {
                Some(axis) => Err(GivenUp::Bias(axis)),
                None => Ok(offsets),
            }
        }))
    }
}
