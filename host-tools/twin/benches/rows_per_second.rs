//! Rows per second of every named unit at three rates: generated only, and with its log, and its truth
//! file as well, written to memory. Run it with `cargo bench -p tempco-twin`.

use std::time::Instant;

use tempco_twin::{Profile, Simulation, Step, UNITS, Unit, write_log, write_log_and_truth};

const ROWS: f64 = 400_000.0;

/// Fastest of five, in million rows per second.
fn speed(work: impl Fn() -> u64) -> f64 {
    (0..5).fold(0.0, |fastest: f64, _| {
        let start = Instant::now();
        let rows = work();
        fastest.max(rows as f64 / start.elapsed().as_secs_f64() / 1e6)
    })
}

/// Half of the rows at 20 degC, then up to 60 degC or as far as it goes.
fn profile(rate_hz: f64) -> Result<Profile, tempco_twin::Invalid> {
    let half_min = 0.5 * ROWS / rate_hz / 60.0;
    let soak = Step::Soak {
        air_c: 20.0,
        duration_min: half_min,
    };
    let ramp = Step::Ramp {
        to_c: 20.0 + 40.0_f64.min(2.0 * half_min),
        rate_c_per_min: 40.0_f64.min(2.0 * half_min) / half_min,
    };
    Profile::new("speed", 20.0, &[soak, ramp])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("| unit | rate \\[Hz\\] | generated only | with log | with log and truth |");
    println!("| --- | --- | --- | --- | --- |");
    for name in UNITS {
        let unit = Unit::named(name)?;
        for rate_hz in [2.0, 64.0, 1000.0] {
            let profile = profile(rate_hz)?;
            let run = || Simulation::new(&unit, &profile, 1, rate_hz).expect("a valid unit");
            let generated = speed(|| {
                let plausible = |sample: tempco_twin::Sample| sample.counts[0] < 1 << 40;
                run().map(|sample| u64::from(plausible(sample))).sum()
            });
            let log = speed(|| write_log(&mut Vec::new(), run()).expect("memory"));
            let both = speed(|| {
                write_log_and_truth(&mut Vec::new(), &mut Vec::new(), run()).expect("memory")
            });
            println!("| `{name}` | {rate_hz} | {generated:.1} | {log:.1} | {both:.1} |");
        }
    }
    Ok(())
}
