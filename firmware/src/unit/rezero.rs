//! Re-zero: the constant bias at rest, found without a chamber.
//!
//! Only at rest: an averaging is given up as soon as a status is not valid or short means scatter
//! far beyond the gyro's noise, and what it finds is not kept beyond a limit.

use tempco::{Status, Validity};
use tempco_image::Unit as AxisUnit;

use super::devices::Gyro;
use super::fit::per_count;
use super::mean::Mean;

/// What a gyro at rest stays within.
#[derive(Clone, Copy, Debug)]
pub struct Limits<const C: usize, const A: usize> {
    /// Standard deviation of means over the time between two temperatures \[unit of the axis\].
    sigma: [[f32; A]; C],
    /// The largest constant bias \[unit of the axis\].
    max_bias: [[f32; A]; C],
}

impl<const C: usize, const A: usize> Limits<C, A> {
    /// Those of a gyro whose axes have these units.
    pub fn of<G: Gyro<C, A>>(units: &[[AxisUnit; A]; C]) -> Self {
        let per_count = per_count::<G, C, A>(units);
        let in_unit = |counts: f32| per_count.map(|axes| axes.map(|unit| counts * unit));
        Self {
            sigma: in_unit(G::AT_REST.sigma),
            max_bias: in_unit(G::AT_REST.max_bias),
        }
    }

    /// The first axis whose constant bias would be beyond its limit, or not a number.
    pub fn beyond(&self, offsets: &[[f32; A]; C]) -> Option<usize> {
        let limits = self.max_bias.as_flattened();
        let mut all = offsets.as_flattened().iter().zip(limits);
        all.position(|(offset, limit)| !(-limit..=*limit).contains(offset))
    }
}

/// Why an averaging was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GivenUp {
    /// The status was not valid; its bits.
    Status(u16),
    /// The samples of an axis scattered as they do not at rest.
    Scatter(usize),
    /// The constant bias of an axis would have been beyond its limit.
    Bias(usize),
}

impl GivenUp {
    /// As in the fault log: the reason in the upper half, bits of the status or an axis below.
    pub const fn detail(self) -> u32 {
        let (reason, what) = match self {
            Self::Status(bits) => (1, bits as u32),
            Self::Scatter(axis) => (2, axis as u32),
            Self::Bias(axis) => (3, axis as u32),
        };
        reason << 16 | what
    }
}

/// Short means scatter beyond the gyro's noise where their standard deviation is so many times it.
const SIGMAS: f32 = 4.0;

/// Short means from which on their scatter is judged.
const FEWEST: u32 = 8;

/// How short means of one thing per axis scatter, by sums of their differences from the first one.
#[derive(Clone, Copy, Debug)]
struct Scatter<const C: usize, const A: usize> {
    mean: Mean<C, A>,
    first: Option<[[f32; A]; C]>,
    sum: [[f32; A]; C],
    squares: [[f32; A]; C],
    count: u32,
}

impl<const C: usize, const A: usize> Default for Scatter<C, A> {
    fn default() -> Self {
        Self {
            mean: Mean::default(),
            first: None,
            sum: [[0.0; A]; C],
            squares: [[0.0; A]; C],
            count: 0,
        }
    }
}

impl<const C: usize, const A: usize> Scatter<C, A> {
    /// Takes a sample; the first axis that scatters beyond its limit, once `samples` were the last
    /// of a short mean.
    fn add(
        &mut self,
        values: &[[f32; A]; C],
        samples: u32,
        sigma: &[[f32; A]; C],
    ) -> Option<usize> {
        self.mean.add(values);
        if self.mean.count() < samples {
            return None;
        }
        let means = core::mem::take(&mut self.mean).means();
        let first = *self.first.get_or_insert(means);
        self.count += 1;
        let sums = self.sum.as_flattened_mut().iter_mut();
        let squares = self.squares.as_flattened_mut().iter_mut();
        let differences = means.as_flattened().iter().zip(first.as_flattened());
        for ((mean, first), (sum, square)) in differences.zip(sums.zip(squares)) {
            *sum += mean - first;
            *square += (mean - first) * (mean - first);
        }
        if self.count < FEWEST {
            return None;
        }
        let count = self.count as f32;
        let sums = self
            .sum
            .as_flattened()
            .iter()
            .zip(self.squares.as_flattened());
        let mut all = sums.zip(sigma.as_flattened());
        all.position(|((sum, squares), sigma)| {
            let variance = (squares - sum * sum / count) / (count - 1.0);
            let limit = SIGMAS * sigma;
            // What is not a number is beyond any limit.
            variance.is_nan() || variance > limit * limit
        })
    }
}

