//! Rows per second of every named unit: generated only, and with its log and truth file written to
//! memory. Build with `--release`.

use std::time::Instant;

use tempco_twin::{Profile, Simulation, UNITS, Unit, write_log, write_log_and_truth};

const RATE_HZ: f64 = 64.0;

/// Fastest of three, rows per second.
fn rows_per_s(work: impl Fn() -> u64) -> f64 {
    (0..3).fold(0.0, |fastest: f64, _| {
        let start = Instant::now();
        let rows = work();
        fastest.max(rows as f64 / start.elapsed().as_secs_f64())
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let profile = Profile::named("short")?;
    println!(
        "{:>12} {:>12} {:>12} {:>12}",
        "", "generated", "log", "log + truth"
    );
    for name in UNITS {
        let unit = Unit::named(name)?;
        let run = || Simulation::new(&unit, &profile, 1, RATE_HZ).expect("a valid unit");
        let generated = rows_per_s(|| {
            run()
                .map(|sample| (sample.counts[0] < 1_000_000) as u64)
                .sum()
        });
        let log = rows_per_s(|| write_log(&mut Vec::new(), run()).expect("memory"));
        let both = rows_per_s(|| {
            write_log_and_truth(&mut Vec::new(), &mut Vec::new(), run()).expect("memory")
        });
        println!("{name:>12} {generated:>12.0} {log:>12.0} {both:>12.0}");
    }
    Ok(())
}
