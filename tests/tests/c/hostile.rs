//! Every output of C is the core's, over samples that are spoilt.

use tempco::{
    BiasRamp, Compensator, Corrector, Interval, PulseCorrector, PulseRamp, RampBuffer, Status,
    Table, Terms, Thermal, ThermalHalf, ThermalPoint, ThermalSettings,
};
use tempco_dist::Platform;

use crate::support::{Build, POSIX_COMPILERS, arm_gcc};

const CELLS: usize = 9;
const SAMPLES_PER_UPDATE: u16 = 8;
const LONGEST_BLOCK: u32 = 40;
const PULSES_PER_UNIT: [f32; 6] = [0.5, -1.5, 4.0, 20.0, 0.001, 1.0];
const SETTINGS: [f32; 23] = [
    -60.0, 150.0, 2.0, 30.0, 60.0, 10.0, 90.0, 0.5, -8.0, 9.0, 20.0, 400.0, 0.25, -3.0, 4.0, 0.5,
    2.0, 0.75, -0.5, 0.7, 1.25, -2.0, 0.125,
];

/// xorshift64* of Vigna (2016), its upper half.
struct Noise(u64);

impl Noise {
    fn bits(&mut self) -> u32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32) as u32
    }

    /// Evenly from -1 to 1.
    fn even(&mut self) -> f32 {
        self.bits().cast_signed() as f32 * f32::from_bits(0x3000_0000)
    }

    /// One in eight is anything, or what breaks things.
    fn spoil(&mut self, good: f32) -> f32 {
        const SPECIAL: [u32; 8] = [
            0x7f80_0000,
            0xff80_0000,
            0x7fc0_0000,
            0xff80_0001,
            0x8000_0000,
            0x0000_0001,
            0x7f7f_ffff,
            0x3380_0000,
        ];
        match self.bits() % 16 {
            0 => f32::from_bits(self.bits()),
            1 => f32::from_bits(SPECIAL[self.bits() as usize % 8]),
            _ => good,
        }
    }
}

struct Hash(u64);

impl Hash {
    fn take(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x100_0000_01b3);
    }

    fn status(&mut self, status: Status) {
        self.take(status.bits().into());
    }

    /// One NaN is as good as another.
    fn floats(&mut self, numbers: &[f32]) {
        for number in numbers {
            self.take(if number.is_nan() {
                0x7fc0_0000
            } else {
                number.to_bits()
            });
        }
    }

    fn point(&mut self, point: &ThermalPoint) {
        self.floats(&[point.effective_c, point.rate_c_per_min, point.lag2_c]);
        self.floats(&point.plays_c);
        self.status(point.status);
    }

    fn ramp<const A: usize>(&mut self, ramp: &BiasRamp<A>) {
        self.floats(&ramp.end);
        self.floats(&ramp.slope);
        self.take(ramp.samples.into());
        self.status(ramp.status);
    }
}

