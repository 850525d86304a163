//! Log and truth files as CSV.

use std::io::{self, Write};

use crate::decimal::{push_decimal, push_integer, push_shortest};
use crate::output::Output;
use crate::simulation::{Sample, Simulation};
use crate::unit::{AXIS_NAMES, Unit};

const BUFFER_BYTES: usize = 1 << 16;

/// First line of a log: times in s, temperature in degC, and for each axis the pulses counted per
/// sample or the mean rate.
pub fn log_header(unit: &Unit) -> String {
    let column = match unit.output {
        Output::Pulses { .. } => "pulses",
        Output::Rate { .. } => unit.rate_unit.name(),
    };
    let axes = AXIS_NAMES.map(|axis| format!("{axis}_{column}"));
    format!("time_s,temp_c,{}", axes.join(","))
}

/// First line of a truth file: times in s, cavity temperatures in degC, biases in the rate unit, and
/// `flags`.
pub fn truth_header(unit: &Unit) -> String {
    let cavities = AXIS_NAMES.map(|axis| format!("cavity_{axis}_c"));
    let biases = AXIS_NAMES.map(|axis| format!("{axis}_bias_{}", unit.rate_unit.name()));
    format!("time_s,{},{},flags", cavities.join(","), biases.join(","))
}

/// Writes a log and returns its number of rows. No buffer is needed around `log`.
///
/// Times have as many digits as it takes to read the same number back; temperatures have 4
/// decimals, which hold every multiple of 0.0625 degC; rates have 6.
///
/// # Errors
///
/// The first error of `log`. What was written before it is not a whole log.
pub fn write_log(log: &mut impl Write, run: Simulation) -> io::Result<u64> {
    let mut log = Rows::new(log, &log_header(run.unit()));
    let output = run.unit().output;
    let mut rows = 0;
    for sample in run {
        log.row(|row| log_row(row, output, &sample))?;
        rows += 1;
    }
    log.finish()?;
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
    run: Simulation,
) -> io::Result<u64> {
    let mut log = Rows::new(log, &log_header(run.unit()));
    let mut truth = Rows::new(truth, &truth_header(run.unit()));
    let output = run.unit().output;
    let mut rows = 0;
    for sample in run {
        log.row(|row| log_row(row, output, &sample))?;
        truth.row(|row| truth_row(row, &sample))?;
        rows += 1;
    }
    log.finish()?;
    truth.finish()?;
    Ok(rows)
}

fn log_row(row: &mut Vec<u8>, output: Output, sample: &Sample) {
    push_shortest(row, sample.time_s);
    row.push(b',');
    push_decimal::<4>(row, sample.temp_c);
    for count in sample.counts {
        row.push(b',');
        match output {
            Output::Pulses { .. } => push_integer(row, count),
            Output::Rate { step, .. } => push_decimal::<6>(row, count as f64 * step),
        }
    }
    row.push(b'\n');
}

fn truth_row(row: &mut Vec<u8>, sample: &Sample) {
    let truth = &sample.truth;
    push_shortest(row, sample.time_s);
    for cavity_c in truth.cavity_c {
        row.push(b',');
        push_decimal::<6>(row, cavity_c);
    }
    for bias in truth.bias {
        row.push(b',');
        push_decimal::<9>(row, bias);
    }
    row.push(b',');
    truth.flags.push_to(row);
    row.push(b'\n');
}

/// Rows on their way to a file, some at a time.
struct Rows<'a, W: Write> {
    file: &'a mut W,
    buffer: Vec<u8>,
}

impl<'a, W: Write> Rows<'a, W> {
    fn new(file: &'a mut W, header: &str) -> Self {
        let mut buffer = Vec::with_capacity(2 * BUFFER_BYTES);
        buffer.extend_from_slice(header.as_bytes());
        buffer.push(b'\n');
        Self { file, buffer }
    }

    fn row(&mut self, push: impl FnOnce(&mut Vec<u8>)) -> io::Result<()> {
        push(&mut self.buffer);
        if self.buffer.len() < BUFFER_BYTES {
            return Ok(());
        }
        self.file.write_all(&self.buffer)?;
        self.buffer.clear();
        Ok(())
    }

    fn finish(self) -> io::Result<()> {
        self.file.write_all(&self.buffer)?;
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chamber::Profile;
    use crate::events::Flags;
    use crate::simulation::Truth;

    const SAMPLE: Sample = Sample {
        time_s: 72_000.5,
        temp_c: -0.0625,
        counts: [1, 0, -2],
        truth: Truth {
            cavity_c: [-15.0, 25.123_456_7, 80.0],
            bias: [0.017_3, -0.000_000_001_4, 0.0],
            flags: Flags::MOTION,
        },
    };

    fn run() -> Simulation {
        let unit = Unit::named("paper").unwrap();
        let profile = Profile::named("short").unwrap();
        Simulation::new(&unit, &profile, 1, 2.0).unwrap()
    }

    fn row(push: impl FnOnce(&mut Vec<u8>)) -> String {
        let mut row = Vec::new();
        push(&mut row);
        String::from_utf8(row).unwrap()
    }

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
        let pulses = Output::Pulses {
            scale_factor_arcsec: 1.0,
        };
        let rate = Output::Rate {
            step: 0.007_633_587_8,
            full_scale: 250.0,
        };
        let missing = Sample {
            time_s: 3.0,
            temp_c: f64::NAN,
            ..SAMPLE
        };
        assert_eq!(
            row(|out| log_row(out, pulses, &SAMPLE)),
            "72000.5,-0.0625,1,0,-2\n"
        );
        assert_eq!(
            row(|out| log_row(out, rate, &missing)),
            "3,NaN,0.007634,0.000000,-0.015267\n"
        );
        assert_eq!(
            row(|out| truth_row(out, &SAMPLE)),
            "72000.5,-15.000000,25.123457,80.000000,0.017300000,-0.000000001,0.000000000,motion\n"
        );
    }

    #[test]
    fn headers_say_the_unit() {
        let mems = Unit::named("mems").unwrap();
        assert_eq!(log_header(&mems), "time_s,temp_c,x_dps,y_dps,z_dps");
        assert_eq!(
            truth_header(&mems),
            "time_s,cavity_x_c,cavity_y_c,cavity_z_c,x_bias_dps,y_bias_dps,z_bias_dps,flags"
        );
        let ln100 = Unit::named("ln100").unwrap();
        assert_eq!(
            log_header(&ln100),
            "time_s,temp_c,x_pulses,y_pulses,z_pulses"
        );
        assert!(truth_header(&ln100).ends_with(",z_bias_dph,flags"));
    }

    #[test]
    fn both_ways_write_the_same_log() {
        let (mut alone, mut paired, mut truth) = (Vec::new(), Vec::new(), Vec::new());
        write_log(&mut alone, run()).unwrap();
        write_log_and_truth(&mut paired, &mut truth, run()).unwrap();
        assert_eq!(alone, paired);
    }

    #[test]
    fn a_full_disk_is_reported_even_when_only_the_last_bytes_are_missing() {
        let mut whole = Vec::new();
        write_log(&mut whole, run()).unwrap();
        assert!(write_log(&mut FullDisk(whole.len()), run()).is_ok());
        let error = write_log(&mut FullDisk(whole.len() - 1), run()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);

        let paired = write_log_and_truth(&mut Vec::new(), &mut FullDisk(10), run());
        assert_eq!(paired.unwrap_err().kind(), io::ErrorKind::StorageFull);
    }
}
