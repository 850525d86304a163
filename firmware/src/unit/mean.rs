//! Means of many samples.

/// Samples that are added up in single precision before they are taken over in double precision.
const BLOCK: u16 = 256;

/// Sums of one thing per axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mean<const C: usize, const A: usize> {
    block: [[f32; A]; C],
    in_block: u16,
    sum: [[f64; A]; C],
    count: u32,
}

impl<const C: usize, const A: usize> Default for Mean<C, A> {
    fn default() -> Self {
        Self {
            block: [[0.0; A]; C],
            in_block: 0,
            sum: [[0.0; A]; C],
            count: 0,
        }
    }
}

impl<const C: usize, const A: usize> Mean<C, A> {
    /// Takes values, channel by channel.
    pub(super) fn add(&mut self, values: &[[f32; A]; C]) {
        for (block, values) in self.block.iter_mut().zip(values) {
            for (sum, value) in block.iter_mut().zip(values) {
                *sum += value;
            }
        }
        self.in_block += 1;
        self.count = self.count.saturating_add(1);
        if self.in_block == BLOCK {
            self.fold();
        }
    }

    /// How many samples it is of.
    pub(super) const fn count(&self) -> u32 {
        self.count
    }

    /// The means; zeros of nothing.
    pub(super) fn means(mut self) -> [[f32; A]; C] {
        self.fold();
        let count = f64::from(self.count.max(1));
        self.sum.map(|sums| sums.map(|sum| (sum / count) as f32))
    }

    fn fold(&mut self) {
        for (sums, block) in self.sum.iter_mut().zip(&mut self.block) {
            for (sum, value) in sums.iter_mut().zip(block) {
                *sum += f64::from(*value);
                *value = 0.0;
            }
        }
        self.in_block = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_an_hour_is_right_to_single_precision() {
        let mut mean = Mean::<1, 2>::default();
        for number in 0..7_200_000_u32 {
            let noise = (number % 7) as f32 - 3.0;
            mean.add(&[[0.013 + noise, 1234.5]]);
        }
        let [[small, large]] = mean.means();
        assert!((small - 0.013).abs() < 1e-6, "{small}");
        assert_eq!(large, 1234.5);
    }
}
