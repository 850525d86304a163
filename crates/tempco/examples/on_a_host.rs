//! The core on a computer: recorded samples are compensated after the fact, with a table that is
//! made at run time.
//!
//! Run it with `cargo run -p tempco --example on_a_host`; rows `time_s,temp_c,raw_dph` may be piped
//! in, as by `... --example on_a_host -- - < record.csv`.

use std::error::Error;
use std::io::{BufRead, stdin};

use tempco::{Compensator, Interval, Status, Table, Terms, Thermal, ThermalSettings};

/// A row of a record: time \[s\], temperature \[degC\], gyro \[deg/h\].
type Row = (f64, f32, f32);

/// A bias of 0.002 deg/h per degC about 0.1 deg/h at 20 degC, and 0.05 deg/h per degC/min, in cells of
/// 10 degC from -20 to 60 degC.
fn cells() -> Vec<[Terms; 1]> {
    let cell = |number: u8| {
        let cold_c = -20.0 + 10.0 * f32::from(number);
        [Terms::new(
            [0.1 + 0.002 * (cold_c - 20.0), 0.002 * 10.0, 0.0],
            [0.05, 0.0],
        )]
    };
    (0..8).map(cell).collect()
}

/// An hour at 20 degC, half an hour of 0.5 degC/min; one reading of the thermometer is missing.
fn record() -> Vec<Row> {
    let row = |s: u32| {
        let ramp_s = f64::from(s.saturating_sub(3600));
        let temp_c = (20.0 + 0.5 / 60.0 * ramp_s) as f32;
        let rate = if ramp_s > 0.0 { 0.5 } else { 0.0 };
        let raw = 0.1 + 0.002 * (temp_c - 20.0) + 0.05 * rate;
        (f64::from(s), if s == 4000 { f32::NAN } else { temp_c }, raw)
    };
    (0..5400).map(row).collect()
}

fn read() -> Result<Vec<Row>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for (number, line) in stdin().lock().lines().enumerate().skip(1) {
        let line = line?;
        let cells: Vec<&str> = line.split(',').collect();
        let [time, temp, raw] = cells[..] else {
            return Err(format!("line {}: expected time_s,temp_c,raw_dph", number + 1).into());
        };
        rows.push((time.parse()?, temp.parse()?, raw.parse()?));
    }
    Ok(rows)
}

fn main() -> Result<(), Box<dyn Error>> {
    let piped = std::env::args().nth(1).as_deref() == Some("-");
    let rows = if piped { read()? } else { record() };
    let (&(mut before_s, first_c, _), rows) = rows.split_first().ok_or("no rows")?;

    let thermal = Thermal::new(ThermalSettings::DEFAULT)?;
    let cells = cells();
    let table = Table::new(thermal, -20.0, 60.0, &cells)?;
    let mut unit = Compensator::new(&table);
    unit.start(first_c);

    let (mut squares_before, mut squares_after, mut flagged) = (0.0, 0.0, 0);
    for &(time_s, temp_c, raw) in rows {
        // The time between rows varies in a record, and so do the factors that follow from it.
        let interval = Interval::new(&thermal, (time_s - before_s) as f32);
        before_s = time_s;
        let out = unit.step(&interval, temp_c, [raw]);
        squares_before += f64::from(raw).powi(2);
        squares_after += f64::from(out.compensated[0]).powi(2);
        flagged += u32::from(out.status != Status::OK);
    }
    let rms = |squares: f64| (squares / rows.len() as f64).sqrt();
    println!(
        "{} rows: rms {:.4} deg/h before, {:.4} deg/h after; {flagged} rows with a flag, {} \
         temperatures rejected",
        rows.len(),
        rms(squares_before),
        rms(squares_after),
        unit.thermal_state().rejected()
    );
    if !piped {
        assert!(rms(squares_after) < 0.05 * rms(squares_before));
        assert_eq!(unit.thermal_state().rejected(), 1);
    }
    Ok(())
}
