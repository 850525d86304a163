//! Independent standard normal numbers, the same on every machine.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// What a stream of random numbers is for: no two uses share numbers, so that one effect does not
/// change the noise of another.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Stream {
    /// Noise of the temperature sensor.
    Temperature,
    /// Angle random walk of an axis.
    AngleWalk(usize),
    /// White angle noise of an axis.
    AngleNoise(usize),
    /// Turn-on, flicker and random walk of an axis's bias.
    Drift(usize),
    /// Phase and frequency of a tone.
    Tone(usize),
    /// Which rows are lost.
    Rows,
    /// Heat flow and sensor of a unit that is drawn.
    DrawnHeat,
    /// An axis of a unit that is drawn.
    DrawnAxis(usize),
    /// Air that wanders.
    Wander,
}

impl Stream {
    /// Numbers that must not change: they decide the bytes of every log.
    const fn number(self) -> u64 {
        match self {
            Self::Temperature => 0,
            Self::AngleWalk(axis) => 1 + axis as u64,
            Self::AngleNoise(axis) => 4 + axis as u64,
            Self::Drift(axis) => 7 + axis as u64,
            Self::Rows => 10,
            Self::DrawnHeat => 11,
            Self::DrawnAxis(axis) => 12 + axis as u64,
            Self::Wander => 15,
            Self::Tone(tone) => 100 + tone as u64,
        }
    }
}

/// Independent standard normal numbers, the same on every machine.
///
/// The polar method (Marsaglia and Bray, 1964) needs a square root, which is correctly rounded
/// everywhere, and one logarithm, taken from `libm`. The ziggurat of `rand_distr` is faster but
/// takes the platform's `exp` and `ln` for some of its numbers.
#[derive(Debug, Clone)]
pub(crate) struct NormalSource {
    generator: ChaCha8Rng,
    spare: Option<f64>,
}

impl NormalSource {
    /// Numbers of one seed differ between streams.
    pub(crate) fn new(seed: u64, stream: Stream) -> Self {
        // The seed is the start of the key as it stands: no mixing function whose choice might
        // change with a library version.
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let mut generator = ChaCha8Rng::from_seed(key);
        generator.set_stream(stream.number());
        Self {
            generator,
            spare: None,
        }
    }

    pub(crate) fn next(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (u, v) = (self.symmetric(), self.symmetric());
            let square = u * u + v * v;
            if square > 0.0 && square < 1.0 {
                let factor = (-2.0 * libm::log(square) / square).sqrt();
                self.spare = Some(v * factor);
                return u * factor;
            }
        }
    }

    /// Uniform over -1..1, a multiple of 2^-52.
    pub(crate) fn symmetric(&mut self) -> f64 {
        const STEP: f64 = 1.0 / (1_u64 << 52) as f64;
        (self.generator.next_u64() >> 11) as f64 * STEP - 1.0
    }

    /// Uniform between two numbers.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + 0.5 * (self.symmetric() + 1.0) * (high - low)
    }

    /// Between two positive numbers, the logarithm uniform.
    pub(crate) fn log_between(&mut self, low: f64, high: f64) -> f64 {
        libm::exp(self.between(libm::log(low), libm::log(high)))
    }

    /// 1 or -1.
    pub(crate) fn sign(&mut self) -> f64 {
        1.0_f64.copysign(self.symmetric())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_numbers_are_normal() {
        let mut source = NormalSource::new(1, Stream::Temperature);
        let values: Vec<f64> = (0..200_000).map(|_| source.next()).collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        let sigma = (square / (n - 1.0)).sqrt();
        assert!(mean.abs() < 0.01, "{mean}");
        assert!((sigma - 1.0).abs() < 0.01, "{sigma}");
        for (limit, expected) in [(1.0, 0.3173), (2.0, 0.0455), (3.0, 0.0027)] {
            let outside = values.iter().filter(|v| v.abs() > limit).count();
            let share = outside as f64 / values.len() as f64;
            assert!((share / expected - 1.0).abs() < 0.15, "{limit}: {share}");
        }
        let product: f64 = values.windows(2).map(|pair| pair[0] * pair[1]).sum();
        assert!((product / values.len() as f64).abs() < 0.01);
    }

    #[test]
    fn normal_numbers_are_pinned() {
        // Any change here changes every simulated log.
        let mut source = NormalSource::new(1, Stream::Temperature);
        let bits: Vec<u64> = (0..4).map(|_| source.next().to_bits()).collect();
        assert_eq!(
            bits,
            [
                13_829_338_483_605_949_855,
                13_832_791_890_065_876_380,
                4_604_492_656_969_739_618,
                4_605_867_243_948_463_800,
            ]
        );
    }

    #[test]
    fn seeds_and_streams_are_independent() {
        let first = |seed, stream| NormalSource::new(seed, stream).next();
        let streams = [
            Stream::Temperature,
            Stream::AngleWalk(0),
            Stream::AngleWalk(2),
            Stream::AngleNoise(0),
            Stream::AngleNoise(2),
            Stream::Drift(0),
            Stream::Drift(2),
            Stream::Rows,
            Stream::DrawnHeat,
            Stream::DrawnAxis(0),
            Stream::DrawnAxis(2),
            Stream::Wander,
            Stream::Tone(0),
        ];
        for (index, stream) in streams.into_iter().enumerate() {
            assert_eq!(first(1, stream), first(1, stream));
            assert_ne!(first(1, stream), first(2, stream));
            for other in &streams[..index] {
                assert_ne!(first(1, stream), first(1, *other));
            }
        }
    }
}
