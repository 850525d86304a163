//! Means and second moments of some rows, which merge.

use serde::{Deserialize, Serialize};

/// Mean of a column over some rows, and its sum of squares about that mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spread {
    pub(crate) mean: f64,
    pub(crate) squares: f64,
}

/// Lowest and highest value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Extremes {
    pub(crate) low: f32,
    pub(crate) high: f32,
}

impl Extremes {
    /// Of nothing.
    pub(crate) const NONE: Self = Self {
        low: f32::INFINITY,
        high: f32::NEG_INFINITY,
    };

    /// Of both.
    pub(crate) fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
}

/// Some rows of a channel: all that least squares in `1, u, u^2, T', u T'` needs of them as long as
/// they count as one, and what is left of the axes beside their means.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Moments {
    /// Number of rows.
    pub(crate) rows: u64,
    /// Mean temperature \[degC\].
    pub(crate) temp_c: f64,
    /// Lag-compensated temperature u \[degC\].
    pub(crate) effective_c: Spread,
    /// Mean rate of temperature T' \[degC/min\].
    pub(crate) rate: f64,
    /// Sum of the products of u and T', each less its mean.
    pub(crate) products: f64,
    pub(crate) effective_range_c: Extremes,
    pub(crate) rate_range: Extremes,
    /// The value of each axis.
    pub(crate) axes: Box<[Spread]>,
}

impl Moments {
    /// Of no rows.
    pub(crate) fn none(axes: usize) -> Self {
        Self {
            rows: 0,
            temp_c: 0.0,
            effective_c: Spread::default(),
            rate: 0.0,
            products: 0.0,
            effective_range_c: Extremes::NONE,
            rate_range: Extremes::NONE,
            axes: vec![Spread::default(); axes].into(),
        }
    }

    /// Takes in the rows of `other` (the update of Chan, Golub and LeVeque, which loses no digits
    /// to the size of the means).
    pub(crate) fn merge(&mut self, other: &Self) {
        let rows = self.rows + other.rows;
        if other.rows == 0 {
            return;
        }
        let share = other.rows as f64 / rows as f64;
        let weight = self.rows as f64 * share;
        let apart_c = other.effective_c.mean - self.effective_c.mean;
        let apart_rate = other.rate - self.rate;
        self.products += other.products + apart_c * apart_rate * weight;
        self.rate += apart_rate * share;
        self.temp_c += (other.temp_c - self.temp_c) * share;
        let join = |to: &mut Spread, from: &Spread| {
            let apart = from.mean - to.mean;
            to.mean += apart * share;
            to.squares += from.squares + apart * apart * weight;
        };
        join(&mut self.effective_c, &other.effective_c);
        for (to, from) in self.axes.iter_mut().zip(&other.axes) {
            join(to, from);
        }
        self.effective_range_c = self.effective_range_c.with(other.effective_range_c);
        self.rate_range = self.rate_range.with(other.rate_range);
        self.rows = rows;
    }
}

/// Rows of a channel, column by column, with the core's regressors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    pub(crate) time_s: Vec<f64>,
    pub(crate) temp_c: Vec<f32>,
    pub(crate) effective_c: Vec<f32>,
    pub(crate) rate: Vec<f32>,
    /// Whether the core accepted the temperature.
    pub(crate) accepted: Vec<bool>,
    /// Whether the row may enter a fit.
    pub(crate) keep: Vec<bool>,
    pub(crate) axes: Vec<Vec<f64>>,
}

impl Rows {
    /// No rows yet, with room for some.
    pub(crate) fn with_capacity(axes: usize, rows: usize) -> Self {
        Self {
            time_s: Vec::with_capacity(rows),
            temp_c: Vec::with_capacity(rows),
            effective_c: Vec::with_capacity(rows),
            rate: Vec::with_capacity(rows),
            accepted: Vec::with_capacity(rows),
            keep: Vec::with_capacity(rows),
            axes: (0..axes).map(|_| Vec::with_capacity(rows)).collect(),
        }
    }

