//! Whether the tests of the core notice when one operation of it is another one.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use tempco_qemu::Workspace;

use super::tools::{MUTANTS, ensure_program};
use super::{Measured, output_folder};
use crate::run::cargo;

const LEAST_CAUGHT_PERCENT: f64 = 95.0;

/// Codes of cargo-mutants after which its report is complete: all were caught, one survived, one
/// timed out. Others, such as that of tests that fail without any mutant, are errors.
const COMPLETE: [i32; 3] = [0, 2, 3];

/// The compiler's code for a constant that does not evaluate.
const BAD_CONSTANT: &str = "error[E0080]";

/// What cargo-mutants leaves out unless it is written as a raw identifier, which to the compiler
/// is the same name.
const CONSTRUCTOR: &str = "fn new(";
const RAW_CONSTRUCTOR: &str = "fn r#new(";

/// The tests that catch most. Building all of them for every mutant would take twice as long.
const FIRST_TESTS: [&str; 3] = ["--lib", "--test=limits", "--test=faults"];
const ALL_TESTS: [&str; 2] = ["--lib", "--tests"];

pub(super) fn caught(workspace: &Workspace) -> Result<Measured> {
    ensure_program(workspace, &MUTANTS)?;
    let folder = output_folder(workspace)?.join("mutants");
    // What an earlier run left must not be taken for the report of this one.
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let source = folder.join("source");
    copy(workspace.root(), &source)?;
    let constructors = expose_constructors(&source.join("crates/tempco/src"))?;
    ensure!(constructors > 0, "the core has no constructors");

    let run = |tests: &[&str]| {
        let mut command = command(workspace, &source, &folder);
        // As arguments of cargo, not of its tests: these would be built all the same.
        command.args(tests.iter().map(|test| format!("--cargo-arg={test}")));
        complete(&mut command)?;
        Report::read(&folder.join("mutants.out"))
    };
    let first = run(&FIRST_TESTS)?;
    ensure!(first.in_constructors > 0, "no mutant is in a constructor");
    let all = run(&ALL_TESTS)?;
    all.name_survivors();
    judge(&first, &all)
}

/// Copies what cargo needs: all but its products and what is hidden.
fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let name = entry.file_name();
        let path = to.join(&name);
        if name == "target" || name.to_string_lossy().starts_with('.') {
            continue;
        }
        if entry.file_type()?.is_dir() {
            copy(&entry.path(), &path)?;
        } else {
            fs::copy(entry.path(), path)?;
        }
    }
    Ok(())
}

/// Rewrites the constructors of a folder so that cargo-mutants does not pass them over.
fn expose_constructors(folder: &Path) -> Result<usize> {
    let mut count = 0;
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let text = fs::read_to_string(&path)?;
        count += text.matches(CONSTRUCTOR).count();
        fs::write(&path, text.replace(CONSTRUCTOR, RAW_CONSTRUCTOR))?;
    }
    Ok(count)
}

/// Tries what earlier runs of this command did not catch.
fn command(workspace: &Workspace, source: &Path, folder: &Path) -> Command {
    let mut command = cargo(workspace, &["mutants", "--package", "tempco", "--iterate"]);
    command.arg("--dir").arg(source).arg("--output").arg(folder);
    command.args(["--jobs", "2", "--colors", "never"]);
    // Compiled only with the feature `defmt`, that is for firmware, where these tests do not run.
    command.args(["--exclude-re", "defmt::Format"]);
    // The tests take seconds: a mutant that needs a minute does not end.
    command.args(["--minimum-test-timeout", "60", "--timeout-multiplier", "10"]);
    // Most of the time goes into building the tests hundreds of times.
    command.env("CARGO_PROFILE_DEV_OPT_LEVEL", "0");
    command.env("CARGO_PROFILE_DEV_DEBUG", "0");
    command.arg("--cargo-arg=--config=profile.dev.package.'*'.opt-level=1");
    // Each job builds in the folder of its own copy.
    command.env_remove("CARGO_TARGET_DIR");
    command.arg("--cargo-arg=--locked");
    command
}

/// Runs cargo-mutants, which reports by its exit code as well.
fn complete(command: &mut Command) -> Result<()> {
    println!("\n$ {command:?}");
    let status = command.status().context("cargo mutants")?;
    let complete = status.code().is_some_and(|code| COMPLETE.contains(&code));
    ensure!(complete, "cargo-mutants ended with {status}");
    Ok(())
}

/// What a run of cargo-mutants found.
#[derive(Default)]
struct Report {
    in_constructors: usize,
    caught: usize,
    unviable: usize,
    /// Of those, how many the compiler refuses because a constant of the tests does not evaluate.
    refused: usize,
    missed: Vec<String>,
    timed_out: Vec<String>,
}

