//! A sum that does not lose what its additions round off.

/// A sum and the error that was rounded off it (Neumaier, 1974).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sum {
    sum: f64,
    error: f64,
}

impl Sum {
    /// Adds a finite value.
    pub(super) fn add(&mut self, value: f64) {
        let sum = self.sum + value;
        self.error += if self.sum.abs() >= value.abs() {
            (self.sum - sum) + value
        } else {
            (value - sum) + self.sum
        };
        self.sum = sum;
    }

    /// The sum, right to the last place unless almost all of it cancels.
    pub(super) fn value(self) -> f64 {
        self.sum + self.error
    }
}

#[cfg(test)]
mod tests {
    use super::Sum;

    #[test]
    fn small_values_beside_a_large_one_are_kept() {
        let mut sum = Sum::default();
        sum.add(1e16);
        (0..1000).for_each(|_| sum.add(0.1));
        sum.add(-1e16);
        assert!((sum.value() - 100.0).abs() < 1e-11);
    }
}
