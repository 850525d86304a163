//! Equally wide bins along an axis whose ends are not known beforehand.

use super::spread::Merge;

/// A row of bins over a range that grows with what falls into it.
///
/// Bin `i` is `i width <= x < (i + 1) width`. Where there would be more than the most bins allowed,
/// neighbours are put together in pairs and the width doubles. Nothing is lost but resolution:
/// sums and extremes are of all values of the wider bin.
#[derive(Clone, Debug)]
pub(crate) struct Bins<T> {
    width: f64,
    most: usize,
    first: i64,
    bins: Vec<T>,
}

impl<T: Merge + Default + Clone> Bins<T> {
    /// No bins yet; at most `most` of `width` or, later, wider ones.
    pub(crate) fn new(width: f64, most: usize) -> Self {
        Self {
            width,
            most,
            first: 0,
            bins: Vec::new(),
        }
    }

    /// The bin at `x`, which is made if need be; `x` is finite.
    #[inline]
    pub(crate) fn at(&mut self, x: f64) -> &mut T {
        let place = (x / self.width).floor() as i64 - self.first;
        match usize::try_from(place) {
            Ok(place) if place < self.bins.len() => &mut self.bins[place],
            _ => self.grown_at(x),
        }
    }

    fn grown_at(&mut self, x: f64) -> &mut T {
        let bin = |width: f64| (x / width).floor() as i64;
        if self.bins.is_empty() {
            self.first = bin(self.width);
            self.bins.push(T::default());
            return &mut self.bins[0];
        }
        let reach = |bins: &Self| {
            let (bin, last) = (bin(bins.width), bins.first + bins.bins.len() as i64 - 1);
            (bin.min(bins.first), bin.max(last))
        };
        let (mut low, mut high) = reach(self);
        while (high - low) as u64 >= self.most as u64 {
            self.coarsen();
            (low, high) = reach(self);
        }
        let before = (self.first - low) as usize;
        self.bins
            .splice(0..0, std::iter::repeat_n(T::default(), before));
        self.first = low;
        self.bins.resize((high - low + 1) as usize, T::default());
        let place = (bin(self.width) - low) as usize;
        &mut self.bins[place]
    }

    /// Doubles the width.
    fn coarsen(&mut self) {
        let first = self.first.div_euclid(2);
        let mut wider: Vec<T> = Vec::with_capacity(self.bins.len() / 2 + 1);
        for (bin, number) in self.bins.iter().zip(self.first..) {
            let place = (number.div_euclid(2) - first) as usize;
            match wider.get_mut(place) {
                Some(wide) => wide.merge(bin),
                None => wider.push(bin.clone()),
            }
        }
        (self.first, self.bins) = (first, wider);
        self.width *= 2.0;
    }

    /// Adds what another row of bins holds; both began with the same width.
    pub(crate) fn absorb(&mut self, mut other: Self) {
        while self.width < other.width {
            self.coarsen();
        }
        while other.width < self.width {
            other.coarsen();
        }
        // The width of this one may double on the way; the middle of a bin never leaves it.
        for (middle, bin) in other.iter() {
            self.at(middle).merge(bin);
        }
    }

    /// The middle of each bin, and the bin; also the empty ones between others.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (f64, &T)> {
        self.bins
            .iter()
            .zip(self.first..)
            .map(|(bin, number)| ((number as f64 + 0.5) * self.width, bin))
    }

    /// The same places with other contents.
    pub(crate) fn map(&self, f: impl FnMut(&T) -> T) -> Self {
        Self {
            bins: self.bins.iter().map(f).collect(),
            ..*self
        }
    }

    /// Width of the bins by now.
    pub(crate) fn width(&self) -> f64 {
        self.width
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::gather::spread::Spread;

    fn binned(values: &[f64], most: usize) -> Bins<Spread> {
        let mut bins: Bins<Spread> = Bins::new(0.25, most);
        for &value in values {
            bins.at(value).add(value);
        }
        bins
    }

    proptest! {
        /// Whatever the order and however often the width doubled: values are in their bins,
        /// none is lost, and there are not too many bins.
        #[test]
        fn every_value_is_in_its_bin(
            values in prop::collection::vec(-1e4..1e4_f64, 1..200),
            most in 2_usize..40,
        ) {
            let bins = binned(&values, most);
            prop_assert!(bins.iter().count() <= most);
            let mut n = 0.0;
            for (middle, spread) in bins.iter() {
                n += spread.n;
                if spread.n > 0.0 {
                    prop_assert!(spread.min >= middle - 0.5 * bins.width());
                    prop_assert!(spread.max < middle + 0.5 * bins.width());
                }
            }
            prop_assert_eq!(n, values.len() as f64);
            let max = bins.iter().map(|(_, s)| s.max).fold(f64::NEG_INFINITY, f64::max);
            prop_assert_eq!(max, values.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        }

        #[test]
        fn bins_absorb_others_as_if_filled_together(
            a in prop::collection::vec(-100.0..100.0_f64, 1..50),
            b in prop::collection::vec(-1000.0..1000.0_f64, 1..50),
        ) {
            let mut both = binned(&a, 30);
            both.absorb(binned(&b, 30));
            let together = binned(&[a, b].concat(), 30);
            prop_assert_eq!(both.width(), together.width());
            let filled = |bins: &Bins<Spread>| -> Vec<(f64, f64, f64)> {
                bins.iter()
                    .filter(|(_, s)| s.n > 0.0)
                    .map(|(middle, s)| (middle, s.n, s.min))
                    .collect()
            };
            prop_assert_eq!(filled(&both), filled(&together));
        }
    }
}
