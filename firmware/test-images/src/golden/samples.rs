//! Samples without a pattern, the same on every machine.

/// Values that break things, as bits.
const SPECIAL: [u32; 16] = [
    0x0000_0000, // 0
    0x8000_0000, // -0
    0x0000_0001, // the smallest subnormal number
    0x807f_ffff, // minus the largest one
    0x0080_0000, // the smallest normal number
    0x7f7f_ffff, // the largest number
    0xff7f_ffff,
    0x7f80_0000, // infinity
    0xff80_0000,
    0x7fc0_0000, // NaN
    0xff80_0001, // a signalling NaN
    0x4316_0000, // 150, the sensor's hot end
    0x4316_0001,
    0xc270_0000, // -60, its cold end
    0xc270_0001,
    0x3380_0000, // 2^-24
];

/// How long one kind of sample time lasts, and one course of temperature at least [samples].
const PHASE: u32 = 4096;

pub(crate) struct Sample<const A: usize> {
    pub(crate) dt_s: f32,
    pub(crate) temp_c: f32,
    pub(crate) raw: [f32; A],
    /// Whether a thermal update that is due now is left out.
    pub(crate) skips_update: bool,
}

/// A temperature that wanders over and beyond the calibrated range at up to 12 degC/min, and what
/// goes wrong on the way.
pub(crate) struct Samples {
    noise: Noise,
    count: u32,
    /// The temperature, where it goes and how fast [millidegC], [millidegC per sample].
    temp_millic: i32,
    goal_millic: i32,
    speed_millic: i32,
    times: Times,
}

#[derive(Clone, Copy)]
enum Times {
    Steady,
    Jittered,
    Hostile,
}

impl Samples {
    pub(crate) const fn new() -> Self {
        Self {
            noise: Noise(0x9e37_79b9_7f4a_7c15),
            count: 0,
            temp_millic: 25_000,
            goal_millic: 25_000,
            speed_millic: 1,
            times: Times::Steady,
        }
    }

    /// A sample every 0.1 s, with one in eight of the temperatures and gyro samples spoilt; the
    /// times are steady, jittered or spoilt too, in turns.
    pub(crate) fn hostile<const A: usize>(&mut self) -> Sample<A> {
        if self.count.is_multiple_of(PHASE) {
            self.begin_phase();
        }
        self.count = self.count.wrapping_add(1);
        let way = self.goal_millic - self.temp_millic;
        self.temp_millic += way.clamp(-self.speed_millic, self.speed_millic);
        // Noise of the sensor, in steps of 1/16 degC.
        let steps = (self.temp_millic + self.noise.below(120) as i32 - 60) * 2 / 125;
        let temp_c = steps as f32 * 0.0625;
        let jittered_s = (self.noise.below(2000) + 1000) as f32 * 5e-5;
        Sample {
            dt_s: match self.times {
                Times::Steady => 0.1,
                Times::Jittered => jittered_s,
                Times::Hostile => self.noise.spoil(jittered_s),
            },
            temp_c: self.noise.spoil(temp_c),
            raw: core::array::from_fn(|_| {
                let raw = (self.noise.below(20_000) as f32 - 10_000.0) * 1e-4;
                self.noise.spoil(raw)
            }),
            skips_update: self.noise.below(16) == 0,
        }
    }

    /// A sample around 0 degC whose temperatures, and so all differences of them in the
    /// estimator, are subnormal numbers.
    pub(crate) fn subnormal<const A: usize>(&mut self) -> Sample<A> {
        Sample {
            dt_s: 0.1,
            temp_c: self.noise.subnormal(),
            raw: core::array::from_fn(|_| self.noise.subnormal()),
            skips_update: false,
        }
    }

    fn begin_phase(&mut self) {
        self.goal_millic = self.noise.below(135_000) as i32 - 45_000;
        self.speed_millic = self.noise.below(20) as i32 + 1;
        self.times = match self.noise.below(4) {
            0 | 1 => Times::Steady,
            2 => Times::Jittered,
            _ => Times::Hostile,
        };
    }
}

/// The generator xorshift64* of Vigna (2016), of which the upper half is used.
struct Noise(u64);

impl Noise {
    fn bits(&mut self) -> u32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32) as u32
    }

    /// A number below `limit`.
    fn below(&mut self, limit: u32) -> u32 {
        ((u64::from(self.bits()) * u64::from(limit)) >> 32) as u32
    }

    /// `good` seven times in eight, else any bits or a special value.
    fn spoil(&mut self, good: f32) -> f32 {
        let place = self.below(SPECIAL.len() as u32) as usize;
        match self.below(16) {
            0 => f32::from_bits(self.bits()),
            1 => f32::from_bits(SPECIAL.get(place).copied().unwrap_or_default()),
            _ => good,
        }
    }

    /// Any subnormal number, or a zero.
    fn subnormal(&mut self) -> f32 {
        f32::from_bits(self.bits() & 0x807f_ffff)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_input_in_eight_is_spoilt() {
        let mut noise = Noise(1);
        let spoilt = (0..80_000).filter(|_| noise.spoil(0.123) != 0.123).count();
        assert!((9_500..10_500).contains(&spoilt), "{spoilt}");
    }

    #[test]
    fn the_temperature_covers_the_range_and_more() {
        let mut samples = Samples::new();
        let (mut coldest, mut hottest) = (0, 0);
        for _ in 0..1_000_000 {
            let _: Sample<1> = samples.hostile();
            coldest = coldest.min(samples.temp_millic);
            hottest = hottest.max(samples.temp_millic);
        }
        assert!(coldest < -40_000 && hottest > 80_000, "{coldest} {hottest}");
    }

    #[test]
    fn subnormal_samples_are_subnormal() {
        let mut samples = Samples::new();
        for _ in 0..1000 {
            let Sample {
                temp_c, raw: [raw], ..
            } = samples.subnormal::<1>();
            for value in [temp_c, raw] {
                assert!(value.is_subnormal() || value == 0.0);
            }
        }
    }
}
