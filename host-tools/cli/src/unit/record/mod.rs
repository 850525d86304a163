//! `tempco record`: the log of a unit, as long as it takes.

mod rows;
mod timeline;

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Error, Result, ensure};
use tempco_hil::{Identity, Unit};
use tempco_link::Telemetry;

use self::rows::Rows;
use self::timeline::{Gap, Timeline};
use crate::Exit;
use crate::output::{figure, print, say};
use crate::progress::Progress;
use crate::unit::port_args::{PortArgs, check_period};

/// Time beyond the period without a message, after which the unit is asked again.
const SILENCE: Duration = Duration::from_secs(2);

/// Time since power-on within which a unit may have no temperature yet \[ms\].
const WARM_UP_MS: u32 = 3000;

/// Time between two attempts to reach a unit whose line was lost.
const RETRY: Duration = Duration::from_millis(500);

/// Record a log from a unit
///
/// A row per message: time since power-on, temperatures, means of the gyro samples since the row
/// before, and flags. `tempco fit` takes the file as it is.
///
/// Every row is in the file as soon as it has come. A lost line is waited for. A row after missing
/// ones says why in its column `gap`: `lost` messages, a `line` that was away, a `reset`, or
/// `invalid` samples. A file that exists is not written to.
#[derive(clap::Args)]
#[command(after_help = "Example: tempco record --port /dev/ttyUSB0 --out chamber.csv")]
pub(crate) struct Args {
    #[command(flatten)]
    port: PortArgs,
    /// Where to write the log
    #[arg(long, value_name = "LOG.csv")]
    out: PathBuf,
    /// Time between rows, in ms. The default is how often a unit reads its thermometers
    #[arg(long, value_name = "MS", default_value_t = 100)]
    period: u32,
    /// End after this time of the unit, in s. Without, Ctrl-C ends it
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    duration: Option<f64>,
}

pub(crate) fn run(args: &Args) -> Result<Exit> {
    check_period(args.period)?;
    if let Some(duration_s) = args.duration {
        ensure!(
            duration_s > 0.0 && duration_s < 1e9,
            "--duration {duration_s}: expected seconds, above 0 and below 1e9"
        );
    }
    let unit = args.port.connect()?;
    let mut recorder = Recorder::new(args, unit)?;
    let result = recorder.record();
    // Whatever ended it, what has come is kept.
    let summary = recorder.finish();
    let is_whole = result?;
    summary?;
    if !is_whole {
        say!("the line was away when the time was over: the log is short");
    }
    Ok(Exit::of(is_whole))
}

/// A log under way.
struct Recorder<'a> {
    args: &'a Args,
    unit: Unit,
    identity: Identity,
    file: File,
    rows: Rows,
    timeline: Timeline,
    progress: Progress,
    /// When the last row came.
    heard: Instant,
}

impl<'a> Recorder<'a> {
    fn new(args: &'a Args, mut unit: Unit) -> Result<Self> {
        let identity = unit.identify()?;
        let rows = Rows::new(&identity);
        let mut file = create(&args.out)?;
        file.write_all(rows.header().as_bytes())
            .with_context(|| args.out.display().to_string())?;
        Ok(Self {
            args,
            unit,
            identity,
            file,
            rows,
            timeline: Timeline::default(),
            progress: Progress::over_recording(args.duration),
            heard: Instant::now(),
        })
    }

    /// Records to the end; whether the line was there then.
    fn record(&mut self) -> Result<bool> {
        self.ask();
        loop {
            match self.next() {
                Ok(telemetry) => {
                    self.take(&telemetry)?;
                    self.heard = Instant::now();
                    if self.is_over(0.0) {
                        // It would go on sending. A failure changes nothing in the log.
                        _ = self.unit.telemetry(0);
                        return Ok(true);
                    }
                }
                Err(error) => {
                    if !self.reach_again(&error)? {
                        return Ok(false);
                    }
                }
            }
        }
    }

