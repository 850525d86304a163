//! `tempco simulate`: the log of a simulated unit.

use std::fs::File;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tempco_set::files::{Draft, keep_all};
use tempco_twin::{
    DEFAULT_RATE_HZ, PROFILES, Profile, Simulation, UNITS, Unit, write_log, write_log_and_truth,
};

use crate::Exit;
use crate::output::{print, print_lines};

/// Write the log of a simulated unit in a thermal chamber
#[derive(clap::Args)]
#[command(
    after_help = "Example: tempco simulate --unit paper --profile calibration --out chamber.csv"
)]
pub(crate) struct Args {
    /// The unit: a name from --list, or a TOML file
    #[arg(long, value_name = "NAME|FILE.toml", required_unless_present_any = ["list", "show"])]
    unit: Option<String>,
    /// The chamber profile: a name from --list, or a TOML file
    #[arg(long, value_name = "NAME|FILE.toml", required_unless_present_any = ["list", "show"])]
    profile: Option<String>,
    /// Simulate another unit of this kind: time constants, curves and sensitivities drawn from a seed
    #[arg(long, value_name = "SEED")]
    draw: Option<u64>,
    /// Seed of all noise; the same seed gives the same bytes
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Samples per second, 0.01 to 10000
    #[arg(long, value_name = "HZ", default_value_t = DEFAULT_RATE_HZ, allow_negative_numbers = true)]
    rate: f64,
    /// Where to write the log
    #[arg(long, value_name = "LOG.csv", required_unless_present_any = ["list", "show"])]
    out: Option<PathBuf>,
    /// Where to write the true temperatures of the cavities, biases and events
    #[arg(long, value_name = "TRUTH.csv")]
    truth: Option<PathBuf>,
    /// List the named units and profiles
    #[arg(long, exclusive = true)]
    list: bool,
    /// Print a named unit or profile as TOML, as a start for your own
    #[arg(long, value_name = "NAME", exclusive = true)]
    show: Option<String>,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    match (&args.unit, &args.profile, &args.out, &args.show) {
        (_, _, _, Some(name)) => print_lines(source(name)?.trim_end())?,
        (Some(unit), Some(profile), Some(out), None) => simulate(args, unit, profile, out)?,
        _ => list()?,
    }
    Ok(Exit::Acceptable)
}

fn list() -> Result<()> {
    print("units")?;
    for name in UNITS {
        print(format_args!(
            "  {name:14}  {}",
            Unit::named(name)?.description
        ))?;
    }
    print("profiles")?;
    for name in PROFILES {
        let profile = Profile::named(name)?;
        print(format_args!("  {name:14}  {}", profile.parts().description))?;
    }
    Ok(())
}

fn source(name: &str) -> Result<&'static str> {
    Unit::source(name)
        .or_else(|_| Profile::source(name))
        .with_context(|| {
            format!("`{name}` is neither a named unit nor a named profile (--list shows them)")
        })
}

/// Whether an argument is the name of a file: a named unit has no dot.
fn is_file(argument: &str) -> bool {
    argument.contains(['.', '/', '\\'])
}

/// The unit that an argument names.
pub(crate) fn unit(argument: &str) -> Result<Unit> {
    Ok(match argument {
        file if is_file(file) => Unit::read(Path::new(file))?,
        name => Unit::named(name)?,
    })
}

/// The profile that an argument names.
pub(crate) fn profile(argument: &str) -> Result<Profile> {
    Ok(match argument {
        file if is_file(file) => Profile::read(Path::new(file))?,
        name => Profile::named(name)?,
    })
}

fn simulate(args: &Args, unit: &str, profile: &str, out: &Path) -> Result<()> {
    let unit = self::unit(unit)?;
    let unit = match args.draw {
        Some(seed) => unit.redrawn(seed),
        None => unit,
    };
    let profile = self::profile(profile)?;
    let run = Simulation::new(&unit, &profile, args.seed, args.rate)?;
    let mut log = Sink::create(out)?;
    let mut truth = None;
    let rows = match &args.truth {
        Some(path) => {
            ensure!(path != out, "--out and --truth: expected two files");
            let truth = truth.insert(Sink::create(path)?);
            write_log_and_truth(log.file(), truth.file(), run)
        }
        None => write_log(log.file(), run),
    };
    let rows = rows.with_context(|| out.display().to_string())?;
    let sinks = truth.into_iter().chain([log]);
    keep_all(sinks.filter_map(Sink::into_draft).collect())?;
    print(format_args!("{rows} rows; wrote {}", out.display()))
}

/// Where a log goes. Logs are too long to be kept in memory.
enum Sink {
    Draft(Draft),
    /// A pipe or a device.
    Open(File),
}

impl Sink {
    fn create(path: &Path) -> Result<Self> {
        if path.exists() && !path.is_file() {
            let open = File::create(path).with_context(|| path.display().to_string());
            Ok(Self::Open(open?))
        } else {
            Ok(Self::Draft(Draft::create(path)?))
        }
    }

    fn file(&mut self) -> &mut File {
        match self {
            Self::Draft(draft) => draft.file(),
            Self::Open(file) => file,
        }
    }

    fn into_draft(self) -> Option<Draft> {
        match self {
            Self::Draft(draft) => Some(draft),
            Self::Open(_) => None,
        }
    }
}