/// What `hostile.c` does, by the core.
fn expected<const A: usize>(samples: u32) -> String {
    let mut noise = Noise(0x9e37_79b9_7f4a_7c15);
    let mut cells = [[Terms::new([], []); A]; CELLS];
    for terms in cells.as_flattened_mut() {
        *terms = Terms::from_array(std::array::from_fn(|_| noise.even()));
    }
    let mut gains = [[0.0; A]; 2];
    for axis in 0..A {
        for play in &mut gains {
            play[axis] = noise.even();
        }
    }
    let thermal = Thermal::new(ThermalSettings::from_array(SETTINGS)).unwrap();
    let table = Table::new(thermal, -40.0, 85.0, &cells).unwrap();
    let table = table.calibrated(-35.0, 80.0).unwrap();
    let table = &table.with_plays(gains).unwrap();

    let (ramps, pulse_ramps) = (RampBuffer::new(), RampBuffer::new());
    let pulses_per_unit = std::array::from_fn(|axis| PULSES_PER_UNIT[axis]);
    let publish = |hash: &mut Hash, ramp: &BiasRamp<A>| {
        hash.ramp(ramp);
        ramps.publish(ramp);
        pulse_ramps.publish(&PulseRamp::new(ramp, pulses_per_unit));
    };
    let mut half = ThermalHalf::new(table, SAMPLES_PER_UPDATE);
    let mut corrector = Corrector::new(&ramps);
    let mut pulses = PulseCorrector::new(&pulse_ramps);
    let mut compensator = Compensator::new(table);
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    publish(&mut hash, &ThermalHalf::constant(table));

    let (mut temp_c, mut step_c) = (20.0_f32, 0.0);
    for number in 0..samples {
        if number % 4096 == 0 {
            let start_c = noise.spoil(temp_c);
            publish(&mut hash, &half.start(start_c));
            compensator.start(start_c);
        }
        if number % 512 == 0 {
            step_c = 0.0625 * noise.even();
        }
        temp_c += step_c;
        if !(-50.0..=100.0).contains(&temp_c) {
            temp_c = 20.0;
        }
        let dt_s = match number / 4096 % 4 {
            2 => 0.125 + 0.0625 * noise.even(),
            3 => noise.spoil(0.1),
            _ => 0.1,
        };
        let interval = Interval::new(table.thermal(), dt_s);
        let reading_c = noise.spoil(temp_c);
        if number % u32::from(SAMPLES_PER_UPDATE) == 0 && !noise.bits().is_multiple_of(16) {
            let ramp = half.update(&interval, reading_c);
            publish(&mut hash, &ramp);
            hash.point(&half.point());
            hash.take(half.thermal_state().rejected());
        }

        let (mut raw, mut counts) = ([0.0; A], [0; A]);
        for (raw, count) in raw.iter_mut().zip(&mut counts) {
            let good = noise.even();
            *raw = noise.spoil(good);
            *count = noise.bits().cast_signed();
        }
        let out = compensator.step(&interval, reading_c, raw);
        hash.floats(&out.compensated);
        hash.floats(&out.bias);
        hash.point(&out.point);
        hash.status(out.status);
        hash.status(Status::of_raw(&raw));
        hash.floats(&corrector.correct(raw));
        hash.status(corrector.status());
        for count in pulses.correct(counts) {
            hash.take(count.cast_unsigned());
        }
        hash.status(pulses.status());

        if number % 16 == 0 {
            let count = noise.bits() % (LONGEST_BLOCK + 1);
            let mut block = vec![[0.0; A]; count as usize];
            for value in block.as_flattened_mut() {
                let good = noise.even();
                *value = noise.spoil(good);
            }
            corrector.correct_slice(&mut block);
            hash.floats(block.as_flattened());
        }
    }
    format!("hash {:08x} {:08x} \n", hash.0 >> 32, hash.0 as u32)
}

fn hostile(axes: usize, samples: u32) -> Build {
    let build = Build::new(&format!("hostile{axes}"));
    build
        .source("tests/tests/c/hostile.c")
        .define("AXES", axes)
        .define("SAMPLES", samples)
}

/// Numbers of axes, each with its samples.
const RUNS: [(usize, u32); 4] = [(1, 50_000), (2, 50_000), (3, 1_000_000), (6, 50_000)];

fn expected_of(axes: usize, samples: u32) -> String {
    match axes {
        1 => expected::<1>(samples),
        2 => expected::<2>(samples),
        3 => expected::<3>(samples),
        _ => expected::<6>(samples),
    }
}

#[test]
fn on_this_machine_every_bit_is_the_cores() {
    for compiler in POSIX_COMPILERS {
        if !compiler.is_there() {
            println!("skipped: there is no {}", compiler.program);
            continue;
        }
        for (axes, samples) in RUNS {
            let program = hostile(axes, samples).define("POSIX", 1);
            let said = program.with(&compiler).run();
            let expected = expected_of(axes, samples);
            assert_eq!(said, expected, "{} of {axes}", compiler.program);
        }
    }
}

#[test]
fn on_a_cortex_m4f_every_bit_is_the_cores() {
    if let Some(compiler) = arm_gcc() {
        for (axes, samples) in RUNS {
            let program = hostile(axes, samples).bare_metal().with(&compiler);
            assert_eq!(program.run(), expected_of(axes, samples), "{axes}");
        }
    }
}

/// Soft float by the archive's own functions.
#[test]
fn on_a_cortex_m3_every_bit_is_the_cores() {
    if let Some(compiler) = arm_gcc() {
        let mut compiler = compiler;
        compiler.platform = Platform::M3;
        compiler.flags = &["-mcpu=cortex-m3", "-mthumb"];
        let program = hostile(3, 50_000).bare_metal().with(&compiler);
        assert_eq!(program.run(), expected::<3>(50_000));
    }
}

/// The hash sees a coefficient that is off by its last bit, and a call that takes another argument.
#[test]
fn faults_on_purpose_are_seen() {
    let gcc = POSIX_COMPILERS[0];
    let of = |fault: usize| {
        let program = hostile(3, 20_000).define("POSIX", 1).define("FAULT", fault);
        program.with(&gcc).run()
    };
    let expected = expected::<3>(20_000);
    assert_eq!(of(0), expected);
    assert_ne!(of(1), expected);
    assert_ne!(of(2), expected);
}
