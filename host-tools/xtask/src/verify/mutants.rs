//! Whether the tests of the core notice when one operation of it is another one.

use std::fs;
use std::path::{Path, PathBuf};

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

/// What cargo-mutants leaves out unless it is written as a raw identifier, which to the compiler
/// is the same name.
const CONSTRUCTOR: &str = "fn new(";
const RAW_CONSTRUCTOR: &str = "fn r#new(";

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
    run(workspace, &source, &folder)?;
    let report = folder.join("mutants.out");
    judge(
        &read(&report, "mutants.json")?,
        &read(&report, "outcomes.json")?,
    )
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

fn run(workspace: &Workspace, source: &PathBuf, folder: &PathBuf) -> Result<()> {
    let mut command = cargo(workspace, &["mutants", "--package", "tempco"]);
    command.arg("--dir").arg(source).arg("--output").arg(folder);
    command.args(["--jobs", "2", "--colors", "never", "--no-times"]);
    // Compiled only with the feature `defmt`, that is for firmware, where these tests do not run.
    command.args(["--exclude-re", "defmt::Format"]);
    // The tests take seconds: a mutant that needs a minute does not end.
    command.args(["--minimum-test-timeout", "60", "--timeout-multiplier", "10"]);
    // Most of the time goes into building the tests hundreds of times.
    command.env("CARGO_PROFILE_DEV_OPT_LEVEL", "0");
    command.env("CARGO_PROFILE_DEV_DEBUG", "0");
    command.arg("--cargo-arg=--config=profile.dev.package.'*'.opt-level=1");
    command.args(["--", "--locked", "--lib", "--tests"]);
    // Each job builds in the folder of its own copy.
    command.env_remove("CARGO_TARGET_DIR");
    println!("\n$ {command:?}");
    let status = command.status().context("cargo mutants")?;
    let complete = status.code().is_some_and(|code| COMPLETE.contains(&code));
    ensure!(complete, "cargo-mutants ended with {status}");
    Ok(())
}

fn read(folder: &Path, name: &str) -> Result<Value> {
    let path = folder.join(name);
    let text = fs::read(&path).with_context(|| path.display().to_string())?;
    Ok(serde_json::from_slice(&text)?)
}

/// The share of caught mutants among those that compile. One that timed out is not counted as
/// caught: in code without loops it would be a riddle, not a proof.
fn judge(mutants: &Value, outcomes: &Value) -> Result<Measured> {
    let found = mutants.as_array().map_or(0, Vec::len);
    let mutants = mutants.as_array().into_iter().flatten();
    let named = |mutant: &&Value| mutant["name"].as_str().is_some_and(|n| n.contains("r#new"));
    let in_constructors = mutants.filter(named).count();
    ensure!(in_constructors > 0, "no mutant is in a constructor");

    let number = |name: &str| outcomes[name].as_u64().unwrap_or(0) as usize;
    let [caught, missed, timeout, unviable] =
        ["caught", "missed", "timeout", "unviable"].map(number);
    let viable = caught + missed + timeout;
    let tried = viable + unviable;
    ensure!(tried == found, "{tried} of {found} mutants were tried");
    ensure!(viable > 0, "no mutant compiles");
    for outcome in outcomes["outcomes"].as_array().into_iter().flatten() {
        let name = outcome["scenario"]["Mutant"]["name"].as_str();
        let what = match outcome["summary"].as_str() {
            Some("MissedMutant") => "survived",
            Some("Timeout") => "timed out",
            _ => continue,
        };
        println!("{what}: {}", name.unwrap_or_default().replace("r#", ""));
    }
    let percent = 100.0 * caught as f64 / viable as f64;
    Ok(Measured {
        reached: percent >= LEAST_CAUGHT_PERCENT,
        figure: format!(
            "{percent:.1} %: {caught} of {viable} caught, {missed} survived, {timeout} timed out; \
             {unviable} more do not compile; {in_constructors} of {found} in constructors"
        ),
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn judged(caught: usize, missed: usize, timeout: usize, unviable: usize) -> Result<Measured> {
        let mutants = vec![json!({"name": "a.rs:1:1: replace + with - in A::r#new"}); 100];
        let outcomes = json!({
            "caught": caught, "missed": missed, "timeout": timeout, "unviable": unviable,
        });
        judge(&json!(mutants), &outcomes)
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
        assert!(judge(&json!([]), &json!({})).is_err());
    }
}
