//! The test programs of the workspace, two at a time: many of them wait for an emulator or a browser.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::thread;

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use tempco_qemu::Workspace;

use crate::run::cargo;

/// Programs at a time.
const AT_ONCE: usize = 2;

/// Those that take longest: they come first, so that none is left alone at the end.
const LONG: [&str; 6] = ["page", "golden", "docs", "accuracy", "images", "c"];

/// What a program printed, and whether it succeeded.
pub(crate) struct Ran {
    pub(crate) name: String,
    pub(crate) output: String,
    pub(crate) succeeded: bool,
}

/// Builds all test programs and runs them, each in the folder of its package as `cargo test` does, and
/// the examples in the documentation of the crates. Returns what was printed, program by program.
pub(crate) fn run(workspace: &Workspace) -> Result<Vec<Ran>> {
    let mut documentation = cargo(workspace, &["test", "--workspace", "--doc", "--locked"]);
    documentation.arg("--no-fail-fast");
    let mut jobs = VecDeque::from([("documentation".to_owned(), documentation)]);
    jobs.extend(programs(workspace)?);
    let count = jobs.len();
    let jobs = Mutex::new(jobs);
    let next = || {
        jobs.lock()
            .unwrap_or_else(PoisonError::into_inner)
            .pop_front()
    };
    let work = || -> Result<Vec<Ran>> {
        let mut ran = Vec::new();
        while let Some((name, mut command)) = next() {
            ran.push(run_one(&name, &mut command)?);
        }
        Ok(ran)
    };
    let ran = thread::scope(|scope| -> Result<Vec<Ran>> {
        let workers: Vec<_> = (0..AT_ONCE).map(|_| scope.spawn(work)).collect();
        let mut all = Vec::new();
        for worker in workers {
            all.extend(worker.join().expect("a worker does not panic")?);
        }
        Ok(all)
    })?;
    ensure!(ran.len() == count, "a test program did not run");
    Ok(ran)
}

fn run_one(name: &str, command: &mut Command) -> Result<Ran> {
    let output = command
        .stdin(Stdio::null())
        .output()
        .with_context(|| name.to_owned())?;
    let [text, errors] = [output.stdout, output.stderr].map(|bytes| {
        // A test may print anything.
        String::from_utf8_lossy(&bytes).into_owned()
    });
    println!("\n{name}\n{text}{errors}");
    Ok(Ran {
        name: name.to_owned(),
        output: text,
        succeeded: output.status.success(),
    })
}

/// Builds the test programs; returns each with its name, the long ones first.
fn programs(workspace: &Workspace) -> Result<Vec<(String, Command)>> {
    let mut build = cargo(workspace, &["test", "--workspace", "--no-run", "--locked"]);
    build.args(["--message-format", "json-render-diagnostics"]);
    println!("\n$ cargo test --workspace --no-run --locked");
    let built = build.stderr(Stdio::inherit()).output()?;
    ensure!(built.status.success(), "the tests do not build");
    let messages = String::from_utf8(built.stdout)?;
    let messages = messages.lines().map(serde_json::from_str);
    let messages: Vec<Value> = messages.collect::<Result<_, _>>()?;
    let mut programs: Vec<(String, PathBuf, PathBuf)> =
        messages.iter().filter_map(program).collect();
    let is_long = |name: &str| LONG.iter().any(|long| name.ends_with(&format!(" {long}")));
    programs.sort_by_key(|(name, ..)| !is_long(name));
    let commands = programs.into_iter().map(|(name, path, folder)| {
        let mut command = Command::new(path);
        command.current_dir(folder);
        (name, command)
    });
    Ok(commands.collect())
}

/// Name, path and folder of a test program, if the message is of one.
fn program(message: &Value) -> Option<(String, PathBuf, PathBuf)> {
    let is_test = message["profile"]["test"].as_bool()?;
    let path = Path::new(message["executable"].as_str()?);
    let folder = Path::new(message["manifest_path"].as_str()?).parent()?;
    let package = folder.file_name()?.to_str()?;
    let name = format!("{package} {}", message["target"]["name"].as_str()?);
    is_test.then(|| (name, path.to_owned(), folder.to_owned()))
}