impl Report {
    fn read(folder: &Path) -> Result<Self> {
        let read = |name: &str| -> Result<Value> {
            let path = folder.join(name);
            let text = fs::read(&path).with_context(|| path.display().to_string())?;
            Ok(serde_json::from_slice(&text)?)
        };
        let mut report = Self::of(&read("mutants.json")?, &read("outcomes.json")?)?;
        for log in fs::read_dir(folder.join("log"))? {
            let text = fs::read(log?.path())?;
            report.refused += usize::from(String::from_utf8_lossy(&text).contains(BAD_CONSTANT));
        }
        Ok(report)
    }

    fn of(mutants: &Value, outcomes: &Value) -> Result<Self> {
        let found = mutants.as_array().map_or(0, Vec::len);
        let mut report = Self::default();
        for outcome in outcomes["outcomes"].as_array().into_iter().flatten() {
            let Some(name) = outcome["scenario"]["Mutant"]["name"].as_str() else {
                continue; // The tests without a mutant.
            };
            report.in_constructors += usize::from(name.contains("r#new"));
            match outcome["summary"].as_str() {
                Some("CaughtMutant") => report.caught += 1,
                Some("Unviable") => report.unviable += 1,
                Some("Timeout") => report.timed_out.push(name.replace("r#", "")),
                _ => report.missed.push(name.replace("r#", "")),
            }
        }
        let tried = report.tried();
        ensure!(tried == found, "{tried} of {found} mutants were tried");
        Ok(report)
    }

    fn tried(&self) -> usize {
        self.caught + self.unviable + self.missed.len() + self.timed_out.len()
    }

    fn name_survivors(&self) {
        for mutant in &self.missed {
            println!("survived: {mutant}");
        }
        for mutant in &self.timed_out {
            println!("timed out: {mutant}");
        }
    }
}

/// The share of caught mutants among those that compile. One that timed out is not counted as
/// caught: in code without loops it would be a riddle, not a proof.
fn judge(first: &Report, all: &Report) -> Result<Measured> {
    let left = first.missed.len() + first.timed_out.len();
    let again = all.tried();
    ensure!(again == left, "{again} of {left} mutants were tried again");
    let (missed, timed_out) = (all.missed.len(), all.timed_out.len());
    let caught = first.caught + all.caught;
    let viable = caught + missed + timed_out;
    ensure!(viable > 0, "no mutant compiles");
    let percent = 100.0 * caught as f64 / viable as f64;
    Ok(Measured {
        reached: percent >= LEAST_CAUGHT_PERCENT,
        figure: format!(
            "{percent:.1} %: {caught} of {viable} caught, {missed} survived, {timed_out} timed \
             out; {} more do not compile, {} of them in constants of the tests; {} of all in \
             constructors",
            first.unviable + all.unviable,
            first.refused + all.refused,
            first.in_constructors
        ),
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    const FOUND: usize = 100;

    fn report(found: usize, counts: [(&str, usize); 4]) -> Result<Report> {
        let outcome = |summary| json!({"scenario": {"Mutant": {"name": "a"}}, "summary": summary});
        let mut outcomes = vec![json!({"scenario": "Baseline", "summary": "Success"})];
        for (summary, count) in counts {
            outcomes.extend(vec![outcome(summary); count]);
        }
        Report::of(&json!(vec![0; found]), &json!({ "outcomes": outcomes }))
    }

    fn judged(caught: usize, missed: usize, timed_out: usize, unviable: usize) -> Result<Measured> {
        let counts = |caught, unviable| {
            [
                ("CaughtMutant", caught),
                ("MissedMutant", missed),
                ("Timeout", timed_out),
                ("Unviable", unviable),
            ]
        };
        let first = report(FOUND, counts(caught, unviable))?;
        judge(&first, &report(missed + timed_out, counts(0, 0))?)
    }

    #[test]
    fn a_mutant_that_timed_out_is_not_caught() {
        assert!(judged(95, 5, 0, 0).unwrap().reached);
        assert!(judged(95, 0, 5, 0).unwrap().reached);
        assert!(!judged(94, 0, 6, 0).unwrap().reached);
        assert!(!judged(94, 6, 0, 0).unwrap().reached);
    }

    #[test]
    fn those_that_do_not_compile_do_not_count() {
        assert!(judged(19, 1, 0, 80).unwrap().reached);
        assert!(!judged(18, 1, 0, 81).unwrap().reached);
        assert!(judged(0, 0, 0, 100).is_err());
    }

    #[test]
    fn a_run_that_was_stopped_has_no_figure() {
        assert!(judged(99, 0, 0, 0).is_err());
        let first = report(1, [("MissedMutant", 1), ("", 0), ("", 0), ("", 0)]).unwrap();
        assert!(judge(&first, &Report::default()).is_err());
    }
}
