//! What the tests share: the `tempco` command as a user runs it, and the real logs next to the
//! project.
#![forbid(unsafe_code)]

pub mod autopilot;
pub mod browser;
pub mod history;
pub mod ln100;
pub mod page;
#[cfg(unix)]
pub mod rig;

use std::fs::File;
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::thread;
use std::time::{Duration, Instant};

use tempco_qemu::Workspace;

/// The Rust in the README is compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

/// So is the Rust in the quick start.
#[cfg(doctest)]
#[doc = include_str!("../../docs/quick-start.md")]
pub struct QuickStart;

/// The segments of the paper, in degC.
pub const PAPER_SEGMENTS: &str = "-15:15,5:35,25:60,50:80";

/// Table 2 of the paper as printed, a2 in units of 1e-5.
pub const PAPER_TABLE_2: &str = "\
gyro,segment,temp_min_c,temp_max_c,a0_pulses,a1_pulses_per_c,a2_1e-5_pulses_per_c2
X,1,-15,15,0.0173,-0.0014,1.7535
X,2,5,35,0.0064,0.0004,-4.2567
X,3,25,60,-0.0551,0.0026,-3.302
X,4,50,80,0.3390,-0.0118,9.6146
Z,1,-15,15,0.0167,0.0004,-2.0700
Z,2,5,35,0.0036,-0.0009,3.9374
Z,3,25,60,0.0635,-0.0042,6.5480
Z,4,50,80,-0.0974,0.0032,-2.7658
";

/// The rows of the X gyro in [`PAPER_TABLE_2`], whose segments agree.
pub fn paper_table_2_of_x() -> String {
    let lines = PAPER_TABLE_2.lines().filter(|line| !line.starts_with('Z'));
    lines.map(|line| format!("{line}\n")).collect()
}

/// The root of the workspace.
///
/// # Panics
/// If the sources are gone.
pub fn root() -> PathBuf {
    let workspace = Workspace::find().expect("the sources");
    workspace.root().to_owned()
}

/// Path of the `tempco` command, built once.
///
/// # Panics
/// If it does not build.
pub fn tempco_path() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| built().join("tempco"))
}

/// The `tempco` command under test: the one at the path in `TEMPCO_COMMAND`, run by the program in
/// `TEMPCO_RUNNER` if there is one, such as a build for Windows by wine. Else [`tempco_path`].
pub fn tempco() -> Command {
    let Some(path) = std::env::var_os("TEMPCO_COMMAND") else {
        return Command::new(tempco_path());
    };
    let Some(runner) = std::env::var_os("TEMPCO_RUNNER") else {
        return Command::new(path);
    };
    let mut command = Command::new(runner);
    command.arg(path);
    command
}

/// Path of an example of any package.
///
/// # Panics
/// If the examples do not build.
pub fn example_path(name: &str) -> PathBuf {
    built().join("examples").join(name)
}

/// The folder of what was built: the command and all examples, in one build of the workspace, for
/// which the tests have built the libraries.
fn built() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let built = Command::new(cargo)
            .current_dir(root())
            .args(["build", "--quiet", "--locked", "--workspace"])
            .args(["--bin", "tempco", "--examples"])
            .status()
            .expect("cargo");
        assert!(built.success(), "command and examples do not build");
        // target/PROFILE/deps/this-test
        let test = std::env::current_exe().expect("the path of this test");
        test.ancestors().nth(2).expect("target folder").to_owned()
    })
}

/// A folder in which `tempco` is run; removed at the end.
pub struct Bench {
    folder: tempfile::TempDir,
}

/// What a run of `tempco` printed and how it ended.
pub struct Ran {
    /// Exit code.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Default for Bench {
    fn default() -> Self {
        Self::new()
    }
}

impl Bench {
    /// An empty folder.
    ///
    /// # Panics
    /// If it cannot be made.
    pub fn new() -> Self {
        Self {
            folder: tempfile::tempdir().expect("a folder for the test"),
        }
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file.
    ///
    /// # Panics
    /// If it cannot be written.
    pub fn write(&self, name: &str, contents: &str) {
        let path = self.path(name);
        let folder = path.parent().expect("a folder");
        std::fs::create_dir_all(folder).expect("a folder for the test");
        std::fs::write(path, contents).expect("a file for the test");
    }

    /// Runs `tempco` in the folder with arguments separated by blanks.
    ///
    /// # Panics
    /// If it cannot be started or is killed.
    pub fn run(&self, args: &str) -> Ran {
        let output: Output = self.command(args).output().expect("the `tempco` command");
        Ran {
            code: output.status.code().expect("an exit code"),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// Runs `tempco` as [`run`](Self::run) does where it might never end.
    ///
    /// # Panics
    /// If it cannot be started, or does not end by itself in two minutes.
    pub fn run_to_its_end(&self, args: &str) -> Ran {
        let files = || tempfile::tempfile().expect("a file for the output");
        let (mut out, mut err) = (files(), files());
        let of = |file: &File| Stdio::from(file.try_clone().expect("the same file"));
        let mut command = self.command(args);
        command
            .stdin(Stdio::null())
            .stdout(of(&out))
            .stderr(of(&err));
        let mut child = command.spawn().expect("the `tempco` command");
        let started = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().expect("a child") {
                break status;
            }
            if started.elapsed() > Duration::from_secs(120) {
                child.kill().expect("a child that runs");
                panic!("tempco {args}: does not end");
            }
            thread::sleep(Duration::from_millis(2));
        };
        let text = |file: &mut File| {
            let mut text = String::new();
            file.rewind().expect("the output");
            file.read_to_string(&mut text).expect("the output");
            text
        };
        Ran {
            code: status.code().expect("an exit code"),
            out: text(&mut out),
            err: text(&mut err),
        }
    }

    fn command(&self, args: &str) -> Command {
        let mut command = tempco();
        command
            .current_dir(self.folder.path())
            .args(args.split_whitespace());
        command
    }

    /// Runs `tempco` and expects exit code 0; returns the output.
    ///
    /// # Panics
    /// If it ends otherwise.
    pub fn ok(&self, args: &str) -> String {
        let ran = self.run(args);
        assert_eq!(ran.code, 0, "tempco {args}\n{}{}", ran.out, ran.err);
        ran.out
    }

    /// Names in the folder, sorted.
    ///
    /// # Panics
    /// If it cannot be read.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).expect("the folder");
        let mut names: Vec<String> = entries
            .map(|entry| entry.expect("an entry").file_name())
            .map(|name| name.to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

/// A file of the folder `shared` next to the project; `None`, with a printed reason, where it is
/// absent.
pub fn shared(name: &str) -> Option<PathBuf> {
    let path = root().parent()?.join("shared").join(name);
    if path.is_file() {
        Some(path)
    } else {
        println!("skipped: {} is not there", path.display());
        None
    }
}