    pub(crate) fn clear(&mut self) {
        self.time_s.clear();
        self.temp_c.clear();
        self.effective_c.clear();
        self.rate.clear();
        self.accepted.clear();
        self.keep.clear();
        self.axes.iter_mut().for_each(Vec::clear);
    }

    pub(crate) fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Moments of the kept rows of a range that is not empty.
    pub(crate) fn moments(&self, range: std::ops::Range<usize>) -> Moments {
        let keep = &self.keep[range.clone()];
        if keep.iter().all(|&keep| keep) {
            return self.moments_of_all(range);
        }
        let mut kept = Self::with_capacity(self.axes.len(), range.len());
        for row in range.filter(|&row| self.keep[row]) {
            kept.temp_c.push(self.temp_c[row]);
            kept.effective_c.push(self.effective_c[row]);
            kept.rate.push(self.rate[row]);
            for (to, from) in kept.axes.iter_mut().zip(&self.axes) {
                to.push(from[row]);
            }
        }
        match kept.temp_c.len() {
            0 => Moments::none(self.axes.len()),
            count => kept.moments_of_all(0..count),
        }
    }

    fn moments_of_all(&self, range: std::ops::Range<usize>) -> Moments {
        let count = range.len() as f64;
        let effective_c = &self.effective_c[range.clone()];
        let rate = &self.rate[range.clone()];
        // About the first row, so that digits are kept.
        let (first_c, first_rate) = (f64::from(effective_c[0]), f64::from(rate[0]));
        let mut pairs = Lanes::<3>::default();
        pairs.add(effective_c.len(), |i| {
            let u = f64::from(effective_c[i]) - first_c;
            let r = f64::from(rate[i]) - first_rate;
            [u, r, u * u]
        });
        let mut products = Lanes::<2>::default();
        let temp_c = &self.temp_c[range.clone()];
        products.add(effective_c.len(), |i| {
            let u = f64::from(effective_c[i]) - first_c;
            let r = f64::from(rate[i]) - first_rate;
            [u * r, f64::from(temp_c[i])]
        });
        let [u, r, uu] = pairs.sums();
        let [ur, temp] = products.sums();
        let axes = self.axes.iter().map(|axis| {
            let axis = &axis[range.clone()];
            let first = axis[0];
            let mut sums = Lanes::<2>::default();
            sums.add(axis.len(), |i| {
                let v = axis[i] - first;
                [v, v * v]
            });
            let [v, vv] = sums.sums();
            Spread {
                mean: first + v / count,
                squares: (vv - v * v / count).max(0.0),
            }
        });
        Moments {
            rows: range.len() as u64,
            temp_c: temp / count,
            effective_c: Spread {
                mean: first_c + u / count,
                squares: (uu - u * u / count).max(0.0),
            },
            rate: first_rate + r / count,
            products: ur - u * r / count,
            effective_range_c: extremes(effective_c),
            rate_range: extremes(rate),
            axes: axes.collect(),
        }
    }
}

fn extremes(values: &[f32]) -> Extremes {
    values.iter().fold(Extremes::NONE, |extremes, &value| {
        extremes.with(Extremes {
            low: value,
            high: value,
        })
    })
}

/// Sums in four lanes each, so that one addition need not wait for the one before.
struct Lanes<const N: usize>([[f64; 4]; N]);

impl<const N: usize> Default for Lanes<N> {
    fn default() -> Self {
        Self([[0.0; 4]; N])
    }
}

impl<const N: usize> Lanes<N> {
    #[inline(always)]
    fn add(&mut self, count: usize, terms: impl Fn(usize) -> [f64; N]) {
        let whole = count - count % 4;
        for start in (0..whole).step_by(4) {
            for lane in 0..4 {
                for (sums, term) in self.0.iter_mut().zip(terms(start + lane)) {
                    sums[lane] += term;
                }
            }
        }
        for i in whole..count {
            for (sums, term) in self.0.iter_mut().zip(terms(i)) {
                sums[0] += term;
            }
        }
    }

    fn sums(&self) -> [f64; N] {
        self.0.map(|[a, b, c, d]| (a + b) + (c + d))
    }
}
