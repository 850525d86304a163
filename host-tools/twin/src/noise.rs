//! Noise and quantisation of the gyro and temperature channels.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Noise of a unit; the same for its three axes.
///
/// A mean rate over `tau` carries two independent errors: the random walk,
/// `angle_random_walk / sqrt(tau)`, and the counting of whole pulses, `1 / (sqrt(6) tau)` (the
/// difference of two errors uniform over one pulse). With [`NoiseLevels::TYPICAL`] these are
/// 0.0030 and 0.0041 pulses/s for 100 s, 0.0051 pulses/s together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseLevels {
    /// Angle random walk, pulses/sqrt(s).
    pub angle_random_walk_pulses_per_sqrt_s: f64,
    /// White noise of one temperature reading before quantisation, sigma in degC.
    pub temperature_sigma_c: f64,
    /// Step of the temperature reading, degC; 0 for none.
    pub temperature_lsb_c: f64,
}

impl NoiseLevels {
    /// A good unit with a common digital temperature sensor.
    pub const TYPICAL: Self = Self {
        angle_random_walk_pulses_per_sqrt_s: 0.03,
        temperature_sigma_c: 0.02,
        temperature_lsb_c: 0.0625,
    };

    /// Neither noise nor temperature steps. Pulses are whole all the same.
    pub const NONE: Self = Self {
        angle_random_walk_pulses_per_sqrt_s: 0.0,
        temperature_sigma_c: 0.0,
        temperature_lsb_c: 0.0,
    };
}

/// Stream of the temperature noise; the axes have those after it.
const TEMPERATURE_STREAM: u64 = 0;

/// Independent standard normal numbers, the same on every machine.
///
/// The polar method (Marsaglia and Bray, 1964) needs a square root, which is correctly rounded
/// everywhere, and one logarithm, taken from `libm`. The ziggurat of `rand_distr` is faster but
/// takes the platform's `exp` and `ln` for some of its numbers.
#[derive(Debug, Clone)]
struct NormalSource {
    generator: ChaCha8Rng,
    spare: Option<f64>,
}

impl NormalSource {
    /// Numbers of one seed differ between streams.
    fn new(seed: u64, stream: u64) -> Self {
        // The seed is the start of the key as it stands: no mixing function whose choice might
        // change with a library version.
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let mut generator = ChaCha8Rng::from_seed(key);
        generator.set_stream(stream);
        Self {
            generator,
            spare: None,
        }
    }

    fn next(&mut self) -> f64 {
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
    fn symmetric(&mut self) -> f64 {
        const STEP: f64 = 1.0 / (1_u64 << 52) as f64;
        (self.generator.next_u64() >> 11) as f64 * STEP - 1.0
    }
}

/// One gyro's output: whole pulses of an angle with random walk.
#[derive(Debug, Clone)]
pub(crate) struct PulseOutput {
    noise: NormalSource,
    walk_sigma_pulses: f64,
    /// Angle turned since the last whole pulse, 0..1.
    remainder_pulses: f64,
}

impl PulseOutput {
    /// Output of one axis for samples `interval_s` apart.
    pub(crate) fn new(levels: &NoiseLevels, interval_s: f64, seed: u64, axis: usize) -> Self {
        Self {
            noise: NormalSource::new(seed, TEMPERATURE_STREAM + 1 + axis as u64),
            walk_sigma_pulses: levels.angle_random_walk_pulses_per_sqrt_s * interval_s.sqrt(),
            remainder_pulses: 0.0,
        }
    }

    /// Pulses of one sample in which the bias alone turns `angle_pulses`.
    pub(crate) fn count(&mut self, angle_pulses: f64) -> i64 {
        let walk_pulses = self.walk_sigma_pulses * self.noise.next();
        self.quantise(angle_pulses + walk_pulses)
    }

    /// Whole pulses of an angle increment; the rest is carried, so that no angle is lost.
    fn quantise(&mut self, increment_pulses: f64) -> i64 {
        let angle_pulses = self.remainder_pulses + increment_pulses;
        let whole_pulses = angle_pulses.floor();
        self.remainder_pulses = angle_pulses - whole_pulses;
        whole_pulses as i64
    }
}

/// The temperature sensor on the case.
#[derive(Debug, Clone)]
pub(crate) struct TemperatureSensor {
    noise: NormalSource,
    sigma_c: f64,
    lsb_c: f64,
}

impl TemperatureSensor {
    pub(crate) fn new(levels: &NoiseLevels, seed: u64) -> Self {
        Self {
            noise: NormalSource::new(seed, TEMPERATURE_STREAM),
            sigma_c: levels.temperature_sigma_c,
            lsb_c: levels.temperature_lsb_c,
        }
    }

