//! `tempco simulate`: a log of a simulated unit.

use std::path::PathBuf;

use anyhow::Result;
use tempco_twin::{
    DEFAULT_RATE_HZ, PROFILES, Profile, Simulation, UNITS, Unit, write_log, write_log_and_truth,
};

use crate::Verdict;
use crate::apply::write_csv;
use crate::output::print;

/// Simulate a unit in a thermal chamber
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The unit
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(UNITS))]
    unit: String,
    /// The chamber programme
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(PROFILES))]
    profile: String,
    /// Seed of all noise; the same seed gives the same bytes
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Samples per second
    #[arg(long, value_name = "HZ", default_value_t = DEFAULT_RATE_HZ, allow_negative_numbers = true)]
    rate: f64,
    /// Where to write the log
    #[arg(long, value_name = "LOG.csv")]
    out: PathBuf,
    /// Where to write the true cavity temperatures and biases
    #[arg(long, value_name = "TRUTH.csv")]
    truth: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<Verdict> {
    let unit = Unit::named(&args.unit)?;
    let profile = Profile::named(&args.profile)?;
    let samples = Simulation::new(&unit, &profile, args.seed, args.rate)?;
    let mut log = Vec::new();
    let rows = match &args.truth {
        Some(path) => {
            let mut truth = Vec::new();
            let rows = write_log_and_truth(&mut log, &mut truth, samples)?;
            write_csv(path, &truth)?;
            rows
        }
        None => write_log(&mut log, samples)?,
    };
    write_csv(&args.out, &log)?;
    print(format_args!("{rows} rows; wrote {}", args.out.display()))?;
    Ok(Verdict::Acceptable)
}
