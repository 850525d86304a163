//! Whether this processor computes what it should: a small table, a ramp, and the bits that come
//! out of it on every sound processor.

use core::hint::black_box;

use tempco::{PLAYS, Schedule, Stream, Table, Terms, Thermal, ThermalSettings};
use tempco_image::CRC;

/// CRC-32P4 of the outcomes, as every host and target finds it.
const ANSWER: u32 = 0x43958cab;

/// A second lag, both plays and their start after power-on.
const SETTINGS: ThermalSettings = ThermalSettings {
    tau_s: 120.0,
    kappa: 0.3,
    rate_min_c_per_min: -25.0,
    rate_max_c_per_min: 25.0,
    kappa2: -0.05,
    lag2_min_c: -30.0,
    lag2_max_c: 60.0,
    half_width1_c: 1.5,
    half_width2_c: 4.0,
    play_kappa: 0.2,
    play_kappa2: 0.07,
    least_divisor: 0.6,
    rate_start: 1.4,
    lag2_start_min: 0.3,
    play_start_min: 0.1,
    ..ThermalSettings::DEFAULT
};

const CELLS: [[Terms; 2]; 3] = [
    [
        Terms::from_array([0.21, -0.034, 0.0056, 0.071, -0.0089, 0.0041, -0.0012]),
        Terms::from_array([-1.3, 0.57, -0.091, -0.23, 0.041, 0.0063, 0.0027]),
    ],
    [
        Terms::from_array([0.18, 0.012, -0.0034, 0.056, 0.0078, 0.0029, 0.0016]),
        Terms::from_array([-0.82, 0.39, 0.074, -0.15, -0.026, 0.0088, -0.0034]),
    ],
    [
        Terms::from_array([0.19, -0.0067, 0.0021, 0.068, -0.0013, 0.0045, -0.0007]),
        Terms::from_array([-0.36, -0.28, 0.045, -0.2, 0.038, 0.0052, 0.0019]),
    ],
];

const PLAY_GAINS: [[f32; 2]; PLAYS] = [[0.011, -0.023], [-0.0072, 0.019]];

/// Whether the answer is the known one. It takes some 60,000 instructions.
pub fn is_right() -> bool {
    answer() == Some(ANSWER)
}

fn answer() -> Option<u32> {
    let thermal = Thermal::new(SETTINGS).ok()?;
    let table = Table::new(thermal, -20.0, 60.0, &CELLS).ok()?;
    let tables = [table.with_plays(PLAY_GAINS).ok()?];
    let schedule = Schedule {
        sample_rate_hz: 0.375,
        samples_per_update: 3,
    };
    let mut stream = Stream::new(&tables, &schedule);
    let mut digest = CRC.digest();
    let mut temp_c = -30.0_f32;
    for number in 0..120_u8 {
        if number % 3 == 0 {
            // Up and down again, beyond both ends of the range, with a spike and a gap.
            temp_c += if number < 81 { 3.9 } else { -3.7 };
            let given_c = match number {
                30 => 140.0,
                60 => f32::NAN,
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
