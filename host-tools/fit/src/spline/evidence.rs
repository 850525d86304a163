//! How strongly to smooth: ridges by their marginal likelihood.
//!
//! Each group of coefficients is drawn, before anything is measured, from a normal distribution
//! with the precision `lambda P / sigma^2`, `P` fixed. With the coefficients integrated out, the
//! whitened rows have the likelihood
//!
//! ```text
//! -2 ln L = n ln S + ln |A| - sum over groups (rank ln lambda) + ln |V| + constant
//! A = X'X + sum lambda P,   S = y'y - y'X A^-1 X'y,   sigma^2 = S / n
//! ```
//!
//! (MacKay 1992; Wood, Generalized Additive Models, 2017, chapter 6). A group that explains nothing
//! ends with a precision without limit, and is left out.

use nalgebra::{DMatrix, DVector};

use crate::spline::whitening::WhiteProducts;

/// Precisions stay within these, times the one at which rows and ridge count alike. Beyond them a
/// group is free, or gone; further out, rounding would reach the groups that share its columns.
const PRECISIONS: (f64, f64) = (1e-8, 1e7);

/// A group with fewer effective coefficients than this is left out.
const LEAST_FREEDOM: f64 = 0.05;

/// A share by which precisions may still move when they are found.
const MOVES: f64 = 0.01;

/// What keeps directions that no row sees from being singular, as a share of the mean diagonal.
const UNSEEN: f64 = 1e-11;

/// A group of coefficients with its own ridge.
#[derive(Clone, Debug)]
pub(crate) struct Ridge {
    /// Its first column.
    pub(crate) first: usize,
    /// `P`.
    pub(crate) matrix: DMatrix<f64>,
    pub(crate) rank: usize,
}

/// What the rows say about the coefficients of an axis.
#[derive(Clone)]
pub(crate) struct Posterior {
    pub(crate) coefficients: DVector<f64>,
    /// `A^-1`.
    pub(crate) inverse: DMatrix<f64>,
    /// `sigma^2`: variance of a block of usual weight.
    pub(crate) variance: f64,
    /// -2 ln L.
    pub(crate) deviance: f64,
}

impl Ridge {
    /// `b' P b`.
    fn square(&self, coefficients: &DVector<f64>) -> f64 {
        let own = coefficients.rows(self.first, self.matrix.nrows());
        own.dot(&(&self.matrix * own))
    }

    /// The precision at which the rows and the ridge count alike.
    pub(crate) fn even(&self, products: &WhiteProducts) -> f64 {
        let n = self.matrix.nrows();
        let own = products.normal.view((self.first, self.first), (n, n));
        let even = own.trace() / self.matrix.trace();
        if even > 0.0 { even } else { 1.0 }
    }

    /// `trace(A^-1 P)`.
    fn trace(&self, inverse: &DMatrix<f64>) -> f64 {
        let n = self.matrix.nrows();
        let own = inverse.view((self.first, self.first), (n, n));
        own.iter().zip(&self.matrix).map(|(a, p)| a * p).sum()
    }
}

/// The posterior under given precisions; `None` where it cannot be computed. `free` coefficients
/// have no ridge.
pub(crate) fn posterior(
    products: &WhiteProducts,
    ridges: &[Ridge],
    precisions: &[f64],
    free: usize,
) -> Option<Posterior> {
    let n = products.target.len();
    let mut matrix = products.normal.clone();
    let unseen = UNSEEN * matrix.trace() / n as f64;
    for i in 0..n {
        matrix[(i, i)] += unseen;
    }
    let mut deviance = products.log_determinant;
    for (ridge, &precision) in ridges.iter().zip(precisions) {
        let size = ridge.matrix.nrows();
        let mut own = matrix.view_mut((ridge.first, ridge.first), (size, size));
        own.zip_apply(&ridge.matrix, |a, p| *a += precision * p);
        deviance -= ridge.rank as f64 * libm::log(precision);
    }
    let factor = matrix.cholesky()?;
    for i in 0..n {
        deviance += 2.0 * libm::log(factor.l_dirty()[(i, i)]);
    }
    let coefficients = factor.solve(&products.target);
    // An axis without noise leaves nothing but rounding.
    let left = products.square - coefficients.dot(&products.target);
    let penalised = left.max(1e-24 * products.square).max(f64::MIN_POSITIVE);
    let freedom = products.rows as f64 - free as f64;
    if freedom <= 0.0 {
        return None;
    }
    deviance += freedom * libm::log(penalised);
    Some(Posterior {
        coefficients,
        inverse: factor.inverse(),
        variance: penalised / freedom,
        deviance,
    })
}

/// Moves precisions to where the likelihood is highest: the share of a group's coefficients that
/// the rows determine over the square of what they find (MacKay's fixed point).
pub(crate) fn tune(
    products: &WhiteProducts,
    ridges: &[Ridge],
    precisions: &mut [f64],
    free: usize,
    rounds: usize,
) -> Option<Posterior> {
    let mut now = posterior(products, ridges, precisions, free)?;
    let even: Vec<f64> = ridges.iter().map(|ridge| ridge.even(products)).collect();
    for _ in 0..rounds {
        let mut moved = 0.0_f64;
        let of_group = ridges.iter().zip(&even).zip(precisions.iter_mut());
        for ((ridge, even), precision) in of_group {
            let (least, most) = (PRECISIONS.0 * even, PRECISIONS.1 * even);
            let known = effective(ridge, *precision, &now);
            let square = ridge.square(&now.coefficients);
            let found = (now.variance * known / square).clamp(least, most);
            if found.is_finite() {
                // A group that is on its way out takes long steps.
                let step = found / *precision;
                let step = if known < 0.5 { step * step } else { step };
                let next = (*precision * step).clamp(least, most);
                if known > LEAST_FREEDOM {
                    moved = moved.max((next / *precision - 1.0).abs());
                }
                *precision = next;
            }
        }
        now = posterior(products, ridges, precisions, free)?;
        if moved < MOVES {
            break;
        }
    }
    Some(now)
}

/// How many of a group's coefficients the rows determine.
fn effective(ridge: &Ridge, precision: f64, posterior: &Posterior) -> f64 {
    let held = precision * ridge.trace(&posterior.inverse);
    (ridge.rank as f64 - held).max(1e-6)
}

/// The groups that explain something.
pub(crate) fn in_use(ridges: &[Ridge], precisions: &[f64], posterior: &Posterior) -> Vec<bool> {
    let pairs = ridges.iter().zip(precisions);
    pairs
        .map(|(ridge, &precision)| effective(ridge, precision, posterior) > LEAST_FREEDOM)
        .collect()
}
