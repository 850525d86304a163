//! Number, sum and extremes of values: what a bin keeps of what fell into it.

/// What can be put together with another of its kind.
pub(crate) trait Merge {
    fn merge(&mut self, other: &Self);
}

/// Values by their number, sum and extremes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spread {
    pub(crate) n: f64,
    pub(crate) sum: f64,
    pub(crate) min: f64,
    pub(crate) max: f64,
}

impl Default for Spread {
    fn default() -> Self {
        Self {
            n: 0.0,
            sum: 0.0,
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
        }
    }
}

impl Spread {
    /// Takes a value; what is not finite says nothing and is passed over.
    #[inline]
    pub(crate) fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.n += 1.0;
            self.sum += value;
            self.min = self.min.min(value);
            self.max = self.max.max(value);
        }
    }

    /// The mean, if there is any value.
    pub(crate) fn mean(&self) -> Option<f64> {
        (self.n > 0.0).then(|| self.sum / self.n)
    }

    /// The same values, each less a constant.
    pub(crate) fn less(&self, constant: f64) -> Self {
        Self {
            n: self.n,
            sum: self.sum - self.n * constant,
            min: self.min - constant,
            max: self.max - constant,
        }
    }
}

impl Merge for Spread {
    fn merge(&mut self, other: &Self) {
        self.n += other.n;
        self.sum += other.sum;
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }
}

impl<T: Merge, const N: usize> Merge for [T; N] {
    fn merge(&mut self, other: &Self) {
        for (mine, others) in self.iter_mut().zip(other) {
            mine.merge(others);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_not_finite_are_passed_over() {
        let mut spread = Spread::default();
        assert_eq!(spread.mean(), None);
        for value in [3.0, f64::NAN, -1.0, f64::INFINITY] {
            spread.add(value);
        }
        assert_eq!(spread.mean(), Some(1.0));
        let less = spread.less(1.0);
        assert_eq!((less.min, less.max, less.mean()), (-2.0, 2.0, Some(0.0)));
    }
}