/// An averaging under way.
#[derive(Clone, Copy, Debug)]
pub struct ReZero<const C: usize, const A: usize> {
    /// What the gyro should show meanwhile, such as the Earth's rate.
    expected: [[f32; A]; C],
    remaining: u32,
    mean: Mean<C, A>,
    scatter: Scatter<C, A>,
    /// Samples of a short mean.
    short: u32,
    limits: Limits<C, A>,
}

impl<const C: usize, const A: usize> ReZero<C, A> {
    /// An averaging over `samples`, during which the gyro should show what is `expected`, and means
    /// over `short` samples scatter within the limits.
    pub fn new(samples: u32, expected: [[f32; A]; C], short: u32, limits: Limits<C, A>) -> Self {
        Self {
            expected,
            remaining: samples,
            mean: Mean::default(),
            scatter: Scatter::default(),
            short,
            limits,
        }
    }

    /// Takes a sample without its thermal bias, and its status; the constant biases once it was the
    /// last.
    ///
    /// # Errors
    /// The unit is not valid, or not at rest; the averaging has ended.
    pub fn add(
        &mut self,
        values: &[[f32; A]; C],
        status: Status,
    ) -> Result<Option<[[f32; A]; C]>, GivenUp> {
        if status.validity() != Validity::Valid {
            return Err(GivenUp::Status(status.bits()));
        }
        let Self {
            scatter, limits, ..
        } = self;
        if let Some(axis) = scatter.add(values, self.short, &limits.sigma) {
            return Err(GivenUp::Scatter(axis));
        }
        self.mean.add(values);
        self.remaining = self.remaining.saturating_sub(1);
        if self.remaining > 0 {
            return Ok(None);
        }
        let mut offsets = self.mean.means();
        for (offsets, expected) in offsets.iter_mut().zip(&self.expected) {
            for (offset, expected) in offsets.iter_mut().zip(expected) {
                *offset -= expected;
            }
        }
        Ok(Some(offsets))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits<1, 1> = Limits {
        sigma: [[1.0]],
        max_bias: [[2.0]],
    };

    #[test]
    fn what_the_gyro_should_show_is_no_bias() {
        let mut rezero = ReZero::new(3, [[15.0]], 1, LIMITS);
        assert_eq!(rezero.add(&[[15.5]], Status::OK), Ok(None));
        assert_eq!(rezero.add(&[[16.0]], Status::OK), Ok(None));
        assert_eq!(rezero.add(&[[16.5]], Status::OK), Ok(Some([[1.0]])));
    }

    /// Any flag that is not valid, at any sample, ends it.
    #[test]
    fn a_status_that_is_not_valid_ends_it() {
        let flags = (0..16).map(|bit| Status::from_bits(1 << bit));
        for status in flags.filter(|status| status.validity() != Validity::Valid) {
            for place in 0..10 {
                let mut rezero = ReZero::new(10, [[0.0]], 2, LIMITS);
                for _ in 0..place {
                    assert_eq!(rezero.add(&[[0.5]], Status::OK), Ok(None));
                }
                let given_up = GivenUp::Status(status.bits());
                assert_eq!(rezero.add(&[[0.5]], status), Err(given_up));
            }
        }
    }

    /// Means of ten samples with a standard deviation that is a multiple of the gyro's, and noise
    /// of single samples that is far larger but averages out.
    #[test]
    fn scatter_far_above_the_noise_ends_it() {
        for (sigmas, ends) in [
            (0.0, false),
            (1.0, false),
            (3.5, false),
            (4.5, true),
            (50.0, true),
        ] {
            let mut rezero = ReZero::new(1000, [[0.0]], 10, LIMITS);
            let ended = (0..1000_u16).any(|number| {
                let mean = if number / 10 % 2 == 0 {
                    sigmas
                } else {
                    -sigmas
                };
                let sample = if number % 2 == 0 { 100.0 } else { -100.0 };
                let added = rezero.add(&[[1000.0 + mean + sample]], Status::OK);
                assert!(matches!(added, Ok(_) | Err(GivenUp::Scatter(0))));
                added.is_err()
            });
            assert_eq!(ended, ends, "{sigmas}");
        }
        let mut rezero = ReZero::new(1000, [[0.0]], 1, LIMITS);
        let ended = (0..8).any(|_| rezero.add(&[[f32::NAN]], Status::OK).is_err());
        assert!(ended, "a NaN scatters");
    }

    #[test]
    fn a_bias_is_within_its_limits_or_named() {
        for (bias, beyond) in [
            (2.0, None),
            (-2.0, None),
            (2.1, Some(0)),
            (-1e30, Some(0)),
            (f32::NAN, Some(0)),
        ] {
            assert_eq!(LIMITS.beyond(&[[bias]]), beyond, "{bias}");
        }
    }
}
