//! `tempco simulate`: a log of a simulated unit.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tempco_twin::{
    DEFAULT_RATE_HZ, PROFILES, Profile, Simulation, UNITS, Unit, write_log, write_log_and_truth,
};

use crate::Verdict;
use crate::output::print;

/// Simulate a unit in a thermal chamber
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The unit: a name of --list, or a TOML file
    #[arg(long, value_name = "NAME|FILE.toml", required_unless_present_any = ["list", "show"])]
    unit: Option<String>,
    /// The chamber programme: a name of --list, or a TOML file
    #[arg(long, value_name = "NAME|FILE.toml", required_unless_present_any = ["list", "show"])]
    profile: Option<String>,
    /// Seed of all noise; the same seed gives the same bytes
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Samples per second, 0.01 to 10000
    #[arg(long, value_name = "HZ", default_value_t = DEFAULT_RATE_HZ, allow_negative_numbers = true)]
    rate: f64,
    /// Where to write the log
    #[arg(long, value_name = "LOG.csv", required_unless_present_any = ["list", "show"])]
    out: Option<PathBuf>,
    /// Where to write the true cavity temperatures, biases and events
    #[arg(long, value_name = "TRUTH.csv")]
    truth: Option<PathBuf>,
    /// List the units and programmes that have a name
    #[arg(long, exclusive = true)]
    list: bool,
    /// Print the TOML of a named unit or programme, to start a file of your own from
    #[arg(long, value_name = "NAME", exclusive = true)]
    show: Option<String>,
}

pub(crate) fn run(args: &Args) -> Result<Verdict> {
    match (&args.unit, &args.profile, &args.out, &args.show) {
        (_, _, _, Some(name)) => print(source(name)?.trim_end())?,
        (Some(unit), Some(profile), Some(out), None) => simulate(args, unit, profile, out)?,
        _ => list()?,
    }
    Ok(Verdict::Acceptable)
}

fn list() -> Result<()> {
    print("units")?;
    for name in UNITS {
        print(format_args!(
            "  {name:12}  {}",
            Unit::named(name)?.description
        ))?;
    }
    print("programmes")?;
    for name in PROFILES {
        let profile = Profile::named(name)?;
        print(format_args!(
            "  {name:12}  {}",
            profile.programme().description
        ))?;
    }
    Ok(())
}

fn source(name: &str) -> Result<&'static str> {
    Unit::source(name)
        .or_else(|_| Profile::source(name))
        .with_context(|| {
            format!("`{name}` is neither a named unit nor a named programme (--list shows them)")
        })
}

/// Whether an argument is the name of a file: named units have no dots.
fn is_file(argument: &str) -> bool {
    argument.contains(['.', '/', '\\'])
}

fn simulate(args: &Args, unit: &str, profile: &str, out: &Path) -> Result<()> {
    let unit = match unit {
        file if is_file(file) => Unit::read(Path::new(file))?,
        name => Unit::named(name)?,
    };
    let profile = match profile {
        file if is_file(file) => Profile::read(Path::new(file))?,
        name => Profile::named(name)?,
    };
    let run = Simulation::new(&unit, &profile, args.seed, args.rate)?;
    let mut log = Partial::create(out)?;
    let rows = match &args.truth {
        Some(path) => {
            ensure!(path != out, "--out and --truth: expected two files");
            let mut truth = Partial::create(path)?;
            let rows = write_log_and_truth(&mut log.file, &mut truth.file, run)
                .with_context(|| out.display().to_string())?;
            truth.keep()?;
            rows
        }
        None => write_log(&mut log.file, run).with_context(|| out.display().to_string())?,
    };
    log.keep()?;
    print(format_args!("{rows} rows; wrote {}", out.display()))
}

/// A file that gets its name once it is whole. Logs are too long to be kept in memory.
struct Partial {
    file: File,
    /// What it is called until then; `None` for what is no file, a pipe or a device.
    partial: Option<PathBuf>,
    whole: PathBuf,
}

impl Partial {
    fn create(whole: &Path) -> Result<Self> {
        let context = || whole.display().to_string();
        let partial = if whole.exists() && !whole.is_file() {
            None
        } else {
            let name = whole.file_name();
            let name =
                name.with_context(|| format!("{}: expected the name of a file", context()))?;
            let mut partial = name.to_owned();
            partial.push(".partial");
            Some(whole.with_file_name(partial))
        };
        if let Some(folder) = whole.parent() {
            fs::create_dir_all(folder).with_context(context)?;
        }
        let file = File::create(partial.as_deref().unwrap_or(whole)).with_context(context)?;
        Ok(Self {
            file,
            partial,
            whole: whole.to_owned(),
        })
    }

    fn keep(mut self) -> Result<()> {
        match self.partial.take() {
            Some(partial) => {
                fs::rename(partial, &self.whole).with_context(|| self.whole.display().to_string())
            }
            None => Ok(()),
        }
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        if let Some(partial) = &self.partial {
            // What is left of a failure is of no use; nothing can be done if it stays.
            let _ = fs::remove_file(partial);
        }
    }
}