    /// Lets the unit send a message every period. The first one is not a row: its means are of all
    /// samples since some earlier message.
    fn ask(&mut self) {
        // A failure shows as silence.
        _ = self.unit.telemetry(self.args.period);
    }

    /// The next message. A unit that is silent is asked again once.
    fn next(&mut self) -> Result<Telemetry, tempco_hil::Error> {
        let timeout = Duration::from_millis(self.args.period.into()) + SILENCE;
        if let Some(telemetry) = self.unit.wait_telemetry(timeout)? {
            return Ok(telemetry);
        }
        self.unit.telemetry(self.args.period)?;
        self.timeline.mark(Gap::Line);
        let telemetry = self.unit.wait_telemetry(timeout)?;
        telemetry.ok_or(tempco_hil::Error::Silent { waited: timeout })
    }

    /// Writes a row.
    fn take(&mut self, telemetry: &Telemetry) -> Result<()> {
        let has_all = telemetry.temps_c.iter().all(|temp_c| temp_c.is_finite());
        if !has_all && telemetry.uptime_ms < WARM_UP_MS {
            // The thermometers have not been read yet.
            return Ok(());
        }
        if !telemetry.raw.iter().all(|raw| raw.is_finite()) {
            self.timeline.mark(Gap::Invalid);
            return Ok(());
        }
        let since = self.heard.elapsed();
        let (time_ms, gap) = self.timeline.take(telemetry, since);
        let row = self.rows.row(time_ms, telemetry, gap);
        // In one piece, so that a row is in the file as a whole or not at all.
        self.file
            .write_all(row.as_bytes())
            .with_context(|| self.args.out.display().to_string())?;
        self.progress.at(self.timeline.duration_s() as u64);
        Ok(())
    }

    /// Whether the time is over, some time after the last row \[s\].
    fn is_over(&self, later_s: f64) -> bool {
        let so_far_s = self.timeline.duration_s() + later_s;
        self.args
            .duration
            .is_some_and(|limit_s| so_far_s >= limit_s)
    }

    /// Waits for a unit that was lost. Whether it is back before the time is over.
    fn reach_again(&mut self, error: &tempco_hil::Error) -> Result<bool> {
        say!(
            "{}: {error}; waiting for the unit",
            self.args.port.port.display()
        );
        self.timeline.mark(Gap::Line);
        while !self.is_over(self.heard.elapsed().as_secs_f64()) {
            thread::sleep(RETRY);
            let Ok(mut unit) = self.args.port.connect() else {
                continue;
            };
            let Ok(identity) = unit.identify() else {
                continue;
            };
            ensure!(
                identity.serial == self.identity.serial && identity.fits == self.identity.fits,
                "{}: unit {} in place of unit {}: expected the same one",
                self.args.port.port.display(),
                identity.serial,
                self.identity.serial
            );
            say!("unit {} is back", identity.serial);
            self.unit = unit;
            self.ask();
            return Ok(true);
        }
        Ok(false)
    }

    /// Sees to it that the file is on the disk, and says what is in it.
    fn finish(&self) -> Result<()> {
        let out = self.args.out.display();
        self.file.sync_all().with_context(|| out.to_string())?;
        let (from_c, to_c) = self.rows.range_c();
        print(format_args!(
            "unit {}: {} rows, {} s, {} to {} degC, {} gaps; wrote {out}",
            self.identity.serial,
            self.rows.count(),
            figure(self.timeline.duration_s()),
            figure(from_c.into()),
            figure(to_c.into()),
            self.timeline.gaps()
        ))
    }
}

/// A new file: recordings take a night, and none is overwritten.
fn create(path: &Path) -> Result<File> {
    File::create_new(path).map_err(|error| {
        if error.kind() == ErrorKind::AlreadyExists {
            Error::msg(format!(
                "--out {}: it exists: expected the name of a new file",
                path.display()
            ))
        } else {
            Error::new(error).context(path.display().to_string())
        }
    })
}
