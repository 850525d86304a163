//! Whether this processor computes what it should: a small table, a ramp, and the bits that come
//! out of it on every sound processor.

use core::hint::black_box;

use tempco::{Play, Schedule, SlowPart, Stream, Table, Terms, Thermal, ThermalSettings};
use tempco_image::CRC;

/// CRC-32P4 of the outcomes, as every host and target finds it.
const ANSWER: u32 = 0x62f7feea;

const CELLS: [[Terms; 2]; 3] = [
    [
        Terms::new([0.21, -0.034, 0.0056], [0.071, -0.0089]),
        Terms::new([-1.3, 0.57, -0.091], [-0.23, 0.041]),
    ],
    [
        Terms::new([0.18, 0.012, -0.0034], [0.056, 0.0078]),
        Terms::new([-0.82, 0.39, 0.074], [-0.15, -0.026]),
    ],
    [
        Terms::new([0.19, -0.0067, 0.0021], [0.068, -0.0013]),
        Terms::new([-0.36, -0.28, 0.045], [-0.2, 0.038]),
    ],
];

const PLAYS: [Play<2>; 2] = [
    Play {
        half_width_c: 1.5,
        gain: [0.011, -0.023],
    },
    Play {
        half_width_c: 4.0,
        gain: [-0.0072, 0.019],
    },
];
const SLOW_PARTS: [SlowPart<2>; 1] = [SlowPart {
    tau_s: 600.0,
    limit_c: 8.0,
    gain: [0.0041, 0.0063],
}];

/// Whether the answer is the known one. It takes some 60,000 instructions.
pub fn is_right() -> bool {
    answer() == Some(ANSWER)
}

fn answer() -> Option<u32> {
    let thermal = Thermal::new(ThermalSettings::DEFAULT).ok()?;
    let table = Table::new(thermal, -20.0, 70.0, &CELLS).ok()?;
    let tables = [table.with_history(PLAYS, SLOW_PARTS).ok()?];
    let schedule = Schedule {
        sample_rate_hz: 20.0,
        samples_per_update: 4,
    };
    let mut stream = Stream::new(&tables, &schedule);
    let mut digest = CRC.digest();
    let mut temp_c = -30.0_f32;
    for number in 0..120_u8 {
        if number % 4 == 0 {
            // Beyond both ends of the range, with a spike and a gap.
            temp_c += 3.9;
            let given_c = match number {
                40 => 140.0,
                80 => f32::NAN,
                _ => temp_c,
            };
            stream.temperatures(&[black_box(given_c)]);
        }
        let raw = [[black_box(f32::from(number) * 0.37 - 20.0), 0.5]];
        for channel in stream.sample(&raw) {
            digest.update(&u32::from(channel.status.bits()).to_le_bytes());
            for value in channel.compensated.iter().chain(&channel.bias) {
                digest.update(&value.to_le_bytes());
            }
        }
    }
    Some(digest.finalize())
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_answer_is_the_known_one() {
        assert_eq!(super::answer(), Some(super::ANSWER));
    }
}
