//! The constant bias at rest, found without a chamber.

/// Samples that are added up in single precision before they are taken over in double precision.
const BLOCK: u16 = 256;

/// Sums of one thing per axis.
#[derive(Clone, Copy, Debug)]
pub struct Mean<const C: usize, const A: usize> {
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
    pub fn add(&mut self, values: [&[f32; A]; C]) {
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

    /// The means; zeros of nothing.
    pub fn means(mut self) -> [[f32; A]; C] {
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

/// An averaging under way.
#[derive(Clone, Copy, Debug)]
pub struct ReZero<const C: usize, const A: usize> {
    /// What the gyro should show meanwhile, such as the Earth's rate.
    expected: [[f32; A]; C],
    remaining: u32,
    mean: Mean<C, A>,
}

impl<const C: usize, const A: usize> ReZero<C, A> {
    /// An averaging over `samples`, during which the gyro should show what is `expected`.
    pub fn new(samples: u32, expected: [[f32; A]; C]) -> Self {
        Self {
            expected,
            remaining: samples,
            mean: Mean::default(),
        }
    }

    /// Takes a sample without its thermal bias; the constant biases once it was the last.
    pub fn add(&mut self, values: [&[f32; A]; C]) -> Option<[[f32; A]; C]> {
        self.mean.add(values);
        self.remaining = self.remaining.saturating_sub(1);
        if self.remaining > 0 {
            return None;
        }
        let mut offsets = self.mean.means();
        for (offsets, expected) in offsets.iter_mut().zip(&self.expected) {
            for (offset, expected) in offsets.iter_mut().zip(expected) {
                *offset -= expected;
            }
        }
        Some(offsets)
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
            mean.add([&[0.013 + noise, 1234.5]]);
        }
        let [[small, large]] = mean.means();
        assert!((small - 0.013).abs() < 1e-6, "{small}");
        assert_eq!(large, 1234.5);
    }

    #[test]
    fn what_the_gyro_should_show_is_no_bias() {
        let mut rezero = ReZero::<1, 1>::new(3, [[15.0]]);
        assert_eq!(rezero.add([&[15.5]]), None);
        assert_eq!(rezero.add([&[16.0]]), None);
        assert_eq!(rezero.add([&[16.5]]), Some([[1.0]]));
    }
}
