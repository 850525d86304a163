//! Log and truth files as CSV.

use std::io::{self, BufWriter, Write};

use crate::decimal::Decimal;
use crate::simulation::Sample;

/// First line of a log: times in s, temperature in degC, pulses counted per sample.
pub const LOG_HEADER: &str = "time_s,temp_c,x_pulses,y_pulses,z_pulses";

/// First line of a truth file: times in s, cavity temperatures in degC, biases in pulses/s.
pub const TRUTH_HEADER: &str = "time_s,cavity_x_c,cavity_y_c,cavity_z_c,\
    x_bias_pulses_per_s,y_bias_pulses_per_s,z_bias_pulses_per_s";

const BUFFER_BYTES: usize = 1 << 16;

/// Writes a log and returns its number of rows. No buffer is needed around `log`.
///
/// Times have as many digits as it takes to read the same number back; temperatures have 4
/// decimals, which hold every multiple of 0.0625 degC.
///
/// # Errors
///
/// The first error of `log`. What was written before it is not a whole log.
pub fn write_log(
    log: &mut impl Write,
    samples: impl IntoIterator<Item = Sample>,
) -> io::Result<u64> {
    let mut log = BufWriter::with_capacity(BUFFER_BYTES, log);
    writeln!(log, "{LOG_HEADER}")?;
    let mut rows = 0;
    for sample in samples {
        log_row(&mut log, &sample)?;
        rows += 1;
    }
    log.flush()?;
    Ok(rows)
}

/// Writes a log as [`write_log`] does and, in the same pass, the truth row of each sample.
///
/// Cavity temperatures have 6 decimals (1 microdegree), biases 9.
///
/// # Errors
///
/// The first error of either file. What was written before it is not a whole file.
pub fn write_log_and_truth(
    log: &mut impl Write,
    truth: &mut impl Write,
    samples: impl IntoIterator<Item = Sample>,
) -> io::Result<u64> {
    let mut log = BufWriter::with_capacity(BUFFER_BYTES, log);
    let mut truth = BufWriter::with_capacity(BUFFER_BYTES, truth);
    writeln!(log, "{LOG_HEADER}")?;
    writeln!(truth, "{TRUTH_HEADER}")?;
    let mut rows = 0;
    for sample in samples {
        log_row(&mut log, &sample)?;
        truth_row(&mut truth, &sample)?;
        rows += 1;
    }
    log.flush()?;
    truth.flush()?;
    Ok(rows)
}

fn log_row(log: &mut impl Write, sample: &Sample) -> io::Result<()> {
    let time_s = sample.time_s;
    let temp_c = Decimal::<4>(sample.temp_c);
    let [x, y, z] = sample.pulses;
    writeln!(log, "{time_s},{temp_c},{x},{y},{z}")
}

fn truth_row(truth: &mut impl Write, sample: &Sample) -> io::Result<()> {
    let time_s = sample.time_s;
    let [cx, cy, cz] = sample.truth.cavity_c.map(Decimal::<6>);
    let [bx, by, bz] = sample.truth.bias_pulses_per_s.map(Decimal::<9>);
    writeln!(truth, "{time_s},{cx},{cy},{cz},{bx},{by},{bz}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::Truth;

    const SAMPLE: Sample = Sample {
        time_s: 72_000.5,
        temp_c: -0.0625,
        pulses: [1, 0, -2],
        truth: Truth {
            cavity_c: [-15.0, 25.123_456_7, 80.0],
            bias_pulses_per_s: [0.017_3, -0.000_000_001_4, 0.0],
        },
    };

    /// Takes a number of bytes, then fails.
    struct FullDisk(usize);

    impl Write for FullDisk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if self.0 < bytes.len() {
                return Err(io::ErrorKind::StorageFull.into());
            }
            self.0 -= bytes.len();
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn rows_have_the_documented_decimals() {
        let whole_second = Sample {
            time_s: 3.0,
            ..SAMPLE
        };
        let (mut log, mut truth) = (Vec::new(), Vec::new());
        let rows = write_log_and_truth(&mut log, &mut truth, [SAMPLE, whole_second]).unwrap();
        assert_eq!(rows, 2);
        assert_eq!(
            String::from_utf8(log).unwrap(),
            "time_s,temp_c,x_pulses,y_pulses,z_pulses\n\
             72000.5,-0.0625,1,0,-2\n\
             3,-0.0625,1,0,-2\n"
        );
        assert_eq!(
            String::from_utf8(truth).unwrap(),
            "time_s,cavity_x_c,cavity_y_c,cavity_z_c,\
             x_bias_pulses_per_s,y_bias_pulses_per_s,z_bias_pulses_per_s\n\
             72000.5,-15.000000,25.123457,80.000000,0.017300000,-0.000000001,0.000000000\n\
             3,-15.000000,25.123457,80.000000,0.017300000,-0.000000001,0.000000000\n"
        );
    }

    #[test]
    fn both_ways_write_the_same_log() {
        let (mut alone, mut paired, mut truth) = (Vec::new(), Vec::new(), Vec::new());
        write_log(&mut alone, [SAMPLE; 3]).unwrap();
        write_log_and_truth(&mut paired, &mut truth, [SAMPLE; 3]).unwrap();
        assert_eq!(alone, paired);
    }

    #[test]
    fn a_full_disk_is_reported_even_when_only_the_last_bytes_are_missing() {
        let mut whole = Vec::new();
        write_log(&mut whole, [SAMPLE; 3]).unwrap();
        assert!(write_log(&mut FullDisk(whole.len()), [SAMPLE; 3]).is_ok());
        let error = write_log(&mut FullDisk(whole.len() - 1), [SAMPLE; 3]).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);

        let paired = write_log_and_truth(&mut Vec::new(), &mut FullDisk(10), [SAMPLE; 3]);
        assert_eq!(paired.unwrap_err().kind(), io::ErrorKind::StorageFull);
    }
}
