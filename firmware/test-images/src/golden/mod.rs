//! Golden vectors: samples made of integers, and a hash of every bit of the core's outputs.
//!
//! Host and targets run this very code. Equal hashes say that no bit of any output differed; the
//! hash is taken after each million samples, so a difference is found to within a million. Before
//! the first sample comes a short run on subnormal numbers, with a hash of its own: a processor
//! that flushes them to zero shows there.

pub(crate) mod samples;

use tempco::{Compensator, Corrector, Interval, Output, RampBuffer, Table, ThermalHalf};

use samples::{Sample, Samples};

/// Samples between two hashes.
const MILLION: u32 = 1_000_000;
/// Samples of the run on subnormal numbers.
const SUBNORMAL_SAMPLES: u32 = 10_000;
/// Gyro samples per thermal update of the thermal half.
const SAMPLES_PER_UPDATE: u16 = 8;
/// One sample in so many is for the tables with terms of the thermal history.
const HISTORY_SHARE: u32 = 8;

/// Steps so many samples through the compensators and both halves of all `tables`, and
/// an eighth as many through those of `histories`. Calls `report` with 0 and the hashes of the
/// subnormal run, then after each million and at the end with the samples so far and the hashes of
/// them all.
pub fn run<const C: usize, const H: usize, const A: usize>(
    tables: &[Table<'_, A>; C],
    histories: &[Table<'_, A>; H],
    samples: u32,
    mut report: impl FnMut(u32, u64, u64),
) {
    let mut golden = Golden::new(tables);
    let mut history = Golden::new(histories);
    golden.steps(SUBNORMAL_SAMPLES, Samples::subnormal);
    history.steps(SUBNORMAL_SAMPLES, Samples::subnormal);
    report(0, golden.hash(), history.hash());
    golden = Golden::new(tables);
    history = Golden::new(histories);
    let mut done = 0;
    while done < samples {
        let count = (samples - done).min(MILLION);
        golden.steps(count, Samples::hostile);
        history.steps(count / HISTORY_SHARE, Samples::hostile);
        done += count;
        report(done, golden.hash(), history.hash());
    }
}

/// The compensators of one temperature channel.
struct Unit<'t, const A: usize> {
    table: &'t Table<'t, A>,
    single: Compensator<'t, A>,
    thermal: ThermalHalf<'t, A>,
    ramps: RampBuffer<A>,
}

struct Golden<'t, const C: usize, const A: usize> {
    units: [Unit<'t, A>; C],
    samples: Samples,
    count: u32,
    hash: Fnv,
}

impl<'t, const C: usize, const A: usize> Golden<'t, C, A> {
    fn new(tables: &'t [Table<'t, A>; C]) -> Self {
        Self {
            units: tables.each_ref().map(|table| Unit {
                table,
                single: Compensator::new(table),
                thermal: ThermalHalf::new(table, SAMPLES_PER_UPDATE),
                ramps: RampBuffer::new(),
            }),
            samples: Samples::new(),
            count: 0,
            hash: Fnv::new(),
        }
    }

    fn steps(&mut self, count: u32, sample: impl Fn(&mut Samples) -> Sample<A>) {
        for _ in 0..count {
            let sample = sample(&mut self.samples);
            self.step(&sample);
        }
    }

    fn step(&mut self, sample: &Sample<A>) {
        let updates = self.count.is_multiple_of(u32::from(SAMPLES_PER_UPDATE));
        for unit in &mut self.units {
            let thermal = unit.table.thermal();
            let mut ramp = None;
            if self.count == 0 {
                unit.single.start(sample.temp_c);
                ramp = Some(unit.thermal.start(sample.temp_c));
            }
            // Some updates are left out, so that the ramp ends and goes overdue.
            if updates & !sample.skips_update {
                let dt_s = sample.dt_s * f32::from(SAMPLES_PER_UPDATE);
                let interval = Interval::new(thermal, dt_s);
                ramp = Some(unit.thermal.update(&interval, sample.temp_c));
            }
            if let Some(ramp) = ramp {
                unit.ramps.publish(&ramp);
            }
            let interval = Interval::new(thermal, sample.dt_s);
            let output = unit.single.step(&interval, sample.temp_c, sample.raw);
            self.hash.output(&output);
            let (bias, status) = Corrector::new(&unit.ramps).advance::<1>();
            let output = Output {
                compensated: core::array::from_fn(|axis| sample.raw[axis] - bias[axis]),
                bias,
                point: unit.thermal.point(),
                status,
            };
            self.hash.output(&output);
        }
        self.count = self.count.wrapping_add(1);
    }

    /// The hash of all outputs, and of the counters of faults.
    fn hash(&self) -> u64 {
        let mut hash = self.hash;
        for unit in &self.units {
            for state in [unit.single.thermal_state(), unit.thermal.thermal_state()] {
                hash.word(state.rejected());
                hash.word(state.restarts());
            }
        }
        hash.0
    }
}