    /// One reading, degC, with the case at `case_c`.
    pub(crate) fn read(&mut self, case_c: f64) -> f64 {
        let noisy_c = case_c + self.sigma_c * self.noise.next();
        if self.lsb_c > 0.0 {
            // Half a step is rounded up on both sides of 0, as in an integrating converter.
            (noisy_c / self.lsb_c + 0.5).floor() * self.lsb_c
        } else {
            noisy_c
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(values: &[f64]) -> (f64, f64) {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        (mean, (square / (n - 1.0)).sqrt())
    }

    #[test]
    fn normal_numbers_are_normal() {
        let mut source = NormalSource::new(1, 0);
        let values: Vec<f64> = (0..200_000).map(|_| source.next()).collect();
        let (mean, sigma) = moments(&values);
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
        let mut source = NormalSource::new(1, 0);
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
        assert_eq!(first(1, 0), first(1, 0));
        assert_ne!(first(1, 0), first(2, 0));
        assert_ne!(first(1, 0), first(1, 1));
    }

    #[test]
    fn quantisation_loses_no_angle() {
        let mut output = PulseOutput::new(&NoiseLevels::NONE, 0.5, 1, 0);
        let mut source = NormalSource::new(3, 9);
        let (mut angle, mut pulses) = (0.0, 0);
        for _ in 0..100_000 {
            let increment = 0.7 * source.next() - 0.01;
            angle += increment;
            pulses += output.quantise(increment);
            let rest = angle - pulses as f64;
            assert!((-1e-6..1.0 + 1e-6).contains(&rest), "{rest}");
        }
        assert!(pulses < -900, "{pulses}");
    }

    /// Sigma of 100 s means of one axis's pulse rate at a bias, with and without whole pulses.
    fn sigma_100_s(bias_pulses_per_s: f64) -> (f64, f64) {
        let interval_s = 0.5;
        let mut output = PulseOutput::new(&NoiseLevels::TYPICAL, interval_s, 5, 2);
        let mut walk = output.clone();
        let (mut counted, mut unrounded) = (Vec::new(), Vec::new());
        for _ in 0..2000 {
            let (mut pulses, mut angle) = (0, 0.0);
            for _ in 0..200 {
                pulses += output.count(bias_pulses_per_s * interval_s);
                angle += bias_pulses_per_s * interval_s;
                angle += walk.walk_sigma_pulses * walk.noise.next();
            }
            counted.push(pulses as f64 / 100.0);
            unrounded.push(angle / 100.0);
        }
        (moments(&counted).1, moments(&unrounded).1)
    }

    #[test]
    fn noise_of_100_s_means_is_as_documented() {
        for bias_pulses_per_s in [0.0173, -0.02, 0.0] {
            let (counted, unrounded) = sigma_100_s(bias_pulses_per_s);
            assert!((unrounded / 0.0030 - 1.0).abs() < 0.1, "{unrounded}");
            assert!((counted / 0.0051 - 1.0).abs() < 0.1, "{counted}");
        }
    }

    #[test]
    fn temperature_readings_are_noisy_multiples_of_the_step() {
        let mut sensor = TemperatureSensor::new(&NoiseLevels::TYPICAL, 1);
        let readings: Vec<f64> = (0..20_000).map(|_| sensor.read(-3.03125)).collect();
        assert!(readings.iter().all(|t| (t / 0.0625).fract() == 0.0));
        // Half a step from either code, both come up alike.
        let (mean, _) = moments(&readings);
        assert!((mean + 3.03125).abs() < 0.001, "{mean}");

        let levels = NoiseLevels {
            temperature_lsb_c: 0.0,
            ..NoiseLevels::TYPICAL
        };
        let mut sensor = TemperatureSensor::new(&levels, 1);
        let readings: Vec<f64> = (0..20_000).map(|_| sensor.read(40.0)).collect();
        let (mean, sigma) = moments(&readings);
        assert!((mean - 40.0).abs() < 0.001, "{mean}");
        assert!((sigma / 0.02 - 1.0).abs() < 0.05, "{sigma}");
    }
}
