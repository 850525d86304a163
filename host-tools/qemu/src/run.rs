//! Runs an image in QEMU.

use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use std::{fs, io};

use crate::install::checked;
use crate::log::Messages;
use crate::{Board, Error};

/// How an image is run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Options {
    /// Let virtual time pass by 1 ns per instruction, which makes instructions countable.
    pub icount: bool,
    /// How long the image may take by the host's clock.
    pub time_limit: Duration,
    /// The folder in which the image's relative paths are.
    pub folder: Option<PathBuf>,
    /// Write what is executed in these ranges of addresses to the console, an instruction a line. The
    /// addresses are found there again by [`Run::executed`].
    pub trace: Vec<Range<u64>>,
}

impl Default for Options {
    /// Time as it comes, one minute of it, in the current folder.
    fn default() -> Self {
        Self {
            icount: false,
            time_limit: Duration::from_secs(60),
            folder: None,
            trace: Vec::new(),
        }
    }
}

/// An image that ran to its end.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Run {
    /// What the image ended with; 0 says that all went well.
    pub exit_code: i32,
    /// What the image logged, a message each; nothing without the feature `messages`.
    pub log: Vec<String>,
    /// What the image wrote to semihosting's console, which is apart from the log.
    pub console: String,
}

impl Run {
    /// Whether the image says that all went well.
    pub const fn succeeded(&self) -> bool {
        self.exit_code == 0
    }

    /// The addresses of the instructions that were executed in [`Options::trace`], in their order.
    pub fn executed(&self) -> Vec<u64> {
        let mut executed = Vec::new();
        for line in self.console.lines() {
            // `Trace 0: 0x7f5de8000100 [00400000/00000a1c/00000110/ff000000] main`
            if line.starts_with("Trace ") {
                let address = line.split('/').nth(1);
                executed.extend(address.and_then(|word| u64::from_str_radix(word, 16).ok()));
            } else if line.starts_with("Stopped execution") {
                // It comes again.
                executed.pop();
            }
        }
        executed
    }
}

/// Runs an image on a board's machine until it exits through semihosting.
///
/// The image sees `args` as its command line, behind a program name, and the files of the host.
///
/// # Errors
/// It does not end within its time, QEMU refuses it or is killed, or its defmt strings are spoilt. An
/// exit code other than 0 is not an error of this function.
pub fn run(elf: &Path, board: Board, args: &[&str], options: &Options) -> Result<Run, Error> {
    let elf = elf.canonicalize().map_err(Error::file(elf))?;
    let messages = Messages::of(&elf, &fs::read(&elf).map_err(Error::file(&elf))?)?;

    let mut command = qemu(&elf, board, args, options);
    let mut child = command.spawn().map_err(|cause| Error::Start {
        program: "qemu-system-arm".to_owned(),
        cause,
    })?;
    let stdout = collect(child.stdout.take());
    let stderr = collect(child.stderr.take());
    let status = wait(&mut child, options.time_limit).map_err(Error::file(&elf))?;
    let stdout = stdout.join().unwrap_or_default();
    let log = messages.lines(&stdout);
    let stderr = String::from_utf8_lossy(&stderr.join().unwrap_or_default()).into_owned();

    let Some(status) = status else {
        return Err(Error::TimeLimit {
            limit: options.time_limit,
            log,
        });
    };
    match status.code() {
        None => Err(Error::Killed {
            status,
            stderr,
            log,
        }),
        // The images say something whatever happens, so this was not the image.
        Some(code) if code != 0 && stdout.is_empty() => Err(Error::Emulator { status, stderr }),
        Some(exit_code) => Ok(Run {
            exit_code,
            log,
            console: stderr,
        }),
    }
}

fn qemu(elf: &Path, board: Board, args: &[&str], options: &Options) -> Command {
    let mut semihosting = "enable=on,target=native,arg=tempco".to_owned();
    for arg in args {
        semihosting.push_str(",arg=");
        // A comma ends a value unless it is doubled.
        semihosting.push_str(&arg.replace(',', ",,"));
    }
    let mut command = Command::new("qemu-system-arm");
    command
        .args(["-machine", board.machine(), "-nographic"])
        .args(["-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", &semihosting, "-kernel"])
        .arg(elf)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    if options.icount {
        command.args(["-icount", "shift=0"]);
    }
    if let Some(folder) = &options.folder {
        command.current_dir(folder);
    }
    if !options.trace.is_empty() {
        let range = |range: &Range<u64>| format!("{:#x}..{:#x}", range.start, range.end - 1);
        let ranges: Vec<String> = options.trace.iter().map(range).collect();
        command.args(["-d", "exec,nochain", "-dfilter", &ranges.join(",")]);
        command.args(one_by_one());
    }
    command
}

/// What makes QEMU translate instructions one by one. It has another name since QEMU 8.1.
pub fn one_by_one() -> &'static [&'static str] {
    match version() {
        Some(version) if version < [8, 1] => &["-singlestep"],
        _ => &["-accel", "tcg,one-insn-per-tb=on"],
    }
}

/// QEMU's version: major and minor number.
fn version() -> Option<[u32; 2]> {
    let said = checked(Command::new("qemu-system-arm").arg("--version")).ok()?;
    let said = String::from_utf8(said.stdout).ok()?;
    let mut numbers = said.strip_prefix("QEMU emulator version ")?.split('.');
    let mut number = || numbers.next()?.parse().ok();
    Some([number()?, number()?])
}

/// Reads a pipe to its end, so that the child never waits for room in it.
fn collect(pipe: Option<impl Read + Send + 'static>) -> JoinHandle<Vec<u8>> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut pipe) = pipe {
            // What was read before an error is kept; the exit status says the rest.
            _ = pipe.read_to_end(&mut bytes);
        }
        bytes
    })
}

/// Waits for the end of the child; `None` if it had to be killed.
fn wait(child: &mut Child, limit: Duration) -> io::Result<Option<ExitStatus>> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if start.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            return Ok(None);
        }
        thread::sleep(Duration::from_millis(5));
    }
}
