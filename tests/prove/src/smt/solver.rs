//! Two independent solvers, each with a time limit.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};

/// The small program that runs a solver's Python package.
const DRIVER: &str = include_str!("solve.py");

/// What a solver found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// There is an assignment.
    Satisfiable,
    /// There is none.
    Unsatisfiable,
    /// Not decided in the time given.
    Unknown,
}

/// A verdict, how long it took, and the assignment if there is one.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The verdict.
    pub verdict: Verdict,
    /// Time taken \[s\].
    pub seconds: f64,
    /// The values of the inputs, one to a line.
    pub model: String,
}

/// A solver in a Python environment.
#[derive(Clone, Debug)]
pub struct Solver {
    /// `bitwuzla` or `cvc5`.
    pub name: &'static str,
    python: PathBuf,
    driver: PathBuf,
}

impl Solver {
    /// Both solvers, installed with pip into an environment in `folder` unless they are there.
    ///
    /// # Errors
    /// There is no Python, or the packages cannot be had.
    pub fn both(folder: &Path) -> Result<[Self; 2]> {
        fs::create_dir_all(folder)?;
        let python = folder.join("venv/bin/python");
        let usable = || {
            let mut command = Command::new(&python);
            command.args(["-c", "import bitwuzla, cvc5"]);
            command.output().is_ok_and(|output| output.status.success())
        };
        if !usable() {
            eprintln!("installing the solvers: pip install bitwuzla==0.9.1 cvc5==1.4.2");
            let make = Command::new("python3")
                .args(["-m", "venv"])
                .arg(folder.join("venv"))
                .output()
                .context("python3 is missing")?;
            ensure!(
                make.status.success(),
                "python3 -m venv failed (python3-venv)"
            );
            let pip = Command::new(&python)
                .args(["-m", "pip", "install", "--quiet"])
                .args(["bitwuzla==0.9.1", "cvc5==1.4.2"])
                .output()?;
            let words = String::from_utf8_lossy(&pip.stderr);
            ensure!(pip.status.success() && usable(), "pip failed: {words}");
        }
        let driver = folder.join("solve.py");
        fs::write(&driver, DRIVER)?;
        Ok(["bitwuzla", "cvc5"].map(|name| Self {
            name,
            python: python.clone(),
            driver: driver.clone(),
        }))
    }

    /// Starts the solver on a file.
    fn start(&self, file: &Path, limit_s: f64) -> Result<Child> {
        Command::new(&self.python)
            .arg(&self.driver)
            .arg(self.name)
            .arg(file)
            .arg(limit_s.to_string())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .with_context(|| format!("{} does not start", self.name))
    }

    /// Decides the query in `file`; ended from outside where it overruns its own limit.
    ///
    /// # Errors
    /// The solver refused the query.
    pub fn check(&self, file: &Path, limit_s: f64) -> Result<Answer> {
        let start = Instant::now();
        let mut child = self.start(file, limit_s)?;
        let latest = Duration::from_secs_f64(limit_s + 10.0);
        let mut ended = false;
        while child.try_wait()?.is_none() {
            if start.elapsed() > latest {
                child.kill()?;
                ended = true;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let output = child.wait_with_output()?;
        let text = String::from_utf8_lossy(&output.stdout);
        let (first, model) = text.split_once('\n').unwrap_or(("", ""));
        let verdict = match first {
            "sat" => Verdict::Satisfiable,
            "unsat" => Verdict::Unsatisfiable,
            "unknown" => Verdict::Unknown,
            _ if ended => Verdict::Unknown,
            _ => anyhow::bail!(
                "{} refused {}: {}",
                self.name,
                file.display(),
                String::from_utf8_lossy(&output.stderr)
            ),
        };
        Ok(Answer {
            verdict,
            seconds: start.elapsed().as_secs_f64(),
            model: model.to_owned(),
        })
    }
}