/// FNV-1a of 64 bits over little-endian words.
#[derive(Clone, Copy)]
struct Fnv(u64);

impl Fnv {
    const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn word(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Every bit of an output, but that a NaN counts as one: which one an operation makes differs
    /// between processors.
    fn output<const A: usize>(&mut self, output: &Output<A>) {
        for value in output.compensated {
            self.word(if value.is_nan() {
                0x7fc0_0000
            } else {
                value.to_bits()
            });
        }
        for value in output.bias {
            self.word(value.to_bits());
        }
        self.word(output.point.effective_c.to_bits());
        self.word(output.point.rate_c_per_min.to_bits());
        self.word(output.point.lag2_c.to_bits());
        for play_c in output.point.plays_c {
            self.word(play_c.to_bits());
        }
        self.word(u32::from(output.point.status.bits()));
        self.word(u32::from(output.status.bits()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The samples lead everywhere: every flag is raised, and the temperature is not just lost.
    #[test]
    fn the_samples_raise_every_flag() {
        use tempco::{Status, Validity};
        let table = &crate::history::HISTORY[0];
        let mut unit = Compensator::new(table);
        let mut samples = Samples::new();
        let (mut seen, mut usable) = (Status::OK, 0);
        for _ in 0..120_000 {
            let sample = samples.hostile();
            let interval = Interval::new(table.thermal(), sample.dt_s);
            let status = unit.step(&interval, sample.temp_c, sample.raw).status;
            seen |= status;
            usable += u32::from(status.validity() != Validity::Invalid);
        }
        for (flag, name) in Status::NAMES {
            assert!(seen.contains(flag), "{name} is never raised");
        }
        assert!(usable > 20_000, "{usable} usable samples");
    }

    /// The published test vector of the hash for `foobar`, of which a word is four bytes.
    #[test]
    fn the_hash_is_fnv_1a() {
        let mut hash = Fnv::new();
        hash.word(u32::from_le_bytes(*b"foob"));
        for byte in *b"ar" {
            hash.0 = (hash.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
        assert_eq!(hash.0, 0x8594_4171_f739_67e8);
    }

    #[test]
    fn one_bit_of_one_output_changes_the_hash() {
        let table = &tempco_firmware::table::TABLES[0];
        let mut unit = Compensator::new(table);
        let interval = Interval::new(table.thermal(), 0.1);
        let output = unit.step(&interval, 25.0, [0.5; tempco_firmware::table::AXES]);
        let hash = |output| {
            let mut hash = Fnv::new();
            hash.output(output);
            hash.0
        };
        let mut other = output;
        other.bias[1] = other.bias[1].next_up();
        assert_ne!(hash(&other), hash(&output));
        let mut other = output;
        other.compensated[0] = -other.compensated[0];
        assert_ne!(hash(&other), hash(&output));
    }
}
