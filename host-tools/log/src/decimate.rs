//! An evenly spaced sample of a series, in memory that does not grow with the series.

/// Keeps an even sample of a series: all of a short one, every nth value of a longer one, so that
/// between half of `most` and `most` are left.
#[derive(Clone, Debug)]
pub struct Decimated {
    values: Vec<f64>,
    most: usize,
    stride: usize,
    /// Values to pass over before the next one is kept.
    to_pass: usize,
}

impl Decimated {
    /// A sample of at most `most` values.
    ///
    /// # Panics
    /// If `most` is odd or 0, with which the spacing would not stay even.
    pub fn new(most: usize) -> Self {
        assert!(most > 0 && most.is_multiple_of(2));
        Self {
            values: Vec::new(),
            most,
            stride: 1,
            to_pass: 0,
        }
    }

    /// Takes in the next `count` values of the series.
    pub fn extend(&mut self, count: usize, value: impl Fn(usize) -> f64) {
        let mut at = self.to_pass;
        while at < count {
            if self.values.len() == self.most {
                let mut position = 0;
                self.values.retain(|_| {
                    position += 1;
                    position % 2 == 1
                });
                self.stride *= 2;
            }
            self.values.push(value(at));
            at += self.stride;
        }
        self.to_pass = at - count;
    }

    /// Length of the series so far, about.
    pub fn seen(&self) -> usize {
        self.values.len() * self.stride
    }

    /// Those that were kept.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sample_is_evenly_spaced_however_it_was_taken_in() {
        let mut at_once = Decimated::new(8);
        at_once.extend(100, |i| i as f64);
        let mut by_parts = Decimated::new(8);
        for start in (0..100).step_by(7) {
            let count = 7.min(100 - start);
            by_parts.extend(count, |i| (start + i) as f64);
        }
        let expected: Vec<f64> = (0..7).map(|i| 16.0 * f64::from(i)).collect();
        assert_eq!(at_once.values(), expected);
        assert_eq!(by_parts.values(), expected);
        let mut short = Decimated::new(8);
        short.extend(8, |i| i as f64);
        assert_eq!(short.values().len(), 8);
    }
}
